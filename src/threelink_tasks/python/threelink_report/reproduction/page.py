"""The page of a run: page OUT.html, in the run's folder. All is in the one file, nothing is fetched.

Every text is escaped, whatever file it comes from.
"""
import base64
import html
import json
import os
import sys

from threelink_report import player

from . import table as numbers
from .experiments import EPISODES, STRATEGIES
from .figures import FIGURES
from .results import Results
from .stage import sha256

EPISODE_TITLES = {"star": "The star", "pursuit_0": "Diffusing target at rest",
                  "pursuit_05": "Diffusing target at half the speed",
                  "pursuit_1": "Diffusing target at equal speed"}
# What a browser may do for this page: draw what is in it, and nothing else.
POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'"
SECTIONS = (("numbers", "Numbers"), ("figures", "Figures"), ("episodes", "Episodes"),
            ("configuration", "Configuration"), ("commands", "Commands"))


def text(value):
    return html.escape(str(value))


def element(tag, content, **attributes):
    """content is HTML."""
    named = "".join(f' {name.rstrip("_").replace("_", "-")}="{text(value)}"'
                    for name, value in attributes.items())
    return f"<{tag}{named}>{content}</{tag}>"


# --- Parts ----------------------------------------------------------------------------------------


def introduction(results, table):
    verdicts = [entry["verdict"] for group in table["groups"] for entry in group["rows"]]
    met, missed = verdicts.count(numbers.MET), verdicts.count(numbers.MISSED)
    seeds = len(results.seeds("data/evaluate", "vfs", "json"))
    made = (f"Everything here was trained from nothing, {seeds} seeds of each strategy."
            if results.is_full else
            "A quick run: it measures the shipped policies, one of each strategy, so that there are "
            "no intervals over seeds; only the learning curves and the sweep of N_s were trained, "
            "briefly.")
    counts = element("span", f"{met} bars met", class_="met") + ", " + element(
        "span", f"{missed} missed", class_="missed" if missed else "soft")
    return (element("h1", "Navigation of a three-link microswimmer, made again")
            + element("p", "The figures and numbers of Lai, Heydari, Pak and Man, "
                           "<i>Navigation of a three-link microswimmer via deep reinforcement "
                           "learning</i>, as threelink computes them, beside the paper's values and "
                           "the optimum. " + text(made))
            + element("p", counts, class_="verdicts")
            + element("p", f"Revision <code>{text(results.run['revision'])}</code>. Lengths are in L, "
                           "the swimmer's length, times in T0.", class_="soft")
            + element("nav", " ".join(element("a", text(title), href="#" + name)
                                      for name, title in SECTIONS)))


def table_html(table):
    head = element("thead", element("tr", "".join(
        element("th", text(name), scope="col") for name in numbers.HEADER)))
    body = ""
    for group in table["groups"]:
        body += element("tr", element("th", text(group["title"]), colspan=len(numbers.HEADER),
                                      scope="rowgroup"), class_="group")
        for entry in group["rows"]:
            quantity, *rest = numbers.cells(entry)
            cells = element("th", text(quantity), scope="row")
            for name, value in zip(numbers.HEADER[1:], rest):
                kind = {"class_": entry["verdict"]} if name == "verdict" and entry["bar"] else {}
                cells += element("td", text(value), data_label=name, **kind)
            body += element("tr", cells)
    note = ("Ours: mean over seeds, with the 95 % interval of that mean by Student's t; one value "
            "without. Optimum: of the strategies, the best stroke found for the same objective; of "
            "the optimal strokes, a reference from another program. Difference: of ours from "
            "what is named.")
    return (element("table", head + element("tbody", body), class_="results")
            + element("p", text(note), class_="soft"))


def figure(results, name):
    words = results.json(f"figures/{name}.json")
    with open(results.path(f"figures/{name}.png"), "rb") as file:
        data = base64.b64encode(file.read()).decode()
    picture = f'<img src="data:image/png;base64,{data}" alt="{text(words["title"])}" loading="lazy">'
    return element("figure", element("h3", text(words["title"])) + picture
                   + element("figcaption", text(words["caption"])), id=f"figure-{name}",
                   class_="picture")


def episodes(results):
    parts = [element("p", "Each episode was played over ROS topics and recorded in a bag, from which "
                          "these players, the figures and the movies in <code>movies/</code> are "
                          "made.")]
    for name in EPISODES:
        if f"bags/{name}.bag" not in results.files:
            continue
        episode = results.episode(name)
        parts.append(element("h3", text(EPISODE_TITLES[name]))
                     + player.player(episode, f"player-{name}"))
    return "\n".join(parts)


def configuration(results):
    files = [name for name in results.files if name.startswith("policies/")]
    rows = "".join(element("tr", element("th", text(name), scope="row")
                           + element("td", element("code", sha256(results.path(name)))))
                   for name in files)
    hashes = element("details", element("summary", f"{len(files)} policy files and their sha256")
                     + element("table", element("tbody", rows), class_="results"))
    parts = []
    for name in STRATEGIES:
        path = f"policies/{name}_0.safetensors"
        if path in files:
            parts.append(element("details", element("summary", f"training of {text(name)}")
                                 + element("pre", text(training_configuration(results.path(path))))))
    return hashes + "".join(parts)


def training_configuration(path):
    """The YAML that a policy file keeps of its training."""
    with open(path, "rb") as file:
        length = int.from_bytes(file.read(8), "little")
        return json.loads(file.read(length))["__metadata__"]["config"]


def commands(results):
    lines = "\n".join(f"# {stage['title']}\n{stage['command']}" for stage in results.run["stages"])
    return (element("p", "In the folder of this run, with OUT for the folder that the command writes "
                         "to; what it writes is then moved to its place. Programs are those of the "
                         "sourced workspace, roslaunch ends by itself.")
            + element("details", element("summary", f"{len(results.run['stages'])} commands")
                      + element("pre", text(lines))))


def build(results):
    table = results.json("table.json")
    parts = {"numbers": table_html(table),
             "figures": "\n".join(figure(results, name) for name in FIGURES
                                  if f"figures/{name}.png" in results.files),
             "episodes": episodes(results), "configuration": configuration(results),
             "commands": commands(results)}
    sections = "\n".join(element("section", element("h2", title) + parts[name], id=name)
                         for name, title in SECTIONS)
    with open(os.path.join(os.path.dirname(__file__), "page.css"),
              encoding="utf-8") as file:
        style = file.read()
    return ("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
            f"<meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n"
            "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
            f"<title>threelink: the paper, made again</title>\n<style>\n{style}</style>\n"
            f"{player.head()}\n</head>\n<body>\n{introduction(results, table)}\n{sections}\n"
            "</body>\n</html>\n")


def main(out):
    with open(out, "w", encoding="utf-8") as file:
        file.write(build(Results()))


if __name__ == "__main__":
    main(*sys.argv[1:])
