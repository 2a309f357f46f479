#!/usr/bin/python3
"""Draws how the shipped policies trace the paper's star by the literal rule, side by side.

  star_picture.py OUT.png [--steps 20000]

Needs a sourced workspace, with the tests built (`play_episode`).
"""
import argparse
import os
import subprocess

import matplotlib
import rospkg

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

FOLDER = os.path.join(rospkg.RosPack().get_path("threelink_tasks"), "config/policies")
POLICIES = (("vfs", "mean"), ("homing_direction", "sampled"), ("homing", "sampled"))


def play(policy, how, steps):
    """Centroids and targets of the star's episode 1."""
    lines = subprocess.run(
        ["rosrun", "threelink_tests", "play_episode", os.path.join(FOLDER, policy + ".safetensors"),
         "0", "1", "waypoints", "{max_steps: %d}" % steps, how], check=True,
        stdout=subprocess.PIPE, universal_newlines=True).stdout.splitlines()
    rows = [[float.fromhex(word) for word in line.split()] for line in lines]
    return [row[0:2] for row in rows], [row[5:7] for row in rows]


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out")
    parser.add_argument("--steps", type=int, default=20000)
    options = parser.parse_args()
    figure, panels = plt.subplots(1, len(POLICIES), figsize=(13, 4.6), sharex=True, sharey=True)
    for panel, (policy, how) in zip(panels, POLICIES):
        centroids, targets = play(policy, how, options.steps)
        points = sorted(set(map(tuple, targets)), key=lambda p: targets.index(list(p)))
        panel.plot(*zip(*centroids), linewidth=0.6)
        panel.plot(*zip(*points), "k+", markersize=8)
        reached = len(points) if len(centroids) <= options.steps else len(points) - 1
        panel.set_title("%s, %s action\n%d of 10 points in %d steps" % (policy, how, reached,
                                                                       len(centroids) - 1))
        panel.set_aspect("equal")
        panel.set_xlabel("x / L")
    panels[0].set_ylabel("y / L")
    figure.tight_layout()
    figure.savefig(options.out, dpi=110, bbox_inches="tight")


if __name__ == "__main__":
    main()
