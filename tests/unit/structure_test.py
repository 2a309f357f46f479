#!/usr/bin/python3
"""The structure that the packages promise: cores without ROS, a control loop without LibTorch; and
that what they are written in is known to the oldest platform, Ubuntu 20.04.
"""
import ast
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
            for path in files(package, "src/core", "src/goal", "src/kernel", "src/task", "src/training",
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

    def test_python_is_that_of_ubuntu_20_04(self):
        checked = 0
        for path, text in python_files():
            checked += 1
            with self.subTest(path):
                ast.parse(text, feature_version=(3, 8))
                if text.startswith("#!"):  # another python3 may come first on PATH
                    self.assertEqual(text.partition("\n")[0], "#!/usr/bin/python3")
        self.assertGreater(checked, 70)

    def test_text_files_are_utf_8_whatever_the_locale(self):
        for path, text in python_files():
            if path.startswith(os.path.join(ROOT, "tests")):
                continue
            for call in ast.walk(ast.parse(text)):
                if not isinstance(call, ast.Call):
                    continue
                name = getattr(call.func, "id", getattr(call.func, "attr", ""))
                options = {keyword.arg: keyword.value for keyword in call.keywords}
                if name == "open" and isinstance(call.func, ast.Name):
                    mode = options.get("mode", call.args[1] if len(call.args) > 1 else None)
                    opens_text = "b" not in getattr(mode, "value", "r")
                    at_home = ast.get_source_segment(text, call.args[0]) == "os.devnull"
                    said = "encoding" in options or at_home or not opens_text
                elif name in ("read_text", "write_text"):
                    said = "encoding" in options
                else:
                    said = not {"universal_newlines", "text"} & set(options)
                self.assertTrue(said, "%s:%d names no encoding" % (path, call.lineno))

    def test_skipped_tests_are_counted(self):
        # rosunit takes them for passed; tests/node/skips.py does not.
        for path, text in python_files():
            skips = re.search(r"(self|unittest)\.skip(Test|If|Unless)?\(", text)
            if skips and re.search(r"\b(unitrun|rosrun)\(", text):
                self.assertIn("\nimport skips", text, path)

    def test_libraries_are_those_of_ubuntu_20_04(self):
        # The build takes Eigen's iterators away (src/eigen_3_3.hpp); these came with 3.4 as well,
        # ordered_json with nlohmann 3.9, numbers read by from_chars with GCC 11.
        new = re.compile(r"\.reshaped\(|Eigen::(seqN?|all|last|lastp1|indexing)\b|"
                         r"Eigen::(Vector|RowVector|Matrix|Array)[X234]+<|"
                         r"\bordered_json\b|\bfrom_chars\b")
        for package in ("threelink_sim", "threelink_agent", "threelink_tasks"):
            for path in files(package, "src", "include"):
                with open(path) as file:
                    self.assertIsNone(new.search(file.read()), path)


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "structure", StructureTest)
