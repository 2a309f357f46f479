#!/usr/bin/python3
"""The task that the README shows is the one that the tests play, line by line, and 40 at most."""
import os
import re
import unittest

import rosunit

ROOT = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..")


def read(*path):
    with open(os.path.join(ROOT, *path)) as file:
        return file.read()


class ReadmeTest(unittest.TestCase):
    def test_the_task_it_shows_is_the_one_that_is_played(self):
        section = read("README.md").partition("## Add a task in 40 lines")[2].partition("\n## ")[0]
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
