"""Fig. 3: reward of an episode against episodes, median and range over seeds."""
import matplotlib.pyplot as plt
import numpy as np

from .look import COLOUR, NAME

TITLE = "Learning (Fig. 3)"
INPUTS = r"training/(curve_)?(vfs|eas)_\d+\.csv"
DASH = {"vfs": "-", "eas": (0, (4, 1))}


def runs(results, strategy):
    """(episodes (m,), returns (seeds, m))"""
    curves = results.curves(strategy if results.is_full else "curve_" + strategy)
    return curves[0][0], np.array([returns for _, returns in curves])


def draw(results):
    figure, axes = plt.subplots(figsize=(5.2, 3.2), constrained_layout=True)
    for strategy, colour in COLOUR.items():
        episodes, returns = runs(results, strategy)
        axes.fill_between(episodes, returns.min(axis=0), returns.max(axis=0), color=colour,
                          alpha=0.25, linewidth=0)
        axes.plot(episodes, np.median(returns, axis=0), color=colour, linewidth=1.1,
                  linestyle=DASH[strategy], label=f"{NAME[strategy]}, median and range")
    axes.set(xlabel="episodes", ylabel="reward of an episode, with noise", xlim=(0, None))
    axes.legend(loc="lower right")
    return figure


def caption(results):
    episodes, returns = runs(results, "vfs")
    parts = []
    for strategy in COLOUR:
        episodes, returns = runs(results, strategy)
        median = np.median(returns, axis=0)
        final = median[-max(len(median) // 20, 1):].mean()
        reached = episodes[np.argmax(median >= median[0] + 0.95 * (final - median[0]))]
        parts.append(f"{NAME[strategy]} has gained 95 % of its final reward, {final:.2f}, after "
                     f"{reached:,.0f} episodes")
    brief = ("" if results.is_full else
             " These trainings are brief, for the picture alone: learning rates and noise fall "
             "faster than in those of the shipped policies.")
    return (f"Reward summed over the 200 steps of an episode, mean over the episodes of an update; "
            f"line: median, band: range, over {len(returns)} seeds of {episodes[-1]:,.0f} episodes. "
            f"{'; '.join(parts)}. The paper converges after about "
            f"{results.published['vfs_converged_episodes']:,} (VFS) and "
            f"{results.published['eas_converged_episodes']:,} (EAS)." + brief)
