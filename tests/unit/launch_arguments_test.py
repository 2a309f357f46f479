#!/usr/bin/python3
"""Arguments of the launch files: paths of any name from any folder, and wrong values refused in words,
by roslaunch and by launch.py."""
import os
import signal
import subprocess
import sys
import tempfile
import unittest

import roslaunch
import roslaunch.config
import rospkg
import rosunit

SHARE = rospkg.RosPack().get_path("threelink_tasks")
FOLDER = os.path.join(SHARE, "launch")
HOMING = os.path.join(SHARE, "config/policies/homing.safetensors")
LAUNCH = os.path.join(os.path.dirname(os.path.realpath(__file__)), "../../scripts/launch.py")
NAMES = ["a b", "o'neill", 'say "a"', "$HOME", "$(x", "back\\slash", "`id`", "1", "007", "0.50", "true",
         "-x", "a;b|c&d", "\u00e9\u00fc", "a:b"]
# launch file, arguments, what the message says
WRONG = [
    ("pursuit", {"realtime_factor": "0,5"}, "realtime_factor:=0,5: must be a number"),
    ("pursuit", {"realtime_factor": "nan"}, "realtime_factor:=nan: must be a number"),
    ("pursuit", {"v_ratio": "fast"}, "v_ratio:=fast: must be a number"),
    ("pursuit", {"seed": "2147483648"}, "seed:=2147483648: must be a whole number, 0 .. 2147483647"),
    ("pursuit", {"seed": "-1"}, "seed:=-1: must be a whole number"),
    ("star", {"episodes": "x"}, "episodes:=x: must be a whole number"),
    ("star", {"episodes": "1.5"}, "episodes:=1.5: must be a whole number"),
    ("click", {"record": "maybe"}, "record:=maybe: must be true or false"),
    ("click", {"rviz": "1"}, "rviz:=1: must be true or false"),
    ("pursuit", {"sampled": "often"}, "sampled:=often: must be true, false or policy"),
    ("pursuit", {"lan": "no"}, "lan:=no: must be true or false"),
    ("pursuit", {"allow_other_swimmer": "0.9"}, "allow_other_swimmer:=0.9: must be true or false"),
    ("train", {"out": "a", "seed": "x"}, "seed:=x: must be a whole number"),
    ("train", {"out": "a", "workers": "many"}, "workers:=many: must be a whole number, 0 .. 100"),
    ("train", {"out": "a", "workers": "101"}, "workers:=101: must be a whole number, 0 .. 100"),
    ("train", {"out": "a", "replay": "some"}, "replay:=some: must be a whole number"),
    ("train", {"out": "a", "resume": "again"}, "resume:=again: must be true or false"),
    ("train", {"out": "a", "rviz": "true"}, "rviz:=true needs watch:=true"),
    ("workers", {"threads": "99999999999"}, "threads:=99999999999: must be a whole number"),
    ("playback", {"bag": "a", "rate": "x10"}, "rate:=x10: must be a number"),
    ("playback", {"bag": "a", "start": "1 s"}, "start:=1 s: must be a number"),
    ("view", {"links": "three"}, "links:=three: must be a whole number"),
    ("view", {"stroke": "false", "file": "a.json"}, "stroke:=false: there is no stroke"),
    ("stroke", {"dt": "e-1e"}, "dt:=e-1e: must be a number"),
    ("watch", {"realtime_factor": "true"}, "realtime_factor:=true: must be a number"),
    ("live", {"robot": "yes"}, "robot:=yes: must be true or false"),
    ("cluster_workers", {"hosts": "a", "ssh_port": "70000"}, "ssh_port:=70000: must be a whole number"),
]
# What roslaunch itself takes without a word.
DROPPED = [
    ("pursuit", ["seed:="], "argument `seed` has no value"),
    ("pursuit", ["seed:=1", "seed:=2"], "argument `seed` is given twice"),
    ("pursuit", ["sed:=1"], "unknown argument `sed`"),
    ("pursuit", ["seed"], "argument `seed` is not of the form NAME:=VALUE"),
    ("pursuit", ["bag_dir:=a:=b"], "argument `bag_dir:=a:=b`"),
    ("pursuit", ["policy:=$(find x)"], "argument `policy:=$(find x)`"),
    ("pursuit", ["policy:=123"], "describe_policy"),
    ("waypoints", [], "argument `file` is required: CSV with a line x,y"),
]


def launch_program():
    """scripts/launch.py as a module."""
    handlers = [(number, signal.getsignal(number))
                for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)]
    sys.path.insert(0, os.path.dirname(LAUNCH))
    import launch
    for number, handler in handlers:
        signal.signal(number, handler)
    return launch


def load(name, **arguments):
    return roslaunch.config.load_config_default(
        [(os.path.join(FOLDER, name + ".launch"), ["%s:=%s" % item for item in arguments.items()])],
        None, assign_machines=False).params


class LaunchArgumentsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = os.path.realpath(folder.name)

    def test_paths_of_any_name_reach_the_nodes(self):
        for name in NAMES:
            path = os.path.join(self.folder, name)
            with self.subTest(name):
                self.assertEqual(load("playback", bag=path)["/threelink/playback/bag"].value, path)
        path = os.path.join(self.folder, "o'neill \"a b\"")
        self.assertEqual(load("playback", bag=path)["/threelink/play/bag"].value, path)
        self.assertEqual(load("waypoints", file=path)["/threelink/task/points"].value, path)
        self.assertEqual(load("stroke", file=path)["/threelink/stroke/file"].value, path)
        params = load("train", out=path, config=path, workers=0)
        self.assertEqual(params["/threelink/learner/out"].value, path)
        self.assertEqual(params["/threelink/learner/config"].value, path)

    def test_policies_and_folders_of_any_name(self):
        for name in ("o'neill \"a b\"", "1"):
            path = os.path.join(self.folder, name)
            with open(HOMING, "rb") as shipped, open(path, "wb") as file:
                file.write(shipped.read())
            params = load("pursuit", policy=path, bag_dir=path)
            self.assertEqual(params["/threelink/agent/policy"].value, path)
            self.assertEqual(params["/threelink/task/policy"].value, path)
            self.assertEqual(params["/threelink/recorder/bag_dir"].value, path)
            self.assertEqual(params["/threelink/simulator/observation"].value, "target")

    def roslaunch(self, *arguments):
        """Called in self.folder, by a process whose PWD is another folder."""
        return subprocess.run(
            ["roslaunch", *arguments], cwd=self.folder, env=dict(os.environ, PWD="/usr"),
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, timeout=60)

    def test_relative_paths_begin_where_roslaunch_was_called(self):
        with open(HOMING, "rb") as shipped, open(os.path.join(self.folder, "7"), "wb") as file:
            file.write(shipped.read())
        os.mkdir(os.path.join(self.folder, "sub"))
        with open(os.path.join(self.folder, "sub/task.yaml"), "w") as file:
            file.write("task: path\n")
        done = self.roslaunch("--dump-params", "threelink_tasks", "task.launch", "task:=sub/task.yaml",
                              "policy:=7", "bag_dir:=sub/../bags")
        self.assertEqual(done.returncode, 0, done.stderr)
        for line in ("/threelink/agent/policy: %s/7" % self.folder,
                     "/threelink/task/policy: %s/7" % self.folder,
                     "/threelink/task/task: path", "/threelink/recorder/bag_dir: %s/bags" % self.folder):
            self.assertIn(line, done.stdout)

    def test_wrong_values_are_refused_in_words(self):
        for name, arguments, message in WRONG:
            with self.subTest(name, **arguments):
                with self.assertRaises(roslaunch.RLException) as caught:
                    load(name, **arguments)
                self.assertIn(message, str(caught.exception))

    def test_roslaunch_says_it_without_a_traceback(self):
        done = self.roslaunch("threelink_tasks", "pursuit.launch", "realtime_factor:=0,5")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("realtime_factor:=0,5: must be a number", done.stderr)
        self.assertNotIn("Traceback (most", done.stderr)

    def launch(self, *arguments):
        return subprocess.run(["/usr/bin/python3", LAUNCH, "threelink_tasks", *arguments],
                              cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              universal_newlines=True, timeout=60)

    def test_launch_py_refuses_in_a_sentence(self):
        for arguments, message in (
                (["pursuit.launch", "realtime_factor:=0,5"], "realtime_factor:=0,5: must be a number"),
                (["task.launch", "task:=stra"], "stra.yaml"),
                (["pursuit.launch", "sed:=1"], "unknown argument `sed`")):
            done = self.launch(*arguments)
            self.assertEqual(done.returncode, 2)
            self.assertRegex(done.stderr, r"\Athreelink_tasks %s: [^<>]*%s[^<>]*\Z"
                             % (arguments[0], message))

    def test_launch_py_refuses_what_roslaunch_drops(self):
        program = launch_program()
        for file, arguments, message in DROPPED:
            with self.subTest(arguments):
                with self.assertRaises(program.WrongArgument) as caught:
                    program.load(["threelink_tasks", file + ".launch", *arguments])
                self.assertIn(message, str(caught.exception))


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "launch_arguments", LaunchArgumentsTest)
