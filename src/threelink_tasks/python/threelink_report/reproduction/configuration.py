"""A training's configuration with other values: configuration BASE.yaml OUT.yaml [SECTION.KEY=VALUE ...]

All comments stay, so that the file still reads as the manual.
"""
import re
import sys


def change(text, key, value):
    """The YAML text with the value of SECTION.KEY replaced; ValueError if there is none."""
    section, _, name = key.rpartition(".")
    head, body = "", text
    if section:
        start = re.search(rf"^{re.escape(section)}:.*\n", text, re.MULTILINE)
        if not start:
            raise ValueError(f"no section {section}")
        head, body = text[:start.end()], text[start.end():]
    indent = "  " if section else ""
    line = re.compile(rf"^({indent}{re.escape(name)}: *)([^\s#]+)", re.MULTILINE)
    end = re.search(r"^\S", body, re.MULTILINE).start() if section and re.search(
        r"^\S", body, re.MULTILINE) else len(body)
    changed, count = line.subn(lambda match: match.group(1) + value, body[:end])
    if count != 1:
        raise ValueError(f"no key {key}")
    return head + changed + body[end:]


def main(base, out, *changes):
    with open(base, encoding="utf-8") as file:
        text = file.read()
    for key, _, value in (word.partition("=") for word in changes):
        text = change(text, key, value)
    with open(out, "w", encoding="utf-8") as file:
        file.write(text)


if __name__ == "__main__":
    main(*sys.argv[1:])
