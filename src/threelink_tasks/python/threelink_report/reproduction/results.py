"""The files of a run, as its figures, table and page read them.

Only files that run.json names count: a folder may hold what another run left there.
"""
import functools
import json
import math
import os
import re

import numpy as np

from threelink_report.episode import SMOOTHING, read_episode

from .experiments import PENALTIES

# 97.5 % quantile of Student's t by degrees of freedom.
T_975 = (math.nan, 12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262)
B = 6.0  # of the reward b dx - c W, of all trainings


class Results:
    def __init__(self, folder="."):
        self.folder = folder
        self.run = self.json("run.json")
        self.published = self.run["published"]
        self.files = [name for stage in self.run["stages"] for name in stage["outputs"]]

    @property
    def is_full(self):
        return self.run["mode"] == "full"

    def path(self, name):
        return os.path.join(self.folder, name)

    def json(self, name):
        with open(self.path(name), encoding="utf-8") as file:
            return json.load(file)

    def seeds(self, kind, name, ending):
        """Files KIND/NAME_SEED.ENDING, by seed."""
        pattern = re.compile(rf"{re.escape(kind)}/{re.escape(name)}_(\d+)\.{ending}")
        found = [(int(match.group(1)), path) for path in self.files
                 for match in [pattern.fullmatch(path)] if match]
        return [path for _, path in sorted(found)]

    def evaluations(self, name):
        return [self.json(path) for path in self.seeds("data/evaluate", name, "json")]

    def trials(self, name):
        return [self.json(path) for path in self.seeds("data/trials", name, "json")]

    def curves(self, name):
        """[(episodes, mean return of an episode)] of the trainings, by seed."""
        curves = []
        for path in self.seeds("training", name, "csv"):
            rows = np.genfromtxt(self.path(path), delimiter=",", names=True)
            curves.append((rows["episodes"], rows["mean_return"]))
        return curves

    def ways(self, name, seed=0):
        """From theta_2 = 0, pi/3 and pi/2."""
        rows = np.genfromtxt(self.path(f"data/way/{name}_{seed}.csv"), delimiter=",", names=True)
        return [Way(rows[rows["start"] == start]) for start in range(3)]

    @functools.lru_cache(maxsize=None)
    def episode(self, name):
        return read_episode(self.path(f"bags/{name}.bag"))

    def stroke(self, name):
        return np.genfromtxt(self.path(f"data/strokes/{name}.csv"), delimiter=",", names=True)

    def optimum(self, name):
        return self.json(f"data/optimum/{name}.json")


class Way:
    """A straight start towards theta_T = 0, with what threelink_report.episode.Motion needs."""

    gamma = 0.5
    smoothing = SMOOTHING
    FAR = 1e9  # [L] a target in the direction theta_T = 0

    def __init__(self, rows):
        self.times, self.dt = rows["t"], rows["t"][1]
        self.heading = rows["theta_2"]
        self.alpha = np.column_stack([rows["alpha_1"], rows["alpha_2"]])
        self.work = np.diff(rows["work"], prepend=0)
        # The paper's start: x_1 = (1, 0), straight, so that the centroid is half a length ahead.
        start = [1 + math.cos(self.heading[0]) / 2, math.sin(self.heading[0]) / 2]
        self.centroids = np.column_stack([rows["xc"], rows["yc"]]) + start
        self.targets = self.centroids + [self.FAR, 0]

    def last_stroke(self, period):
        """(alpha_1, alpha_2) of the last `period` steps, closed."""
        return self.alpha[-int(round(period)) - 1:]


def loop(optimum):
    """(pieces + 1, 2) [rad] hinge angles of an optimal stroke."""
    rates = np.array(optimum["rates"])
    start = np.array(optimum["start"]["alpha"])
    return np.vstack([start, start + np.cumsum(rates * optimum["dt"], axis=0)])


def interval(values):
    """(mean, half width of its 95 % interval by Student's t); the latter None for one value."""
    values = np.asarray(values, float)
    n = len(values)
    if n < 2:
        return float(values.mean()), None
    return float(values.mean()), float(T_975[n - 1] * values.std(ddof=1) / math.sqrt(n))


def objective(evaluation, name, gamma=0.5):
    """v - c P / b [L/T0], with the power from efficiency = gamma v^2 / P."""
    power = gamma * evaluation["speed"] ** 2 / evaluation["efficiency"]
    return evaluation["speed"] - PENALTIES[name] * power / B
