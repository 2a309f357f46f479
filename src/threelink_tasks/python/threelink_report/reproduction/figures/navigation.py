"""Fig. 4: strokes in the phase plane and the way of the centroid, from x_1 = (1, 0), theta_i = pi/3."""
import matplotlib.pyplot as plt

from threelink_report.episode import SMOOTHING, TRANSLATION, Motion
from threelink_report.style import BODY

from .look import COLOUR, NAME, phase_plane

TITLE = "Swimming along θ_T = 0 (Fig. 4)"
INPUTS = r"data/(way/(vfs|eas)_0\.csv|evaluate/(vfs|eas)_0\.json)"
START = 1  # theta_2 = pi/3


def steering_steps(results, strategy):
    return results.evaluations(strategy)[0]["starts"][START]["steering_steps"]


def draw(results):
    figure, rows = plt.subplots(2, 2, figsize=(7.1, 5.6), constrained_layout=True,
                                gridspec_kw={"width_ratios": [1, 1.5]})
    for (left, right), (strategy, colour) in zip(rows, COLOUR.items()):
        way = results.ways(strategy)[START]
        steps = steering_steps(results, strategy)
        period = results.evaluations(strategy)[0]["starts"][START]["period_steps"]
        left.plot(*way.alpha[:steps].T, color=BODY, linewidth=0.7, label="steering")
        left.plot(*way.last_stroke(period).T, color=colour, linewidth=1.6, label="steady stroke")
        phase_plane(left)
        left.set_title(NAME[strategy], loc="left")
        left.legend(fontsize="small", loc="upper left", framealpha=0.9)
        draw_way(right, way, Motion(way), steps, colour)
    return figure


def draw_way(axes, way, motion, steps, colour):
    axes.plot(*way.centroids.T, color=colour, linewidth=0.8, label="centroid")
    axes.plot(*motion.way.T, color="black", linewidth=1.1, label="smoothed")
    at = motion.way[min(steps - SMOOTHING // 2, len(motion.way) - 1), 0]
    axes.axvline(at, color="black", linewidth=0.8, linestyle="--")
    axes.plot(*way.centroids[0], "o", color="white", markeredgecolor="0.2", markersize=5, zorder=4)
    low, high = axes.get_ylim()
    axes.set(xlabel="x / L", ylabel="y / L", ylim=(low - 0.05, high + 1.5 * (high - low)))
    axes.annotate("steering", (at, 0.03), xytext=(-4, 0), xycoords=("data", "axes fraction"),
                  textcoords="offset points", ha="right", fontsize="small")
    axes.annotate("translation", (at, 0.03), xytext=(4, 0), xycoords=("data", "axes fraction"),
                  textcoords="offset points", ha="left", fontsize="small")
    inset = axes.inset_axes([0.36, 0.62, 0.61, 0.34])
    inset.axhspan(-TRANSLATION, TRANSLATION, color="0.9", linewidth=0)
    inset.plot(motion.times, motion.theta_s, color=colour, linewidth=0.9)
    inset.set_xlabel(r"$t$ / $T_0$", fontsize="small", labelpad=1)
    inset.set_ylabel(r"$\theta_s$ / degrees", fontsize="small", labelpad=1)
    inset.tick_params(labelsize="small")
    axes.legend(fontsize="small", loc="lower right")


def caption(results):
    parts = [f"{NAME[name]} for {steering_steps(results, name)} steps" for name in COLOUR]
    return ("From x_1 = (1, 0) and a straight shape at θ = π/3, 1500 steps of the mean action. "
            "Left: hinge angles, in grey while the swimmer steers, in colour its last stroke; the "
            "dotted frame is the joint limit. Right: way of the centroid, and smoothed over 71 "
            "positions; x and y have different scales. The inset is the angle θ_s of the smoothed "
            "way; up to 2.5 degrees (grey band) it counts as translation. Steering lasts: "
            + ", ".join(parts) + ".")
