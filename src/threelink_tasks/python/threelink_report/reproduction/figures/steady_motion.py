"""Fig. 5: speed and efficiency over time, from theta_2 = 0, pi/3 and pi/2."""
import matplotlib.pyplot as plt
import numpy as np

from threelink_report.episode import Motion

from .look import COLOUR, NAME, STARTS

TITLE = "Speed and efficiency over time (Fig. 5)"
INPUTS = r"data/(way/(vfs|eas)_0\.csv|evaluate/(vfs|eas)_0\.json)"


def draw(results):
    figure, (upper, lower) = plt.subplots(2, 1, figsize=(6.2, 4.6), sharex=True,
                                          constrained_layout=True)
    for strategy, colour in COLOUR.items():
        ways = results.ways(strategy)
        for index, dash, angle in STARTS:
            motion = Motion(ways[index])
            speed = np.diff(motion.way[:, 0]) / ways[index].dt
            efficiency = ways[index].gamma * speed ** 2 / motion.power
            style = dict(color=colour, linestyle=dash, linewidth=1,
                         label=f"{NAME[strategy]}, θ₂ = {angle}")
            upper.plot(motion.times, speed, **style)
            lower.plot(motion.times, 100 * efficiency, **style)
    upper.set_ylabel(r"speed along $\theta_T$ / $L\,T_0^{-1}$")
    lower.set(ylabel="efficiency / %", xlabel=r"$t$ / $T_0$", xlim=(0, None), ylim=(0, None))
    lower.legend(fontsize="small", ncol=2, loc="lower right")
    return figure


def caption(results):
    parts = []
    for strategy in COLOUR:
        measures = results.evaluations(strategy)[0]
        parts.append(f"{NAME[strategy]} {measures['speed']:.5f} and "
                     f"{100 * measures['efficiency']:.3f} %")
    return ("Speed towards the target and efficiency γ v² / Φ of the smoothed motion, from straight "
            "starts at θ₂ = 0, π/3 and π/2. All come to the same values, "
            + ", ".join(parts) + "; the paper: "
            + ", ".join(f"{NAME[name]} {results.published[name + '_speed']:g} and "
                        f"{100 * results.published[name + '_efficiency']:.3f} %" for name in COLOUR)
            + ". The ripple is that of a mean over 71 positions where a stroke takes "
            + " and ".join(f"{results.evaluations(name)[0]['starts'][0]['period_steps']:.0f}"
                           for name in COLOUR) + " steps.")
