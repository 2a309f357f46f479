"""Draws a figure of a run: draw NAME OUT, in the run's folder; writes OUT.png, OUT.pdf and OUT.json."""
import json
import sys

import matplotlib.pyplot as plt

from threelink_report.style import save, use_style

from .figures import FIGURES
from .results import Results


def main(name, out):
    figure, results = FIGURES[name], Results()
    use_style()
    plt.rcParams["savefig.dpi"] = 200
    drawing = figure.draw(results)
    drawing.savefig(out + ".pdf")
    save(drawing, out + ".png")
    with open(out + ".json", "w", encoding="utf-8") as file:
        json.dump({"title": figure.TITLE, "caption": figure.caption(results)}, file, indent=1)


if __name__ == "__main__":
    main(*sys.argv[1:])
