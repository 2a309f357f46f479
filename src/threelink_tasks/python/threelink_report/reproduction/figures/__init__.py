"""The figures of the paper and its supplement, a module each.

A module has TITLE, INPUTS (pattern of the files that it reads), draw(results) -> figure and
caption(results) -> text that says what is shown.
"""
import importlib

FIGURES = {name: importlib.import_module(f".{name}", __name__) for name in (
    "basic_strokes", "learning", "navigation", "steady_motion", "optimal_strokes", "star",
    "diffusing_targets", "episode_length", "penalty")}
