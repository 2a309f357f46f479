#!/usr/bin/python3
"""Draws a recorded episode: draw_episode.py BAG PICTURE

The picture (PNG, or what the name's ending says) shows the way of the swimmer's centroid and of the
target, where both began and ended, and the swimmer true to scale at a few instants.
"""
import signal
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import rosbag

# Okabe and Ito's colours: told apart by everybody, in grey too.
SWIMMER, TARGET, BODY = "#0072B2", "#D55E00", "#AAAAAA"
SPACING = 1.0  # [L] at least, between the places where the swimmer itself is drawn
MOST_SHAPES = 12

OUTCOMES = {1: "captured", 2: "not captured (time-out)", 3: "aborted"}


def read(path):
    """(Episode messages, states, targets as rows of x, y [m]) of a bag."""
    episodes, states, targets = [], [], []
    with rosbag.Bag(path) as bag:
        for topic, message, _ in bag.read_messages():
            name = topic.rpartition("/")[2]
            if name == "state":
                states.append(message)
            elif name == "target":
                targets.append((message.point.x, message.point.y))
            elif name == "episode":
                episodes.append(message)
    return episodes, states, np.array(targets).reshape(-1, 2)


def length_scale(episode):
    """[m] of one L, from the effective configuration in the bag."""
    for line in episode.config.splitlines():
        key, _, value = line.strip().partition(": ")
        if key == "length_scale":
            return float(value)
    return 1.0


def outline(state):
    """(N + 1, 2) [L] ends of the links."""
    length = 1.0 / len(state.theta)
    steps = length * np.column_stack([np.cos(state.theta), np.sin(state.theta)])
    return np.vstack([state.x_1, state.x_1 + np.cumsum(steps, axis=0)])


def places(centroids):
    """Indices of the states to draw the swimmer in: start, end, and some far apart between them."""
    shown = [0]
    spacing = max(SPACING, np.ptp(centroids, axis=0).max() / MOST_SHAPES)
    for index, centroid in enumerate(centroids):
        if min(np.linalg.norm(centroid - centroids[other]) for other in (shown[-1], -1)) > spacing:
            shown.append(index)
    return shown + [len(centroids) - 1]


def title(last):
    text = f"{last.task}, seed {last.seed}, episode {last.episode}: "
    text += OUTCOMES.get(last.status, "not ended")
    text += f" after {last.step} steps\n"
    return text + (f"t = {last.time:.6g} T0, distance {last.distance:.3g} L, "
                   f"mean speed {last.mean_speed:.3g} L/T0")


def draw(path, picture):
    episodes, states, targets = read(path)
    if not episodes or not states:
        raise ValueError(f"{path} holds no episode")
    centroids = np.array([state.centroid for state in states])
    targets = targets / length_scale(episodes[0])

    figure, axes = plt.subplots(figsize=(8, 6), dpi=130)
    for index in places(centroids):
        axes.plot(*outline(states[index]).T, color=BODY, linewidth=2.5, zorder=1,
                  solid_capstyle="round", solid_joinstyle="round")
    axes.plot(*targets.T, color=TARGET, linewidth=0.8, zorder=2, label="target")
    axes.plot(*centroids.T, color=SWIMMER, linewidth=1.3, zorder=3, label="swimmer's centroid")
    for points, colour, marker, size in ((centroids, SWIMMER, "o", 8), (targets, TARGET, "*", 13)):
        if len(points):
            axes.plot(*points[0], marker, color="white", markeredgecolor=colour, markersize=size,
                      zorder=4)
            axes.plot(*points[-1], marker, color=colour, markeredgecolor="white", markersize=size,
                      zorder=4)
    axes.plot([], [], color=BODY, linewidth=2.5, label="swimmer, true to scale")
    axes.plot([], [], "o", color="white", markeredgecolor="0.3", label="start")
    axes.plot([], [], "o", color="0.3", label="end")

    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("x / L")
    axes.set_ylabel("y / L")
    axes.set_title(title(episodes[-1]), fontsize=10)
    axes.grid(color="0.9", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.legend(fontsize=8, framealpha=0.9)
    figure.tight_layout()
    figure.savefig(picture)


def main(arguments):
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # end quietly with the recorder
    if arguments in (["-h"], ["--help"]):
        print(__doc__)
        return 0
    if len(arguments) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        draw(*arguments)
    except (OSError, ValueError, rosbag.ROSBagException) as error:
        print(f"draw_episode.py: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
