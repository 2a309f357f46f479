"""Fig. 8: pursuit of diffusing targets that swim at 0, 0.5 and 1 times the swimmer's speed."""
import matplotlib.pyplot as plt

from threelink_report.episode_figure import draw_ends
from threelink_report.style import SWIMMER, TARGET

TITLE = "Diffusing targets (Fig. 8)"
INPUTS = r"bags/pursuit_\w+\.bag"
LAST = 2000  # steps that are magnified where they are a small part of the way
RATIOS = (("pursuit_0", "0"), ("pursuit_05", "0.5"), ("pursuit_1", "1"))


def draw(results):
    figure, panels = plt.subplots(1, 3, figsize=(9.2, 3.3), constrained_layout=True)
    for axes, (name, ratio) in zip(panels, RATIOS):
        episode = results.episode(name)
        axes.plot(*episode.targets.T, color=TARGET, linewidth=0.7, zorder=2, label="target")
        axes.plot(*episode.centroids.T, color=SWIMMER, linewidth=1.1, zorder=3,
                  label="swimmer's centroid")
        draw_ends(axes, episode.targets, TARGET, "*", 9)
        draw_ends(axes, episode.centroids, SWIMMER, "o", 5)
        axes.set_aspect("equal", adjustable="datalim")
        axes.set(xlabel="x / L", ylabel="y / L")
        if len(episode.times) > 5 * LAST:
            draw_end(axes, episode)
        axes.set_title(rf"$v_T / v_m$ = {ratio}", fontsize="medium")
    panels[0].legend(fontsize="small")
    return figure


def draw_end(axes, episode):
    """How it follows: the last steps, magnified."""
    inset = axes.inset_axes([0.08, 0.55, 0.44, 0.4])
    inset.plot(*episode.targets[-LAST:].T, color=TARGET, linewidth=0.7)
    inset.plot(*episode.centroids[-LAST:].T, color=SWIMMER, linewidth=1.1)
    inset.set_aspect("equal", adjustable="datalim")
    inset.set_title(f"last {LAST} steps", fontsize="x-small", pad=2)
    inset.tick_params(labelsize="x-small")


def caption(results):
    parts = []
    for name, ratio in RATIOS:
        episode = results.episode(name)
        parts.append(f"{ratio}: {episode.outcome}, distance {episode.end.distance:.3g} L")
    return ("Swimmer (blue) and target (orange) from the open marks to the filled ones; the target "
            "starts at (1.5, 0.5), heads 30 degrees up, and diffuses with D = 5e-5. Outcomes by "
            "v_T / v_m: " + "; ".join(parts) + ".")
