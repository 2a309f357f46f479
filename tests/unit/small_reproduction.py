"""The files of a reproduction, small and made up, for the tests of what reads them."""
import csv
import json
import os
import types

import numpy as np

from threelink_report.reproduction import experiments, table

SEEDS = 3
LENGTHS = (50, 200)
STEPS = 400


class SmallReproduction:
    """Writes into a folder; run.json names what it wrote."""

    def __init__(self, folder):
        self.folder, self.outputs = folder, []
        self.random = np.random.RandomState(0)
        for name in experiments.SQUARES:
            self.stroke(name)
        for name in experiments.OPTIMA:
            self.optimum(name)
        for name in [*experiments.STRATEGIES, *(f"{kind}_{steps}" for kind in experiments.SWEEPS
                                                for steps in LENGTHS)]:
            for seed in range(SEEDS):
                self.policy(f"{name}_{seed}")
        for name in experiments.EPISODES:
            for seed in range(SEEDS):
                self.json(f"data/trials/{name}_{seed}.json", {
                    "completed": 100, "trials": 100, "median_steps": 7000, "median_ratio": 1.05,
                    "final_distance_median": 0.9})
            self.json(f"data/proof/{name}.json", {"ok": True})
        self.write_run()

    def path(self, name):
        path = os.path.join(self.folder, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        if name != "run.json":
            self.outputs.append(name)
        return path

    def json(self, name, content):
        with open(self.path(name), "w") as file:
            json.dump(content, file)

    def csv(self, name, header, rows):
        with open(self.path(name), "w", newline="") as file:
            csv.writer(file).writerows([header, *rows])

    def write_run(self):
        self.json("run.json", {
            "mode": "full", "revision": "r<1>", "published": table.published(), "stages": [
                {"name": "all", "title": "all <b>", "command": "make <all>",
                 "outputs": self.outputs}]})

    def stroke(self, name):
        dx, dy, turn = table.published()["references"]["strokes"][name]
        share = np.linspace(0, 1, 9)
        rows = np.column_stack([share, -turn * share, turn * share, 0.2 * share, dx * share,
                                dy * share])
        self.csv(f"data/strokes/{name}.csv", ["t", "theta_1", "theta_2", "theta_3", "xc", "yc"], rows)

    def optimum(self, name):
        reference = table.published()["references"].get(name, 0.0129)
        speed, power = reference if isinstance(reference, list) else (0.0129154, 0.0106)
        self.json(f"data/optimum/{name}.json", {
            "speed": speed, "power": power, "efficiency": 0.012364, "period": 7.2, "dt": 1.8,
            "start": {"alpha": [-1.8, 0.0]}, "rates": [[1, 1], [1, -1], [-1, -1], [-1, 1]],
            "seconds": 1.0})

    def policy(self, run):
        start = {"theta2": 0.0, "period_steps": 72.0, "steering_steps": 100}
        self.json(f"data/evaluate/{run}.json", {
            "starts": [start] * 3, "speed": 0.0129 + 1e-6 * self.random.rand(),
            "efficiency": 0.0108 + 1e-4 * self.random.rand(), "success_rate": 1.0})
        t = 0.1 * np.arange(STEPS)
        ways = [np.column_stack([np.full(STEPS, start), t, 0.0129 * t, 0 * t, 0 * t + start,
                                 np.sin(t), np.cos(t), 0.01 * t]) for start in range(3)]
        self.csv(f"data/way/{run}.csv", ["start", "t", "xc", "yc", "theta_2", "alpha_1", "alpha_2",
                                         "work"], np.vstack(ways))
        self.csv(f"training/{run}.csv", ["episodes", "mean_return"],
                 [[20 * k, k + self.random.rand()] for k in range(1, 50)])


def episode(task):
    """Enough of a threelink_report.episode.Episode for the figures."""
    line = np.column_stack([np.linspace(0, 2, 50), np.zeros(50)])
    end = types.SimpleNamespace(waypoint=2, distance=0.0005)
    points = np.array([[1.0, 0], [2, 0]]) if task == "star" else np.empty((0, 2))
    return types.SimpleNamespace(
        centroids=line, targets=line + [0, 0.5], waypoints=points, times=0.1 * np.arange(50), end=end,
        config={"task": {"threshold": 0.001}}, outcome="captured after 49 steps",
        ends=lambda index: line[index] + np.column_stack([np.linspace(0, 1, 4), np.zeros(4)]))
