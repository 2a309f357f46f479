"""The stages of a reproduction, in the order of what they need.

quick  from the shipped policies; only the learning curves and the sweep of N_s are trained, briefly.
full   all trained from nothing, by five seeds of every strategy.

All seeds and lengths are here, and nowhere else.
"""
import dataclasses
import os
import re
import typing

from . import experiments
from .experiments import EPISODES, MODULE, PYTHON, sources
from .figures import FIGURES
from .stage import DESCRIPTION, OUT, Stage


@dataclasses.dataclass(frozen=True)
class Scale:
    """How much is done."""
    mode: str
    seeds: int                           # of each strategy that is trained
    curve_episodes: int                  # of each training of Fig. 3; 0: the configuration's
    steps_sweep: typing.Tuple[int, ...]  # N_s
    sweep_seeds: int
    sweep_episodes: int                  # 0: the configuration's
    trials: int                          # random starts of each evaluation
    stars: int
    optimum: typing.Tuple[str, ...]      # further options of optimal_stroke
    movie: typing.Tuple[str, ...]        # and of bag_to_movie


QUICK = Scale("quick", 5, 3000, (50, 100, 200), 1, 6000, 1000, 100, ("--starts", "1"),
              ("--seconds", "12"))
FULL = Scale("full", 5, 0, (25, 50, 75, 100, 150, 200), 5, 0, 2000, 1000, (), ())


def stages(scale, config):
    """config: the folder of configurations and shipped policies."""
    plan = experiments.policies(scale, config) + experiments.episodes() + movies(scale)
    plan += experiments.strokes() + experiments.optima(scale)
    plan += experiments.curves(scale, config) + experiments.sweep(scale, config)
    plan += experiments.measures(scale) + experiments.trials(scale)
    made = [name for stage in plan for name in stage.outputs]
    return plan + figures(made) + report(made)


def movies(scale):
    return [Stage(f"movie_{name}", f"movie {name}",
                  ("rosrun", "threelink_tasks", "bag_to_movie", f"bags/{name}.bag", "--out",
                   OUT + "/movie.mp4", *scale.movie),
                  {f"movies/{name}.mp4": "movie.mp4"}, (f"bags/{name}.bag",)
                  + sources("episode.py", "movie.py", "style.py"), seconds=20)
            for name in EPISODES]


def figures(made):
    plan = []
    for name, module in FIGURES.items():
        needed = [path for path in made if re.match(module.INPUTS, path)]
        plan.append(Stage(
            f"figure_{name}", f"figure {name}",
            (PYTHON, "-m", MODULE + ".draw", name, OUT + "/" + name),
            {f"figures/{name}.{kind}": f"{name}.{kind}" for kind in ("png", "pdf", "json")},
            (DESCRIPTION, *needed, *sources(
                "episode.py", "style.py", "reproduction/draw.py", "reproduction/results.py",
                "reproduction/figures/" + os.path.basename(module.__file__))), seconds=4))
    return plan


def report(made):
    table = ("table.py", "results.py")
    drawn = [f"figures/{name}.{kind}" for name in FIGURES for kind in ("png", "json")]
    bags = [name for name in made if name.startswith("bags/")]
    data = [name for name in made if name.startswith("data/") and "/way/" not in name]
    policies = [name for name in made if name.startswith("policies/")]
    return [
        Stage("table", "table", (PYTHON, "-m", MODULE + ".table", OUT + "/table.json"),
              {"table.json": "table.json"},
              (DESCRIPTION, *data, *sources(*("reproduction/" + name for name in table))), seconds=1),
        Stage("page", "page", (PYTHON, "-m", MODULE + ".page", OUT + "/report.html"),
              {"report.html": "report.html"},
              (DESCRIPTION, "table.json", *drawn, *bags, *policies,
               *sources("episode.py", "player.py", "reproduction/page.py",
                        "reproduction/page.css")), seconds=5)]
