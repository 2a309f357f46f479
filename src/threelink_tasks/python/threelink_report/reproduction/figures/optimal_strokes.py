"""Fig. 6: learned strokes beside the optimal ones; speed and efficiency of all four."""
import matplotlib.pyplot as plt
import numpy as np

from ..results import interval, loop
from .look import COLOUR, NAME, OPTIMUM, percent, phase_plane

TITLE = "Learned and optimal strokes (Fig. 6)"
INPUTS = r"data/(way/(vfs|eas)_0\.csv|evaluate/(vfs|eas)_\d+\.json|optimum/(speed|efficiency)\.json)"
BEST = {"vfs": ("speed", "VO"), "eas": ("efficiency", "EO")}
HATCH = {"VO": "//", "VFS": "", "EAS": "", "EO": "\\\\"}


def bars(results, measure):
    """[(name, value, half width of the interval or None, colour)]"""
    learned = {NAME[name]: interval([one[measure] for one in results.evaluations(name)])
               for name in COLOUR}
    optimum = {label: (results.optimum(file)[measure], None) for file, label in BEST.values()}
    return [("VO", *optimum["VO"], "white"), ("VFS", *learned["VFS"], COLOUR["vfs"]),
            ("EAS", *learned["EAS"], COLOUR["eas"]), ("EO", *optimum["EO"], "white")]


def draw(results):
    figure, panels = plt.subplots(1, 4, figsize=(9.2, 2.9), constrained_layout=True,
                                  gridspec_kw={"width_ratios": [1.5, 1.5, 1, 1]})
    for axes, (strategy, colour) in zip(panels, COLOUR.items()):
        file, label = BEST[strategy]
        period = results.evaluations(strategy)[0]["starts"][0]["period_steps"]
        axes.plot(*loop(results.optimum(file)).T, color=OPTIMUM, linewidth=1.2,
                  linestyle=(0, (4, 2)), label=label)
        axes.plot(*results.ways(strategy)[0].last_stroke(period).T, color=colour, linewidth=1.5,
                  label=NAME[strategy])
        phase_plane(axes)
        axes.legend(fontsize="small", loc="upper left", framealpha=0.9)
    for axes, measure, factor, label in ((panels[2], "speed", 1, r"speed / $L\,T_0^{-1}$"),
                                         (panels[3], "efficiency", 100, "efficiency / %")):
        for place, (name, value, half, colour) in enumerate(bars(results, measure)):
            axes.bar(place, factor * value, 0.7, color=colour, edgecolor="black", linewidth=0.8,
                     hatch=HATCH[name], yerr=None if half is None else factor * half, capsize=3)
        axes.set(xticks=np.arange(4), xticklabels=["VO", "VFS", "EAS", "EO"], ylabel=label)
        axes.grid(axis="x", visible=False)
    return figure


def caption(results):
    speeds = {name: value for name, value, _, _ in bars(results, "speed")}
    efficiencies = {name: value for name, value, _, _ in bars(results, "efficiency")}
    optimum = results.optimum("efficiency")
    return ("Strokes in the phase plane: solid, learned; dashed, optimal. Bars: mean over seeds"
            + (", with 95 % intervals" if results.is_full else " (here one policy each)") +
            f". VFS reaches {percent(speeds['VFS'] / speeds['VO'])} of the speed of VO, EAS "
            f"{percent(efficiencies['EAS'] / efficiencies['EO'])} of the efficiency of EO. "
            "Normalisation: VO here is the fastest stroke under the bound that holds for the "
            "policies, hinge rates of at most 1 each; EO, whose efficiency is the same at any pace, is "
            f"shown with the period {optimum['period']:.2f} T0 at which its rates keep that bound. "
            "The paper's VO is that of Tam and Hosoi (2007), which maximises the distance of a "
            "cycle; at rates of at most 1 it would be slower than VFS, and the paper's order, VO "
            "before VFS, comes out only if all strokes are given equal periods of about 7.2 T0. A "
            "share of its VO is therefore not a share of the optimum.")
