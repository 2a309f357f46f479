"""A recorded episode as arrays: the one place that reads the recorder's bags.

Lengths in L (the swimmer's length), times in T0, energies in C_perp L^3 / T0, as in the paper.
"""
import math
import os

import numpy as np
import yaml
from geometry_msgs.msg import PointStamped
from visualization_msgs.msg import MarkerArray

from threelink_msgs.msg import Episode as EpisodeMessage
from threelink_msgs.msg import SwimmerState
from threelink_report.bag import BagError, decode, printable, read_messages

SMOOTHING = 71  # positions in one mean, about a stroke; of three links, and where there is no stroke
STEADY = 500  # last steps, in which the stroke of other numbers of links is looked for
TRANSLATION = 2.5  # [degrees] |theta_s| up to which the swimmer is in translation, beyond it steers
OUTCOMES = {0: "not ended", 1: "captured", 2: "not captured (time-out)", 3: "aborted"}
CAPTURED = 1
WANTED = {"state": SwimmerState, "target": PointStamped, "episode": EpisodeMessage,
          "waypoints": MarkerArray}
DWELL = 10  # states that a target holds for on average, or else it moves
MOST_STEP = 2 ** 53  # the last whole number that every double holds
FARTHEST = 1e9  # [L] that anything is away; beyond that, pictures run out of digits
MOST_LINKS = 1000
MOST_TEXT, MOST_CONFIG = 300, 2 ** 20  # characters


class EpisodeError(ValueError):
    """A file that holds no episode; the text says why, for people."""


class Episode:
    """What a bag says of its episode; each array has a row for each state.

    steps, times (n,); centroids, x_1 (n, 2); theta (n, N); alpha, rates (n, N - 1); power, work
    (n,) and rates are those of the step that led to the state. targets (n, 2): what the task
    answered to the state; the last one has no answer, and keeps the one before. distances (n,):
    centroid to target. waypoints (k, 2): the fixed points of the task, none if its target moves.
    """

    def __init__(self, name, messages):
        if not messages["episode"] or not messages["state"]:
            raise EpisodeError("it holds no episode")
        self.name = name
        self.end = shown(messages["episode"][-1])  # the last word on the episode
        self.config = read_config(self.end.config)
        simulator = self.config["simulator"]
        self.dt, self.gamma, self.links = (simulator[key] for key in ("dt", "gamma", "links"))
        states = messages["state"]
        check(states, self.links)
        column = lambda field: np.array([getattr(state, field) for state in states], float)
        self.steps = np.array([state.step for state in states], int)
        self.times = self.dt * self.steps
        self.centroids, self.x_1 = column("centroid"), column("x_1")
        self.theta, self.alpha, self.rates = column("theta"), column("alpha"), column("hinge_rates")
        self.power, self.work = column("power"), column("work")
        self.smoothing = smoothing(self.alpha)
        metre = simulator["length_scale"]
        self.targets = answers(states, messages["target"]) / metre
        self.distances = np.linalg.norm(self.targets - self.centroids, axis=1)
        if self.end.step == self.steps[-1]:
            self.distances[-1] = self.end.distance
        self.waypoints = fixed_points(messages["waypoints"], metre, self.targets)
        places = np.vstack([self.targets, self.waypoints, self.centroids, self.x_1])
        if (np.abs(places) > FARTHEST).any() or np.isinf(self.waypoints).any():
            raise EpisodeError(f"something in it is farther away than {FARTHEST:g} L")

    @property
    def captured(self):
        return self.end.status == CAPTURED

    @property
    def outcome(self):
        reason = f" ({self.end.reason})" if self.end.reason else ""
        return f"{OUTCOMES.get(self.end.status, 'not ended')}{reason} after {self.steps[-1]} steps"

    @property
    def energy(self):
        return self.work.sum()

    def waypoints_reached(self, index):
        """How many waypoints were reached by a state: each time another one is the target."""
        if not len(self.waypoints):
            return 0
        changes = (np.diff(self.targets[:index + 1], axis=0) != 0).any(axis=1).sum()
        return changes + (self.captured and index == len(self.steps) - 1)

    def ends(self, index):
        """(N + 1, 2) ends of the links in a state."""
        links = np.column_stack([np.cos(self.theta[index]), np.sin(self.theta[index])]) / self.links
        return np.vstack([self.x_1[index], self.x_1[index] + np.cumsum(links, axis=0)])

    def title(self):
        """One line: which episode it is."""
        return f"{self.end.task}, seed {self.end.seed}, episode {self.end.episode}"

    def facts(self):
        """[(what, text)] for a table, the most important first."""
        end = self.end
        facts = [
            ("task", end.task),
            ("seed, episode", f"{end.seed}, {end.episode}"),
            ("outcome", self.outcome),
            ("time", f"{self.times[-1]:.6g} T0"),
            ("distance to the target at the end", f"{end.distance:.3g} L"),
            ("net displacement / time", f"{end.mean_speed:.4g} L/T0"),
            ("energy", f"{self.energy:.4g} C⊥ L³/T0"),
            ("swimmer", f"{self.links} links, γ = {self.gamma:g}, Δt = {self.dt:g} T0"),
            ("policy", os.path.basename(end.policy_file) or "unknown"),
            ("sha256 of the policy", end.policy_sha256 or "unknown"),
            ("software", end.revision or "unknown"),
            ("bag", self.name + ".bag"),
        ]
        if len(self.waypoints):
            facts.insert(3, ("waypoints reached", f"{end.waypoint} of {len(self.waypoints)}"))
        missing = self.steps[-1] - self.steps[0] + 1 - len(self.steps)
        if missing:
            facts.insert(3, ("states that the recorder missed", str(missing)))
        return facts


class Motion:
    """The smoothed way: each value is a mean over episode.smoothing positions around its time.

    Row j belongs to state j + episode.smoothing // 2; there are none of less than that many + 1.
    """

    def __init__(self, episode):
        width = episode.smoothing
        if len(episode.times) <= width:
            self.times = self.speed = self.power = self.efficiency = self.theta_s = np.empty(0)
            self.way, self.steering = np.empty((0, 2)), np.empty(0, bool)
            return
        mean = lambda values: np.convolve(values, np.full(width, 1 / width), "valid")
        self.way = np.column_stack([mean(column) for column in episode.centroids.T])
        velocity = np.diff(self.way, axis=0) / episode.dt
        middle = slice(width // 2, width // 2 + len(velocity))
        self.times = episode.times[middle]
        self.speed = np.linalg.norm(velocity, axis=1)
        # Row k + 1 is the work from the smoothed position k to the next.
        self.power = mean(episode.work[1:]) / episode.dt
        with np.errstate(divide="ignore", invalid="ignore"):
            self.efficiency = episode.gamma * self.speed ** 2 / self.power
        to_target = episode.targets[middle] - self.way[:-1]
        angles = [np.arctan2(v[:, 1], v[:, 0]) for v in (velocity, to_target)]
        # In [-180, 180) degrees.
        self.theta_s = (np.degrees(angles[0] - angles[1]) + 180) % 360 - 180
        self.steering = np.abs(self.theta_s) > TRANSLATION


def smoothing(alpha):
    """Positions, an odd number, whose mean is free of the stroke's to and fro; threelink_sim/stroke_period.hpp.

    alpha (n, N - 1). Of three links it is always the same.
    """
    alpha = alpha[-STEADY - 1:]
    if alpha.shape[1] <= 2 or len(alpha) < 2:
        return SMOOTHING
    spread = alpha - alpha.mean(axis=0)
    plane = spread @ np.linalg.eigh(spread.T @ spread)[1][:, -2:]
    if np.linalg.norm(plane[:, 0]) <= 1e-9 * np.linalg.norm(plane[:, 1]):
        return SMOOTHING
    plane -= plane[:-1].mean(axis=0)
    turns = np.diff(np.unwrap(np.arctan2(plane[:, 1], plane[:, 0])))
    turned = np.abs(np.cumsum(turns[::-1])) / (2 * math.pi)  # within the last 1, 2, .. steps
    strokes = math.floor(turned.max())
    if not strokes:
        return SMOOTHING
    period = (1 + int(np.argmax(turned >= strokes))) / strokes
    return 2 * round((period - 1) / 2) + 1


def read_episode(path):
    """The episode of a bag. Raises EpisodeError for a file that is none or holds none."""
    try:
        stored = read_messages(path)
    except BagError as error:
        raise EpisodeError(error) from None
    messages = {name: [] for name in WANTED}
    try:
        for message in stored:
            name = message.topic.rpartition("/")[2]
            if name in WANTED:
                messages[name].append(decode(message, WANTED[name]))
        return Episode(os.path.splitext(os.path.basename(path))[0], messages)
    except (BagError, EpisodeError) as error:
        raise EpisodeError(f"{path}: {error}") from None


def shown(message):
    """An Episode message with texts that can be shown."""
    for field in ("task", "reason", "policy_file", "policy_sha256", "revision"):
        setattr(message, field, printable(getattr(message, field)[:MOST_TEXT]))
    return message


def check(states, links):
    """Raises EpisodeError unless the states follow each other, with finite numbers, of so many links."""
    before = -1
    for state in states:
        if not before < state.step < MOST_STEP:
            raise EpisodeError(f"state {state.step} follows state {before}")
        before = state.step
        if (len(state.theta), len(state.alpha), len(state.hinge_rates)) != (links, links - 1, links - 1):
            raise EpisodeError(f"state {state.step} is not of {links} links")
        numbers = (*state.theta, *state.alpha, *state.hinge_rates, *state.centroid, *state.x_1,
                   state.power, state.work)
        if not all(abs(number) <= FARTHEST for number in numbers):
            raise EpisodeError(f"state {state.step} has a number that none of a swimmer is")


class PlainLoader(yaml.SafeLoader):
    """Takes no aliases, of which a few lines could become any number of nodes."""

    def compose_node(self, parent, index):
        if self.check_event(yaml.AliasEvent):
            raise yaml.YAMLError("an alias")
        return super().compose_node(parent, index)


def read_config(text):
    """{"simulator": {...}, "task": {...}}; the numbers that are relied on are numbers."""
    wrong = EpisodeError("its episode does not say of what configuration it is")
    if len(text) > MOST_CONFIG:
        raise wrong
    try:
        config = yaml.load(text, PlainLoader)
        simulator, task = config["simulator"], config["task"]
        for key in ("dt", "gamma", "length_scale", "joint_limit"):
            # YAML 1.1 takes 1e-05 for a string.
            simulator[key] = float(simulator[key])
            if not 1e-9 <= simulator[key] <= FARTHEST:
                raise wrong
        links = simulator["links"]
    except (yaml.YAMLError, KeyError, TypeError, ValueError, OverflowError, RecursionError):
        raise wrong from None
    if type(links) is not int or not 2 <= links <= MOST_LINKS or not isinstance(task, dict):
        raise wrong
    return config


def answers(states, targets):
    """(n, 2) [m] the target that answers each state: that of its stamp, or else the one before."""
    points = {target.header.stamp: (target.point.x, target.point.y) for target in targets}
    if not all(math.isfinite(number) for point in points.values() for number in point):
        raise EpisodeError("it has a target that is nowhere")
    rows, row = [], (np.nan, np.nan)
    for state in states:
        row = points.get(state.header.stamp, row)
        rows.append(row)
    return np.array(rows)


def fixed_points(waypoints, metre, targets):
    """(k, 2) [L] as rviz is shown them; without that, the different targets, unless these move."""
    if waypoints:
        places = [m.pose.position for m in waypoints[0].markers if m.ns == "waypoints"]
        return np.array([(place.x, place.y) for place in places]).reshape(-1, 2) / metre
    points, first = np.unique(targets[~np.isnan(targets[:, 0])], axis=0, return_index=True)
    if len(points) > max(1, len(targets) / DWELL):
        return np.empty((0, 2))
    return points[np.argsort(first)]
