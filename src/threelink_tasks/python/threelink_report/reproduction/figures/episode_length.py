"""Supplement: rate of success against N_s, the steps of a training episode."""
import re

import matplotlib.pyplot as plt
import numpy as np

from threelink_report.style import SWIMMER

TITLE = "Success against N_s (supplement)"
INPUTS = r"data/evaluate/(steps|cut)_\d+_\d+\.json"
KINDS = (("steps", SWIMMER, "o", "-", "bootstrap at the time limit"),
         ("cut", "#D55E00", "x", "--", "returns end with the episode"))


def lengths(results):
    found = (re.match(r"data/evaluate/steps_(\d+)_", path) for path in results.files)
    return sorted({int(match.group(1)) for match in found if match})


def rates(results, kind, steps):
    return [one["success_rate"] for one in results.evaluations(f"{kind}_{steps}")]


def draw(results):
    figure, axes = plt.subplots(figsize=(5.2, 3.2), constrained_layout=True)
    steps = lengths(results)
    for kind, colour, marker, dash, label in KINDS:
        values = [np.multiply(100, rates(results, kind, one)) for one in steps]
        for one, seeds in zip(steps, values):
            axes.plot([one] * len(seeds), seeds, marker, color=colour, markersize=3.5, alpha=0.5,
                      markerfacecolor="none")
        axes.plot(steps, [np.mean(seeds) for seeds in values], color=colour, linestyle=dash,
                  marker=marker, markersize=5, label=label)
    axes.set(xlabel=r"$N_s$, action steps of a training episode", ylabel="success / %",
             ylim=(-4, 104))
    axes.legend(loc="best", fontsize="small")
    return figure


def caption(results):
    steps = lengths(results)
    text = {kind: ", ".join(f"{100 * np.mean(rates(results, kind, one)):.1f}" for one in steps)
            for kind, *_ in KINDS}
    brief = "" if results.is_full else " Here the trainings are brief, of a few thousand episodes."
    return (f"Share of random starts from which the mean |θ_s| of translation is below 2.5 degrees; "
            f"line: mean, small marks: seeds ({len(rates(results, 'steps', steps[0]))} of each). "
            f"N_s = {', '.join(map(str, steps))}: {text['steps']} % where the return of an episode that "
            f"is cut goes on with the critic's value, {text['cut']} % where it ends with the episode, "
            f"as the paper's text has it. The paper's rises to 100 % at N_s = 200." + brief)
