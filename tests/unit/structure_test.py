#!/usr/bin/python3
"""The structure that the packages promise: cores without ROS, a control loop without LibTorch."""
import os
import re
import subprocess
import unittest

import rosunit

ROOT = os.path.realpath(os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", ".."))
SOURCE = os.path.join(ROOT, "src")
ROS_INCLUDE = re.compile(
    r'#include\s*[<"](ros|rosbag|tf2_ros|topic_tools|diagnostic_updater|\w+_msgs)/')


def files(package, *folders):
    for folder in folders:
        for root, directories, names in os.walk(os.path.join(SOURCE, package, folder)):
            if "node" in directories:
                directories.remove("node")
            for name in names:
                if name.endswith((".hpp", ".cpp", ".inc")):
                    yield os.path.join(root, name)


def python_files():
    """(path, text) of all, those without an ending, too."""
    for part in ("scripts", "src", "tests"):
        for root, directories, names in os.walk(os.path.join(ROOT, part)):
            for name in names:
                path = os.path.join(root, name)
                if not name.endswith(".py"):
                    with open(path, "rb") as file:
                        if not re.match(rb"#!.*python", file.readline(100)):
                            continue
                with open(path, encoding="utf-8") as file:
                    yield path, file.read()


class StructureTest(unittest.TestCase):
    def test_cores_know_no_ros(self):
        # Debian keeps ROS headers in /usr/include: a core that includes one would compile.
        checked = 0
        for package in ("threelink_sim", "threelink_agent", "threelink_tasks"):
            for path in files(package, "src/core", "src/kernel", "src/training",
                              "src/distributed", "include"):
                checked += 1
                with open(path) as file:
                    self.assertIsNone(ROS_INCLUDE.search(file.read()), path)
        self.assertGreater(checked, 30)

    def test_control_loop_knows_no_libtorch(self):
        nodes = [("threelink_sim", "simulator_node"), ("threelink_agent", "agent_node"),
                 ("threelink_agent", "worker_node"),
                 ("threelink_tasks", "task_node"), ("threelink_tasks", "recorder_node")]
        for package, name in nodes:
            found = subprocess.run(["catkin_find", "--first-only", "--libexec", package, name],
                                   stdout=subprocess.PIPE, universal_newlines=True).stdout.strip()
            self.assertTrue(found, "%s/%s is not built" % (package, name))
            libraries = subprocess.run(["ldd", found], stdout=subprocess.PIPE,
                                       universal_newlines=True, check=True).stdout
            self.assertIn("libroscpp", libraries)
            self.assertNotIn("torch", libraries, name)

    def test_skipped_tests_are_counted(self):
        # rosunit takes them for passed; tests/node/skips.py does not.
        for path, text in python_files():
            skips = re.search(r"(self|unittest)\.skip(Test|If|Unless)?\(", text)
            if skips and re.search(r"\b(unitrun|rosrun)\(", text):
                self.assertIn("\nimport skips", text, path)


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "structure", StructureTest)
