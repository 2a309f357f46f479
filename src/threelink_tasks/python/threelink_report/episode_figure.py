"""Pictures of a recorded episode, and the panels that they are made of."""
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import StrMethodFormatter

from threelink_report.episode import TRANSLATION, Motion
from threelink_report.style import BODY, STEERING, SWIMMER, TARGET, plain

SPACING = 1.0  # [L] at least, between the places where the swimmer itself is drawn
MOST_SHAPES = 12


def heading(episode):
    return plain(f"{episode.title()}: {episode.outcome}\n"
                 f"t = {episode.times[-1]:.6g} T0, distance {episode.end.distance:.3g} L, "
                 f"mean speed {episode.end.mean_speed:.3g} L/T0")


def places(centroids):
    """Indices of the states to draw the swimmer in: start, end, and some far apart between them."""
    shown = [0]
    spacing = max(SPACING, np.ptp(centroids, axis=0).max() / MOST_SHAPES)
    for index, centroid in enumerate(centroids):
        if min(np.linalg.norm(centroid - centroids[other]) for other in (shown[-1], -1)) > spacing:
            shown.append(index)
    return shown + [len(centroids) - 1]


def draw_ends(axes, points, colour, marker, size):
    for index, face, edge in ((0, "white", colour), (-1, colour, "white")):
        axes.plot(*points[index], marker, color=face, markeredgecolor=edge, markersize=size,
                  zorder=4)


def draw_path(axes, episode):
    for index in places(episode.centroids):
        axes.plot(*episode.ends(index).T, color=BODY, linewidth=2.5, zorder=1,
                  solid_capstyle="round", solid_joinstyle="round")
    if len(episode.waypoints):
        axes.plot(*episode.waypoints.T, "*", color=TARGET, markersize=7, zorder=4, label="targets")
    elif not np.isnan(episode.targets).all():
        axes.plot(*episode.targets.T, color=TARGET, linewidth=0.8, zorder=2, label="target")
        draw_ends(axes, episode.targets, TARGET, "*", 11)
    axes.plot(*episode.centroids.T, color=SWIMMER, linewidth=1.2, zorder=3,
              label="swimmer's centroid")
    draw_ends(axes, episode.centroids, SWIMMER, "o", 7)
    axes.plot([], [], color=BODY, linewidth=2.5, label="swimmer, true to scale")
    axes.plot([], [], "o", color="white", markeredgecolor="0.3", label="start")
    axes.plot([], [], "o", color="0.3", label="end")
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="x / L", ylabel="y / L")
    axes.legend(fontsize="small", framealpha=0.9)


def draw_phase_plane(axes, episode):
    first, last = np.degrees(episode.alpha[:, 0]), np.degrees(episode.alpha[:, -1])
    axes.plot(first, last, color=BODY, linewidth=0.5)
    stroke = slice(-episode.smoothing - 1, None)
    axes.plot(first[stroke], last[stroke], color=SWIMMER, linewidth=1.5,
              label=f"last {episode.smoothing} steps")
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="first hinge / degrees", ylabel="last hinge / degrees")
    axes.legend(fontsize="small", loc="upper right")


def draw_theta_s(axes, motion):
    axes.fill_between(motion.times, 0, 1, where=motion.steering, step="mid", color=STEERING,
                      linewidth=0, transform=axes.get_xaxis_transform(), label="steering")
    for bound in (-TRANSLATION, TRANSLATION):
        axes.axhline(bound, color="0.3", linewidth=0.6, linestyle="--")
    turned = np.abs(np.diff(motion.theta_s, prepend=motion.theta_s[:1])) > 180
    axes.plot(motion.times, np.where(turned, np.nan, motion.theta_s), color=SWIMMER, linewidth=0.9)
    axes.set_yscale("symlog", linthresh=10, linscale=1.2)
    axes.set_yticks([-180, -45, -10, 0, 10, 45, 180])
    axes.get_yaxis().set_major_formatter(StrMethodFormatter("{x:.0f}"))
    axes.minorticks_off()
    axes.set(ylim=(-190, 190), ylabel=r"$\theta_s$ / degrees")
    share = 100 * (1 - motion.steering.mean())
    axes.set_title(f"translation (white, |θs| ≤ {TRANSLATION}°) {share:.0f} % of the time, "
                   "steering (grey) the rest", fontsize="small", loc="left")


def draw_curve(axes, times, values, label):
    axes.plot(times, values, color=SWIMMER, linewidth=0.9)
    axes.set(ylabel=label, ylim=(0, None))


def draw_path_alone(episode):
    figure, axes = plt.subplots(figsize=(8, 6), dpi=130, constrained_layout=True)
    draw_path(axes, episode)
    axes.set_title(heading(episode), fontsize=10)
    return figure


def draw_all(episode):
    figure = plt.figure(figsize=(7.1, 8.2), dpi=200, constrained_layout=True)
    figure.suptitle(heading(episode), fontsize=9)
    grid = figure.add_gridspec(5, 5, height_ratios=[3.4, 1.6, 1, 1, 1])
    draw_path(figure.add_subplot(grid[0, :3]), episode)
    draw_phase_plane(figure.add_subplot(grid[0, 3:]), episode)
    motion = Motion(episode)
    if not len(motion.times):
        figure.text(0.5, 0.3, f"no more than {episode.smoothing} states: no mean over a stroke",
                    ha="center")
        return figure
    rows = [figure.add_subplot(grid[1, :])]
    rows += [figure.add_subplot(grid[row, :], sharex=rows[0]) for row in (2, 3, 4)]
    draw_theta_s(rows[0], motion)
    draw_curve(rows[1], motion.times, motion.speed, r"speed / $L\,T_0^{-1}$")
    draw_curve(rows[2], motion.times, motion.power, r"power / $C_\perp L^3 T_0^{-2}$")
    draw_curve(rows[3], motion.times, 100 * motion.efficiency, "efficiency / %")
    for row in rows[:-1]:
        row.tick_params(labelbottom=False)
    rows[-1].set_xlabel(r"time / $T_0$")
    return figure
