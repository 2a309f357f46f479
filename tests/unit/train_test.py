#!/usr/bin/python3
"""The tool train as a user runs it: the run's folder, equal seeds, signals, refusals."""
import csv
import os
import signal
import subprocess
import tempfile
import time
import unittest

import rosunit

CONFIG = os.path.join(
    os.path.dirname(os.path.realpath(__file__)), "..", "..", "config", "train_vfs.yaml")
TRAIN = ["rosrun", "threelink_agent", "train"]


def train(*arguments):
    return subprocess.run(TRAIN + list(arguments), stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, universal_newlines=True)


class TrainTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.out = os.path.join(folder.name, "run")
        self.other = os.path.join(folder.name, "other")

    def refused(self, text, *arguments):
        result = train(*arguments)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn(text, result.stderr)

    def test_a_run_leaves_its_folder(self):
        result = train("--config", CONFIG, "--out", self.out, "--episodes", "50", "--seed", "0")
        self.assertEqual(result.returncode, 0, result.stderr)
        policy = os.path.join(self.out, "policy.safetensors")
        words = result.stdout.splitlines()[-1].split()
        self.assertEqual(words[:2], [policy, "sha256"])
        self.assertEqual(len(words[2]), 64)
        self.assertIn("BLAS: /", result.stdout)
        self.assertNotIn("\r", result.stdout)
        with open(os.path.join(self.out, "metrics.csv")) as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["episodes"] for row in rows], ["40", "50"])
        self.assertTrue(rows[-1]["speed"])

        # The effective configuration gives the same policy again.
        config = os.path.join(self.out, "config.yaml")
        again = train("--config", config, "--out", self.other, "--threads", "2")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual(again.stdout.splitlines()[-1].split()[-1], words[2])
        evaluated = subprocess.run(
            ["rosrun", "threelink_agent", "evaluate", "--policy", policy, "--trials", "0"],
            stdout=subprocess.PIPE, universal_newlines=True)
        self.assertEqual(evaluated.returncode, 0)
        self.assertIn(words[2], evaluated.stdout)

    def test_a_signal_ends_the_run_and_saves(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            out = "%s%d" % (self.out, number)
            process = subprocess.Popen(
                [subprocess.check_output(["catkin_find", "--first-only", "--libexec",
                                          "threelink_agent", "train"],
                                         universal_newlines=True).strip(),
                 "--config", CONFIG, "--out", out, "--episodes", "1000000"],
                stdout=subprocess.PIPE, universal_newlines=True)
            process.stdout.readline()
            metrics = os.path.join(out, "metrics.csv")
            deadline = time.monotonic() + 60
            while not os.path.exists(metrics) or os.path.getsize(metrics) < 300:
                self.assertIsNone(process.poll())
                self.assertLess(time.monotonic(), deadline)
                time.sleep(0.02)
            process.send_signal(number)
            output, _ = process.communicate(timeout=30)
            self.assertEqual(process.returncode, 128 + number)
            self.assertIn("stopped by signal %d" % number, output)
            self.assertTrue(os.path.exists(os.path.join(out, "last.safetensors")))

    def test_refusals(self):
        self.refused("--config is required", "--out", self.out)
        self.refused("--out is required", "--config", CONFIG)
        self.refused("--speed", "--config", CONFIG, "--out", self.out, "--speed", "3")
        self.refused("/nowhere.yaml: cannot be read", "--config", "/nowhere.yaml", "--out", self.out)
        for arguments in (["--seed", "-1"], ["--seed", "one"], ["--seed", "9223372036854775808"],
                          ["--episodes", "0"], ["--episodes", "1.5"], ["--threads", "0"]):
            self.refused(arguments[0], "--config", CONFIG, "--out", self.out, *arguments)
        self.assertFalse(os.path.exists(self.out))
        os.mkdir(self.out)
        with open(os.path.join(self.out, "metrics.csv"), "w"):
            pass
        self.refused("is not empty", "--config", CONFIG, "--out", self.out)
        self.refused("/proc/run", "--config", CONFIG, "--out", "/proc/run")

    def test_help(self):
        result = train("--help")
        self.assertEqual(result.returncode, 0)
        for option in ("--config", "--out", "--seed", "--episodes", "--threads", "Exit status"):
            self.assertIn(option, result.stdout)


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "train", TrainTest)
