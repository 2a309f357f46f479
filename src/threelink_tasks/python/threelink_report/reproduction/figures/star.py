"""Fig. 7: the swimmer traces the ten-point star."""
import matplotlib.pyplot as plt

from threelink_report.episode_figure import draw_ends, places
from threelink_report.style import BODY, SWIMMER, TARGET

TITLE = "The star (Fig. 7)"
INPUTS = r"bags/star\.bag"


def draw(results):
    episode = results.episode("star")
    figure, axes = plt.subplots(figsize=(5.6, 5.2), constrained_layout=True)
    for index in places(episode.centroids):
        axes.plot(*episode.ends(index).T, color=BODY, linewidth=2.5, zorder=1,
                  solid_capstyle="round", solid_joinstyle="round")
    axes.plot(*episode.centroids.T, color=SWIMMER, linewidth=1.1, zorder=3)
    axes.plot(*episode.waypoints.T, "*", color=TARGET, markersize=9, zorder=4)
    centre = episode.waypoints.mean(axis=0)
    for number, point in enumerate(episode.waypoints, 1):
        axes.annotate(str(number), centre + 1.13 * (point - centre), ha="center", va="center")
    draw_ends(axes, episode.centroids, SWIMMER, "o", 6)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="x / L", ylabel="y / L")
    return figure


def caption(results):
    episode = results.episode("star")
    threshold = episode.config["task"]["threshold"]
    return (f"Way of the centroid (blue) through the ten points (stars), from the open circle to the "
            f"dot; in grey the swimmer, true to scale. A point counts as reached within "
            f"{threshold:g} L at the end of a step. Outcome: {episode.outcome}, "
            f"{episode.end.waypoint} of {len(episode.waypoints)} points.")
