#!/usr/bin/python3
"""What the pages refer to is there: the tests that docs/reliability.md names, files, links."""
import glob
import os
import re
import unittest

import rosunit
import yaml

ROOT = os.path.realpath(os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", ".."))


def read(*path):
    with open(os.path.join(ROOT, *path), encoding="utf-8") as file:
        return file.read()


def cases(name):
    """The names of the test cases of a file of tests/node or tests/unit."""
    found = glob.glob(os.path.join(ROOT, "tests", "*", name))
    if len(found) != 1:
        return set()
    text = read(found[0])
    if name.endswith(".py"):
        return set(re.findall(r"^    def (test_\w+)\(", text, re.MULTILINE))
    return {".".join(match) for match in re.findall(r"^TEST(?:_F|_P)?\((\w+), (\w+)\)", text,
                                                    re.MULTILINE)}


def anchors(page):
    """The anchors that GitHub gives to the headings of a page."""
    headings = re.findall(r"^#+ (.*)$", read(page), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def keys(section, prefix=""):
    """The names of a configuration's values, such as "update.clip"."""
    for name, value in section.items():
        yield from keys(value, f"{prefix}{name}.") if isinstance(value, dict) else [prefix + name]


class DocsTest(unittest.TestCase):
    def test_every_fault_has_its_tests(self):
        section = read("docs", "reliability.md").partition("## Faults, one by one")[2]
        rows = re.findall(r"^\| (F\d+) \|(.*)$", section, re.MULTILINE)
        self.assertEqual([name for name, _ in rows], ["F%d" % i for i in range(1, 23)])
        for name, row in rows:
            tests = re.findall(r"`(\w+\.(?:py|cpp)): ([\w.]+)`", row)
            self.assertTrue(tests, name)
            for file, case in tests:
                self.assertIn(case, cases(file), "%s: %s" % (name, file))
            figure = row.split("|")[3].strip()
            self.assertTrue(figure, "%s has no figure, nor says that none was measured" % name)

    def test_the_manual_explains_every_key_of_a_training(self):
        section = read("docs", "learning.md").partition("## The configuration")[2].partition("\n## ")[0]
        rows = re.findall(r"^\| (`[\w.]+`(?:, `[\w.]+`)*) \|(?:[^|\\]|\\.)*\|[^|]*\| (.+) \|$", section, re.MULTILINE)
        explained = {name for names, _ in rows for name in re.findall(r"`([\w.]+)`", names)}
        shipped = set()
        for path in glob.glob(os.path.join(ROOT, "config", "train_*.yaml")):
            shipped.update(keys(yaml.safe_load(read(path))))
        self.assertGreater(len(shipped), 30)
        self.assertEqual(explained - {"environment.world"}, shipped)
        values = dict(re.findall(r"^\| `([\w.]+)` \|(?:[^|\\]|\\.)*\| ([\d.]+) \|", section, re.MULTILINE))
        vfs = yaml.safe_load(read("config", "train_vfs.yaml"))
        self.assertGreater(len(values), 20)
        for name, value in values.items():
            found = vfs
            for part in name.split("."):
                found = found[part]
            self.assertEqual(float(value), found, name)

    def test_links_lead_somewhere(self):
        pages = [os.path.join(ROOT, "README.md")] + glob.glob(os.path.join(ROOT, "docs", "*.md")) + glob.glob(
            os.path.join(ROOT, "src", "threelink_*", "README.md"))
        for page in pages:
            folder = os.path.dirname(page)
            for target, anchor in re.findall(r"\]\(([^)#\s]*)(?:#([^)]*))?\)", read(page)):
                if target.startswith(("http:", "https:")):
                    continue
                path = os.path.join(folder, target) if target else page
                self.assertTrue(os.path.exists(path), "%s: %s" % (page, target))
                if anchor:
                    self.assertIn(anchor, anchors(path), "%s: %s" % (page, target))
            for target in re.findall(r"`(?:rostest )?(tests/[\w/]+\.\w+)", read(page)):
                self.assertTrue(os.path.exists(os.path.join(ROOT, target)),
                                "%s: %s" % (page, target))


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "docs", DocsTest)
