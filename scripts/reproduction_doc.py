#!/usr/bin/python3
"""Puts a run's table and figures into docs/reproduction.md: reproduction_doc.py DIR

DIR is the folder of a finished `./threelink reproduce`. What stands between the marks
<!-- NAME --> and <!-- end --> is replaced, the pictures are copied to docs/pictures/reproduction.
"""
import os
import re
import shutil
import sys

from threelink_report.files import replacing
from threelink_report.reproduction import table
from threelink_report.reproduction.figures import FIGURES
from threelink_report.reproduction.results import Results

ROOT = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))
PAGE = os.path.join(ROOT, "docs", "reproduction.md")
PICTURES = os.path.join(ROOT, "docs", "pictures", "reproduction")


def run(results):
    """What run this is, and how long it took."""
    seconds = sum(results.json(f".finished/{stage['name']}.json")["seconds"]
                  for stage in results.run["stages"])
    option = "" if results.is_full else " --quick"
    return (f"This is `./threelink reproduce{option}` at revision {results.run['revision']}: "
            f"{len(results.run['stages'])} stages, {seconds / 60:.0f} minutes of them in all, two at a "
            "time by default on two cores.")


def markdown_table(made):
    lines = [list(table.HEADER), ["---"] * len(table.HEADER)]
    for group in made["groups"]:
        lines.append([f"**{group['title']}**"] + [""] * (len(table.HEADER) - 1))
        lines += [list(table.cells(entry)) for entry in group["rows"]]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |"
                     for line in lines)


def figures(results):
    parts = []
    for name in FIGURES:
        words = results.json(f"figures/{name}.json")
        shutil.copyfile(results.path(f"figures/{name}.png"), os.path.join(PICTURES, f"{name}.png"))
        parts.append(f"### {words['title']}\n\n![{words['title']}](pictures/reproduction/{name}.png)"
                     f"\n\n{words['caption']}")
    return "\n\n".join(parts)


def replace(text, name, content):
    mark = re.compile(rf"(<!-- {name} -->\n).*?(<!-- end -->)", re.DOTALL)
    changed, count = mark.subn(lambda match: match.group(1) + content + "\n" + match.group(2), text)
    if count != 1:
        raise ValueError(f"{PAGE}: not one mark <!-- {name} -->")
    return changed


def main(folder):
    results = Results(folder)
    os.makedirs(PICTURES, exist_ok=True)
    with open(PAGE, encoding="utf-8") as file:
        text = file.read()
    for name, content in (("run", run(results)),
                          ("table", markdown_table(results.json("table.json"))),
                          ("figures", figures(results))):
        text = replace(text, name, content)
    with replacing(PAGE) as part, open(part, "w", encoding="utf-8") as file:
        file.write(text)


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    try:
        main(sys.argv[1])
    except (OSError, ValueError, KeyError) as error:
        print(f"reproduction_doc: {error}", file=sys.stderr)
        sys.exit(2)
