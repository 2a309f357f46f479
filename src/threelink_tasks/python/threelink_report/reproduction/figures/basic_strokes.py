"""Fig. 1b: the three basic strokes and the way of the centroid."""
import matplotlib.pyplot as plt
import numpy as np

from .look import arrow, phase_plane

TITLE = "Three basic strokes (Fig. 1b)"
INPUTS = r"data/strokes/\w+(?<!_rates)\.csv"
STROKES = (("purcell", "#777777", "-", "±π/3"), ("clockwise", "#E69F00", "--", "−π/2 to π/6"),
           ("counterclockwise", "#000000", (0, (1.2, 1)), "−π/6 to π/2"))
CYCLES = 12


def repeated(rows, cycles):
    """(n, 2) the centroid's way over some cycles: each one turns and moves what follows."""
    way = np.column_stack([rows["xc"], rows["yc"]])
    turn = rows["theta_2"][-1] - rows["theta_2"][0]
    rotate = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    whole, piece = [way], way - way[0]
    for _ in range(cycles - 1):
        piece = piece @ rotate.T
        whole.append(whole[-1][-1] + piece)
    return np.vstack(whole)


def draw(results):
    figure, (left, right) = plt.subplots(1, 2, figsize=(7.1, 3.1), constrained_layout=True,
                                         gridspec_kw={"width_ratios": [1, 1.35]})
    for name, colour, dash, label in STROKES:
        rows = results.stroke(name)
        angles = np.column_stack([rows["theta_2"] - rows["theta_1"],
                                  rows["theta_3"] - rows["theta_2"]])
        left.plot(*angles.T, color=colour, linestyle=dash, linewidth=1.4, label=label)
        for corner in range(4):
            arrow(left, angles, corner * (len(angles) - 1) // 4 + len(angles) // 8, colour)
        left.plot(*angles[0], "o", color="white", markeredgecolor=colour, markersize=5, zorder=4)
        way = repeated(rows, CYCLES)
        right.plot(*way.T, color=colour, linestyle=dash, linewidth=1.1, label=label)
        right.plot(*way[-1], "o", color=colour, markersize=4, zorder=4)
    phase_plane(left)
    right.plot(0, 0, "o", color="white", markeredgecolor="0.2", markersize=6, zorder=4)
    right.set_aspect("equal", adjustable="datalim")
    right.set(xlabel="x / L", ylabel="y / L")
    right.legend(title="hinge angles", fontsize="small", title_fontsize="small")
    return figure


def caption(_results):
    return (f"Left: the hinges move one at a time, at unit rate, clockwise in the phase plane from the "
            f"open circle. Right: {CYCLES} cycles of each, from the open circle to the dot, middle "
            "link along x at the start. Angles that are symmetric about 0 swim straight; those "
            "from −π/2 to π/6 turn clockwise, those from −π/6 to π/2 counter-clockwise, "
            "as in the paper.")
