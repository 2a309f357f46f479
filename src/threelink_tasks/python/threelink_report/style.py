"""How all pictures look: told apart by everybody, in grey too.

Colours are Okabe and Ito's; what a colour tells, a marker, a dash or a place tells as well.
"""
import os
import warnings

import matplotlib

matplotlib.use("Agg")  # no window, also where there is a display
import matplotlib.pyplot as plt

from threelink_report.files import replacing

SWIMMER, TARGET, BODY, STEERING = "#0072B2", "#D55E00", "#AAAAAA", "#E4E4E4"
# (colour, dash) of curves that are compared, from dark to light in grey.
CURVES = (("#000000", "-"), ("#0072B2", (0, (5, 1.5))), ("#D55E00", (0, (1.5, 1.5))),
          ("#009E73", (0, (6, 1.5, 1.5, 1.5))), ("#CC79A7", (0, (8, 3))), ("#E69F00", (0, (3, 3))))


def use_style():
    warnings.filterwarnings("ignore", "Glyph .* missing")  # a box stands for it
    plt.rcParams.update({
        "font.size": 8, "axes.axisbelow": True, "axes.grid": True, "grid.color": "0.9",
        "grid.linewidth": 0.6, "pdf.fonttype": 42})  # text stays text in a PDF


def plain(text):
    """Text of which no part is taken for a formula."""
    return text.replace("$", r"\$")


def save(figure, path):
    with replacing(path) as part:
        figure.savefig(part, format=os.path.splitext(path)[1][1:] or "png")
    plt.close(figure)
