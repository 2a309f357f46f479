"""Supplement: strokes, success and efficiency for the weights c = 0..4 of the work."""
import matplotlib.pyplot as plt
import numpy as np

from threelink_report.style import CURVES

from ..experiments import PENALTIES
from ..results import interval
from .look import OPTIMUM, phase_plane

TITLE = "The weight c of the work (supplement)"
INPUTS = r"data/(way/(vfs|eas|eas_c\d)_0\.csv|evaluate/(vfs|eas|eas_c\d)_\d+\.json|optimum/\w+\.json)"


def measured(results, measure):
    """(means, half widths) by c; half widths 0 where there is one policy."""
    values = [interval([one[measure] for one in results.evaluations(name)]) for name in PENALTIES]
    return np.array([mean for mean, _ in values]), np.array([half or 0 for _, half in values])


def draw(results):
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(9.2, 3.1), constrained_layout=True,
                                                 gridspec_kw={"width_ratios": [1, 1, 1.3]})
    for (name, penalty), (colour, dash) in zip(PENALTIES.items(), CURVES):
        period = results.evaluations(name)[0]["starts"][0]["period_steps"]
        axes, dash = (middle, "-") if penalty == 4 else (left, dash)
        axes.plot(*results.ways(name)[0].last_stroke(period).T, color=colour, linestyle=dash,
                  linewidth=1.2, label=f"c = {penalty}")
    for axes in (left, middle):
        phase_plane(axes)
        axes.legend(fontsize="small", loc="upper left", framealpha=0.9)
    penalties = list(PENALTIES.values())
    success, half = measured(results, "success_rate")
    right.errorbar(penalties, 100 * success, 100 * half, color="black", marker="x", capsize=3,
                   label="success")
    right.set(xlabel="c", ylabel="success / %", ylim=(0, 105))
    efficiency, half = measured(results, "efficiency")
    other = right.twinx()
    other.errorbar(penalties, 100 * efficiency, 100 * half, color="#D55E00", marker="o", capsize=3,
                   linestyle="--", label="efficiency")
    optima = [results.optimum(name)["efficiency"] for name in ("speed", "c1", "c2", "c3", "c4")]
    other.plot(penalties, 100 * np.array(optima), ":", color=OPTIMUM, marker="d", markersize=3.5,
               label="efficiency of the optimum")
    other.set(ylabel="efficiency / %", ylim=(0.6, 1.3))
    other.grid(False)
    handles = [sum(pair, []) for pair in zip(right.get_legend_handles_labels(),
                                             other.get_legend_handles_labels())]
    right.legend(*handles, fontsize="small", loc="lower left")
    return figure


def caption(results):
    success, _ = measured(results, "success_rate")
    efficiency, _ = measured(results, "efficiency")
    text = "; ".join(f"c = {penalty}: {100 * one:.1f} %, {100 * two:.3f} %" for penalty, one, two in
                     zip(PENALTIES.values(), success, efficiency))
    kind = "means over seeds with 95 % intervals" if results.is_full else "one policy each"
    return ("Left and middle: steady strokes for b = 6 and c = 0 to 4. Right: success of random "
            f"starts of any shape, and efficiency, {kind} ({text}). Here the stroke at c = 4 is as "
            "symmetric as the others and the success does not drop; in the paper it loses its symmetry, and success falls from about 90 %.")
