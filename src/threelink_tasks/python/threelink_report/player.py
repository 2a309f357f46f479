"""A page that plays a recorded episode, with nothing but a browser.

All that it needs is in the page: the files of assets/ and the episode's numbers, single precision,
in base64. Whatever text comes from a bag is escaped.
"""
import base64
import html
import json
import os
import string

import numpy as np

from threelink_report.episode import Motion

ASSETS = os.path.join(os.path.dirname(os.path.realpath(__file__)), "assets")


def head():
    """For <head>, once in a page: style and script of all its players."""
    script = "\n".join(asset(name) for name in ("views.js", "curves.js", "player.js"))
    return f"<style>\n{asset('player.css')}</style>\n<script type=\"module\">\n{script}</script>"


def player(episode, identifier):
    """A <section> that plays an episode; the identifier is unique in its page."""
    facts = "\n".join(f"    <tr><th scope=\"row\">{html.escape(what)}</th>"
                      f"<td>{html.escape(text)}</td></tr>" for what, text in episode.facts())
    # Within <script> only `<` could end it.
    data = json.dumps(numbers(episode), separators=(",", ":")).replace("<", "\\u003c")
    return string.Template(asset("player.html")).substitute(
        id=html.escape(identifier), title=html.escape(episode.title()),
        outcome=html.escape(episode.outcome), facts=facts, data=data, smoothing=episode.smoothing)


def page(episode):
    """A whole page that plays an episode."""
    return string.Template(asset("page.html")).substitute(
        title=html.escape(f"threelink: {episode.title()}"), head=head(),
        player=player(episode, "player"))


def asset(name):
    with open(os.path.join(ASSETS, name), encoding="utf-8") as file:
        return file.read()


def numbers(episode):
    motion = Motion(episode)
    arrays = {
        "steps": episode.steps, "centroid": episode.centroids, "target": episode.targets,
        "heading": episode.theta[:, episode.links // 2], "alpha": episode.alpha,
        "speed": motion.speed, "power": motion.power, "efficiency": motion.efficiency,
        "theta_s": motion.theta_s, "distance": episode.distances,
    }
    return {
        "dt": episode.dt, "links": episode.links, "captured": episode.captured,
        "jointLimit": episode.config["simulator"]["joint_limit"], "smoothing": episode.smoothing,
        "waypoints": episode.waypoints.tolist(),
        "arrays": {name: encoded(array) for name, array in arrays.items()},
    }


def encoded(array):
    return base64.b64encode(np.asarray(array, "<f4").tobytes()).decode()
