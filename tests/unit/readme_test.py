#!/usr/bin/python3
"""README.md keeps its order, and the task that docs/tasks.md shows is the one that the tests play, in 40 lines."""
import os
import re
import unittest

import rosunit

ROOT = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..")


def read(*path):
    with open(os.path.join(ROOT, *path), encoding="utf-8") as file:
        return file.read()


class ReadmeTest(unittest.TestCase):
    def test_it_begins_with_the_picture_and_the_two_commands(self):
        readme = read("README.md")
        first_screen = "\n".join(readme.splitlines()[:12])
        self.assertIn("](docs/pictures/pursuit_rviz.png)", first_screen)
        for command in ("pursuit", "test"):
            self.assertRegex(first_screen, r"(?m)^\./threelink %s\b" % command)
        self.assertEqual(re.findall(r"^## (.*)$", readme, re.MULTILINE),
                         ["Who it is for", "What it can do", "Where to go next"])
        self.assertLessEqual(readme.count("\n"), 70)

    def test_it_leads_to_every_page(self):
        pages = sorted(name for name in os.listdir(os.path.join(ROOT, "docs")) if name.endswith(".md"))
        listed = re.findall(r"^\| \[docs/(\w+\.md)\]\(docs/\1\) \|", read("README.md"), re.MULTILINE)
        self.assertEqual(sorted(listed), pages)

    def test_every_figure_stands_beside_its_command(self):
        section = read("README.md").partition("## What it can do")[2].partition("\n## ")[0]
        rows = re.findall(r"^\| (.*) \| (.*) \| (.*) \|$", section, re.MULTILINE)[1:]
        self.assertGreaterEqual(len(rows), 5)
        for what, measured, by in rows:
            self.assertRegex(measured, r"\d", what)
            self.assertRegex(by, r"`(\./threelink|rosrun) |\]\(docs/", what)

    def test_the_task_that_tasks_md_shows_is_the_one_that_is_played(self):
        section = read("docs", "tasks.md").partition("## Add a task in 40 lines")[2].partition("\n## ")[0]
        blocks = re.findall(r"```(cpp|xml|yaml|cmake)\n(.*?)```", section, re.DOTALL)
        self.assertEqual([kind for kind, _ in blocks], ["cpp", "xml", "yaml", "cmake", "xml"])
        cpp, classes, parameters, cmake, export = (text for _, text in blocks)
        self.assertEqual(cpp, read("tests", "plugin", "pendulum_task.cpp"))
        self.assertEqual(classes, read("tests", "plugin", "tasks.xml"))
        self.assertEqual(parameters, read("tests", "plugin", "pendulum.yaml"))
        self.assertIn(cmake, read("tests", "CMakeLists.txt"))
        self.assertIn(export.strip(), read("tests", "package.xml"))
        self.assertLessEqual(sum(text.count("\n") for _, text in blocks), 40)


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "readme", ReadmeTest)
