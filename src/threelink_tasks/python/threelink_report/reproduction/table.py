"""The table of a run: quantity, paper, ours, optimum, verdict; table OUT.json, in the run's folder.

All that it holds is computed from the files that each row names.
"""
import json
import os
import sys

import numpy as np

from .experiments import EPISODES, NAVIGATOR, PENALTIES, SQUARES
from .results import B, Results, interval, objective

MET, MISSED, NONE = "met", "missed", "-"


def published():
    """What the paper states, and references from elsewhere."""
    with open(os.path.join(os.path.dirname(__file__), "published.json"),
              encoding="utf-8") as file:
        return json.load(file)


def row(quantity, values, sources, unit="", paper=None, optimum=None, bar="", met=None):
    """values: one for each seed. met: whether the bar is; None if there is no bar."""
    mean, half = interval(values)
    known = paper if isinstance(paper, float) else None
    return {"quantity": quantity, "unit": unit, "paper": paper, "ours": mean, "half_width": half,
            "seeds": len(values), "least": float(min(values)), "most": float(max(values)),
            "optimum": optimum,
            "to_paper": None if not known else mean / known - 1,
            "to_optimum": None if not optimum else mean / optimum - 1,
            "bar": bar, "verdict": NONE if met is None else MET if met else MISSED,
            "sources": list(sources)}


# --- Physics and optima ---------------------------------------------------------------------------


def stroke_rows(results):
    rows = []
    for name in SQUARES:
        way = results.stroke(name)
        ours = [way[field][-1] - way[field][0] for field in ("xc", "yc", "theta_2")]
        error = float(np.abs(np.subtract(ours, results.published["references"]["strokes"][name])).max())
        label = "basic stroke " + {"purcell": "±π/3", "clockwise": "−π/2 to π/6",
                                   "counterclockwise": "−π/6 to π/2"}[name]
        source = [f"data/strokes/{name}.csv"]
        displacement = row(label + ": displacement a cycle", [float(np.hypot(*ours[:2]))], source,
                           "L", "picture", met=error <= 1e-9,
                           bar="x, y and rotation within 1e-9 of 40-digit arithmetic")
        displacement["error"] = error
        rows += [displacement, row(label + ": rotation a cycle", [float(ours[2])], source, "rad",
                                   "picture")]
    return rows


def optimum_rows(results):
    references = results.published["references"]
    rows = []
    for name, quantity, unit in (("speed", "optimal speed, |rate| ≤ 1", "L/T0"),
                                 ("efficiency", "optimal efficiency", "%")):
        rows.append(optimum_row(results, name, quantity, unit, results.optimum(name)[name],
                                references[name]))
    for c in (1, 2, 3, 4):
        speed, power = references[f"c{c}"]
        stroke = results.optimum(f"c{c}")
        rows.append(optimum_row(results, f"c{c}", f"best b v − c Φ, b = 6, c = {c}", "",
                                B * stroke["speed"] - c * stroke["power"], B * speed - c * power))
    return rows


def optimum_row(results, name, quantity, unit, value, reference):
    entry = row(quantity, [value], [f"data/optimum/{name}.json"], unit, optimum=reference,
                bar="within 1e-4 of the reference, or above", met=value >= reference * (1 - 1e-4))
    entry["seconds"] = results.optimum(name)["seconds"]
    return entry


# --- Policies -------------------------------------------------------------------------------------


def strategy_rows(results):
    published, rows = results.published, []
    at_least = {"vfs": {"speed": 0.01288},
                "eas": {"speed": published["eas_speed"], "efficiency": published["eas_efficiency"]}}
    for name, label in (("vfs", "VFS"), ("eas", "EAS")):
        sources = results.seeds("data/evaluate", name, "json")
        measures = results.evaluations(name)
        best = results.optimum("speed" if name == "vfs" else "c3")
        for measure, unit in (("speed", "L/T0"), ("efficiency", "%")):
            values = [one[measure] for one in measures]
            bound = at_least[name].get(measure)
            judged = min(values) if name == "vfs" else np.mean(values)
            text = "" if bound is None else (
                f"≥ {bound:.5f}, every seed" if name == "vfs" else
                f"mean ≥ {bound:.5f}" if measure == "speed" else f"mean ≥ {100 * bound:.3f} %")
            rows.append(row(f"{label}: {measure}", values, sources, unit,
                            published[f"{name}_{measure}"], best[measure], text,
                            None if bound is None else judged >= bound))
        if name == "eas":
            rows.append(row("EAS: v − c Φ / b, c = 3", [objective(one, name) for one in measures],
                            sources, "L/T0", None, best["speed"] - 3 * best["power"] / B))
    return rows


def success_rows(results):
    published, rows = results.published, []
    for name, c in PENALTIES.items():
        values = [one["success_rate"] for one in results.evaluations(name)]
        paper = (f"{100 * published['success_at_200']:.0f} %" if c == 0 else
                 f"about {100 * published['success_up_to_c3']:.0f} %" if c < 4 else "drops")
        rows.append(row(f"success, c = {c}" + (", N_s = 200" if c == 0 else ""), values,
                        results.seeds("data/evaluate", name, "json"), "%", paper,
                        bar="mean ≥ 99 %", met=np.mean(values) >= 0.99))
    return rows


# --- Tasks ----------------------------------------------------------------------------------------


def task_rows(results):
    speeds = [one["speed"] for one in results.evaluations(NAVIGATOR)]
    best = results.optimum("speed")["speed"]
    rows = [row("homing: speed towards a far target", speeds,
                results.seeds("data/evaluate", NAVIGATOR, "json"), "L/T0", None, best,
                "≥ 99.7 % of the optimum, every seed", min(speeds) >= 0.997 * best)]
    for name in EPISODES:
        trials, sources = results.trials(name), results.seeds("data/trials", name, "json")
        completed = [one["completed"] / one["trials"] for one in trials]
        number = trials[0]["trials"]
        if name == "star":
            rows.append(row(f"random stars completed, of {number}", completed, sources, "%",
                            "one, picture", bar="all, every seed", met=min(completed) == 1))
            ratios = [one["median_ratio"] for one in trials if one["median_ratio"]]
            if ratios:
                rows.append(row("star: steps / those of the optimal speed", ratios, sources, "",
                                bar="≤ 1.10, every seed", met=max(ratios) <= 1.10))
            continue
        ratio = {"pursuit_0": "0", "pursuit_05": "0.5", "pursuit_1": "1"}[name]
        label = f"diffusing target, v_T / v_m = {ratio}: "
        if name != "pursuit_1":
            rows.append(row(label + f"captured, of {number}", completed, sources, "%",
                            "one, picture", bar="all, every seed", met=min(completed) == 1))
            continue
        distances = [one["final_distance_median"] for one in trials]
        rows.append(row(label + "median distance in the end", distances, sources, "L",
                        "follows, picture", bar="≤ 1, every seed", met=max(distances) <= 1))
    proven = [results.json(f"data/proof/{name}.json")["ok"] for name in EPISODES]
    rows.append(row("recorded episodes that follow from seed and policy, to the bit",
                    [float(all(proven))], [f"data/proof/{name}.json" for name in EPISODES], "%",
                    bar="all", met=all(proven)))
    return rows


def build(results):
    return {"mode": results.run["mode"], "groups": [
        {"title": "Physics", "rows": stroke_rows(results)},
        {"title": "Strategies", "rows": strategy_rows(results)},
        {"title": "Success", "rows": success_rows(results)},
        {"title": "Optimal strokes", "rows": optimum_rows(results)},
        {"title": "Tasks", "rows": task_rows(results)}]}


# --- As text --------------------------------------------------------------------------------------


def number(value, unit, digits=5):
    """A value of the table as it is shown."""
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    if unit == "%":
        return f"{100 * value:.3f} %"
    return f"{value:.{digits}g}" if abs(value) >= 1e-12 or value == 0 else "0"


def relative(difference):
    return f"{100 * difference:+.2f} %" if abs(difference) >= 1e-3 else f"{difference:+.1e}"


def cells(entry):
    """quantity, paper, ours, optimum, difference, verdict: texts."""
    unit = entry["unit"]
    ours = number(entry["ours"], unit)
    if entry["half_width"] is not None:
        ours += f" ± {number(entry['half_width'], unit, 2)}"
    differences = [f"{relative(entry[key])} {name}" for key, name in
                   (("to_paper", "paper"), ("to_optimum", "optimum")) if entry[key] is not None]
    if "error" in entry:
        differences.append(f"{entry['error']:.1e} reference")
    verdict = entry["verdict"] + (f" ({entry['bar']})" if entry["bar"] else "")
    return (entry["quantity"], number(entry["paper"], unit), ours, number(entry["optimum"], unit),
            ", ".join(differences), verdict)


HEADER = ("quantity", "paper", "ours", "optimum", "difference", "verdict")


def as_text(table):
    lines = [HEADER] + [cells(entry)[:-1] + (entry["verdict"],)
                        for group in table["groups"] for entry in group["rows"]]
    widths = [max(len(line[column]) for line in lines) for column in range(len(HEADER))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip()
                     for line in lines)


def main(out):
    with open(out, "w", encoding="utf-8") as file:
        json.dump(build(Results()), file, indent=1)


if __name__ == "__main__":
    main(*sys.argv[1:])
