"""What several figures draw alike."""
import numpy as np
from matplotlib.patches import Rectangle

from threelink_report.style import CURVES, SWIMMER

VFS, EAS, OPTIMUM = SWIMMER, CURVES[4][0], "#000000"
COLOUR = {"vfs": VFS, "eas": EAS}
NAME = {"vfs": "VFS", "eas": "EAS"}
STARTS = ((0, "-", "0"), (1, "-.", "π/3"), (2, "--", "π/2"))  # index, dash, theta_2: as in the paper
LIMIT = 2 * np.pi / 3


def phase_plane(axes, limit=LIMIT):
    """Hinge angles in units of pi, with the joint limit as a frame."""
    axes.set_aspect("equal")
    axes.add_patch(Rectangle((-limit, -limit), 2 * limit, 2 * limit, fill=False, edgecolor="0.6",
                             linewidth=0.7, linestyle=":"))
    ticks = np.array([-2, -1, 0, 1, 2]) * np.pi / 3
    labels = ["−2π/3", "−π/3", "0", "π/3", "2π/3"]
    axes.set(xticks=ticks, yticks=ticks, xticklabels=labels, yticklabels=labels,
             xlim=(-1.08 * limit, 1.08 * limit), ylim=(-1.08 * limit, 1.08 * limit),
             xlabel=r"$\alpha_1$", ylabel=r"$\alpha_2$")


def arrow(axes, path, at, colour):
    """An arrow head along a path (n, 2), at index `at`."""
    axes.annotate("", path[at + 1], path[at], arrowprops=dict(
        arrowstyle="-|>", color=colour, mutation_scale=9, shrinkA=0, shrinkB=0))


def percent(value, digits=1):
    return f"{100 * value:.{digits}f} %"
