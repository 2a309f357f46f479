#!/usr/bin/python3
"""What the pages refer to is there: the tests that docs/reliability.md names, files, links."""
import glob
import os
import re
import unittest

import rosunit

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

    def test_links_lead_somewhere(self):
        pages = [os.path.join(ROOT, "README.md")] + glob.glob(os.path.join(ROOT, "docs", "*.md")) + glob.glob(
            os.path.join(ROOT, "src", "threelink_*", "README.md"))
        for page in pages:
            folder = os.path.dirname(page)
            for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", read(page)):
                if not target.startswith(("http:", "https:")):
                    self.assertTrue(os.path.exists(os.path.join(folder, target)),
                                    "%s: %s" % (page, target))
            for target in re.findall(r"`(?:rostest )?(tests/[\w/]+\.\w+)", read(page)):
                self.assertTrue(os.path.exists(os.path.join(ROOT, target)),
                                "%s: %s" % (page, target))


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "docs", DocsTest)
