"""A movie of a recorded episode: the swimmer true to scale, its way, its target, and a clock."""
import errno
import math
import shutil
import subprocess
import tempfile

import matplotlib.pyplot as plt
import numpy as np

from threelink_report.episode import Motion
from threelink_report.files import OutputError, replacing
from threelink_report.style import BODY, SWIMMER, TARGET, plain

WIDTH, HEIGHT, DPI = 1280, 720, 100
RATE = 30  # frames/s
SECONDS = 25  # that an episode takes, but
MOST_SKIPPED = 12  # steps a frame at most: fewer than six frames a stroke look like another stroke
LAST = RATE  # frames that the end is shown for
NEAR = 4  # a target farther away than this many sizes of the way is not in the view


class MovieError(ValueError):
    """Why there is no movie, for people."""


def write_movie(episode, path, seconds=None, report=lambda share: None):
    """Writes an MP4; report(share of it that is done) is called after each frame.

    seconds: how long it takes, without the last second, which shows the end. By default 25, or as
    many as six frames a stroke need. No step is shown twice: short episodes are over earlier.
    """
    if not shutil.which("ffmpeg"):
        raise MovieError("ffmpeg is missing; `apt-get install ffmpeg` installs it")
    last = len(episode.steps) - 1
    stride = max(1, math.ceil(last / RATE / (seconds or SECONDS)))
    if seconds is None:
        stride = min(stride, MOST_SKIPPED)
    frames = [*range(0, last, stride)] + [last] * LAST
    scene = Scene(episode, stride * episode.dt * RATE)
    with replacing(path) as part, Encoder(part) as images:
        for number, index in enumerate(frames):
            images.write(scene.frame(index))
            report((number + 1) / len(frames))
    plt.close(scene.figure)


class Encoder:
    """Where to write images to, as RGBA, that ffmpeg makes a movie of."""

    def __init__(self, path):
        self.path = path
        self.errors = tempfile.TemporaryFile()
        self.process = subprocess.Popen(
            ["ffmpeg", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgba",
             "-s", f"{WIDTH}x{HEIGHT}", "-r", str(RATE), "-i", "-", "-an", "-c:v", "libx264",
             "-preset", "veryfast", "-crf", "20", "-pix_fmt", "yuv420p", "-movflags", "+faststart",
             "-fflags", "+bitexact", "-f", "mp4", path],
            stdin=subprocess.PIPE, stderr=self.errors)

    def __enter__(self):
        return self.process.stdin

    def __exit__(self, kind, error, trace):
        try:
            self.process.stdin.close()
        except BrokenPipeError:
            pass
        if self.process.wait() and kind in (None, BrokenPipeError):
            self.errors.seek(0)
            text = self.errors.read().decode(errors="replace").strip()
            raise OutputError(errno.EIO, f"ffmpeg failed: {text}", self.path)


class Scene:
    """Draws one frame after the other.

    What stays is drawn once, into a background to which the trails are added as they grow.
    """

    def __init__(self, episode, speed):
        self.episode = episode
        self.motion = Motion(episode)
        self.figure = plt.figure(figsize=(WIDTH / DPI, HEIGHT / DPI), dpi=DPI, facecolor="white")
        self.figure.text(0.06, 0.95, plain(episode.title()), fontsize=14, weight="bold", va="center")
        self.figure.text(0.72, 0.05, f"{speed:.3g} T₀ a second", fontsize=11, color="0.35")
        self.world = self.figure.add_axes([0.06, 0.08, 0.62, 0.83])
        self.plane = self.figure.add_axes([0.755, 0.46, 0.225, 0.40])
        self.draw_ground()
        self.make_moving_parts()
        self.figure.canvas.draw()
        self.background = self.figure.canvas.copy_from_bbox(self.figure.bbox)
        self.drawn = 0

    def draw_ground(self):
        low, high = bounds(self.episode)
        size = self.world.get_window_extent().size  # [pixels]
        half = 0.5 * size * ((high - low) / size).max()
        self.low, self.high = 0.5 * (low + high) - half, 0.5 * (low + high) + half
        self.world.set(xlim=(self.low[0], self.high[0]), ylim=(self.low[1], self.high[1]),
                       xlabel="x / L", ylabel="y / L")
        self.dots = spaced(self.episode.targets, half.max() / 80)
        self.world.plot(*self.episode.centroids.T, color=BODY, linewidth=0.7)
        alpha, limit = np.degrees(self.episode.alpha), self.joint_limit()
        self.plane.plot(alpha[:, 0], alpha[:, -1], color=BODY, linewidth=0.4)
        self.plane.set(aspect="equal", xlim=(-limit, limit), ylim=(-limit, limit),
                       xlabel="first hinge / degrees", ylabel="last hinge / degrees")
        for axes in (self.world, self.plane):
            axes.tick_params(labelsize=10)
            axes.xaxis.label.set_size(11)
            axes.yaxis.label.set_size(11)

    def joint_limit(self):
        return 1.08 * math.degrees(self.episode.config["simulator"]["joint_limit"])

    def make_moving_parts(self):
        line = lambda axes, *style, **more: axes.plot([], [], *style, animated=True, **more)[0]
        self.way = line(self.world, color=SWIMMER, linewidth=2)
        self.target_way = line(self.world, ".", color=TARGET, markersize=4)
        self.ahead = line(self.world, "o", color="white", markeredgecolor=TARGET, markersize=9)
        self.behind = line(self.world, "o", color=BODY, markersize=9)
        self.target = line(self.world, "*", color=TARGET, markeredgecolor="white", markersize=18)
        self.swimmer = line(self.world, "o-", color="black", linewidth=5, markersize=7,
                            markerfacecolor="white", solid_joinstyle="round")
        self.centroid = line(self.world, "o", color=SWIMMER, markeredgecolor="white", markersize=8)
        self.stroke = line(self.plane, color=SWIMMER, linewidth=2)
        self.shape = line(self.plane, "o", color=SWIMMER, markeredgecolor="white", markersize=8)
        parts = ((self.swimmer, "swimmer, 1 L long"), (self.way, "way of its centroid"),
                 (self.target_way if not len(self.episode.waypoints) else self.ahead, "target"))
        self.figure.legend(*zip(*parts), loc="lower left", bbox_to_anchor=(0.712, 0.08),
                           fontsize=11, frameon=False, borderpad=0)
        self.clock = self.figure.text(0.72, 0.95, "", fontsize=14, va="center", animated=True)
        self.values = self.figure.text(0.72, 0.37, "", fontsize=12, va="top", linespacing=1.6,
                                       animated=True)

    def frame(self, index):
        """(HEIGHT, WIDTH, 4) the pixels of a state; indices must not go back."""
        canvas, episode = self.figure.canvas, self.episode
        canvas.restore_region(self.background)
        grown = slice(self.drawn, index + 1)
        self.show(self.way, episode.centroids[grown])
        if not len(episode.waypoints):
            first, end = np.searchsorted(self.dots, (grown.start, grown.stop))
            self.show(self.target_way, episode.targets[self.dots[first:end]])
        self.background = canvas.copy_from_bbox(self.figure.bbox)
        self.drawn = index

        reached = episode.waypoints_reached(index)
        self.show(self.ahead, episode.waypoints[reached:])
        self.show(self.behind, episode.waypoints[:reached])
        self.show(self.target, self.within(episode.targets[index:index + 1]))
        self.show(self.swimmer, episode.ends(index))
        self.show(self.centroid, episode.centroids[index:index + 1])
        hinges = np.degrees(episode.alpha[max(0, index - episode.smoothing):index + 1][:, [0, -1]])
        self.show(self.stroke, hinges)
        self.show(self.shape, hinges[-1:])
        self.clock.set_text(f"t = {episode.times[index]:.1f} T₀, step {episode.steps[index]}")
        self.values.set_text(self.telling(index))
        for text in (self.clock, self.values):
            self.figure.draw_artist(text)
        return canvas.buffer_rgba()

    def show(self, line, points):
        line.set_data(*points.T)
        line.axes.draw_artist(line)

    def within(self, points):
        """A target beyond the view is shown at its edge, in its direction."""
        middle, half = 0.5 * (self.low + self.high), 0.48 * (self.high - self.low)
        beyond = np.abs((points - middle) / half).max(axis=1, keepdims=True)
        return middle + (points - middle) / np.maximum(1, beyond)

    def telling(self, index):
        lines = [f"distance to the target  {self.episode.distances[index]:.4g} L"]
        row = index - self.episode.smoothing // 2
        if 0 <= row < len(self.motion.times):
            lines += [f"speed  {self.motion.speed[row]:.5f} L/T₀",
                      f"efficiency  {100 * self.motion.efficiency[row]:.2f} %"]
        if index == len(self.episode.steps) - 1:
            lines.append(plain(self.episode.outcome))
        return "\n".join(lines)


def bounds(episode):
    """Two corners [L] of the whole way, and of targets and waypoints near it."""
    low, high = episode.centroids.min(axis=0) - 0.5, episode.centroids.max(axis=0) + 0.5
    points = np.vstack([episode.targets, episode.waypoints])
    near = np.linalg.norm(points - (low + high) / 2, axis=1) < NEAR * (high - low).max()
    places = np.vstack([points[near] - 0.1, points[near] + 0.1, [low, high]])
    return places.min(axis=0), places.max(axis=0)


def spaced(points, distance):
    """Indices of points that are at least so far from the one before."""
    chosen = [0]
    for index, point in enumerate(points):
        if math.hypot(*(point - points[chosen[-1]])) >= distance:
            chosen.append(index)
    return np.array(chosen)
