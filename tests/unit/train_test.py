#!/usr/bin/python3
"""The tool train as a user runs it: the run's folder, equal seeds, signals, refusals."""
import csv
import os
import pty
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import rosunit

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "node"))
import skips  # noqa: F401, rosunit's results

CONFIG = os.path.join(
    os.path.dirname(os.path.realpath(__file__)), "..", "..", "config", "train_vfs.yaml")
TRAIN = ["rosrun", "threelink_agent", "train"]
PROGRAM = subprocess.check_output(
    ["catkin_find", "--first-only", "--libexec", "threelink_agent", "train"],
    universal_newlines=True).strip()


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
        self.assertIn("backend fused, own kernels: ", result.stdout)
        self.assertIn("speed ", result.stdout.splitlines()[-2])
        self.assertIn(", 50 episodes in ", result.stdout.splitlines()[-2])
        self.assertNotIn("\r", result.stdout)
        self.assertEqual(result.stderr, "")
        with open(os.path.join(self.out, "learning_curve.png"), "rb") as file:
            self.assertEqual(file.read(4), b"\x89PNG")
        with open(os.path.join(self.out, "metrics.csv")) as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["episodes"] for row in rows], ["20", "40", "50"])
        self.assertTrue(rows[-1]["speed"])
        self.assertTrue(rows[-1]["success"])
        self.assertEqual(rows[-1]["poisoned"], "0")

        # The effective configuration gives the same policy again.
        config = os.path.join(self.out, "config.yaml")
        again = train("--config", config, "--out", self.other, "--threads", "2", "--no-plot",
                      "--checkpoint-every", "7")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual(again.stdout.splitlines()[-1].split()[-1], words[2])
        evaluated = subprocess.run(
            ["rosrun", "threelink_agent", "evaluate", "--policy", policy, "--trials", "0"],
            stdout=subprocess.PIPE, universal_newlines=True)
        self.assertEqual(evaluated.returncode, 0)
        self.assertIn(words[2], evaluated.stdout)

    def test_threads_and_instruction_sets_give_the_same_policy(self):
        with open("/proc/cpuinfo") as file:
            flags = file.read().split()
        isas = [isa for isa, flag in (("avx2", "avx2"), ("avx512", "avx512dq")) if flag in flags]
        runs = [("1", isa) for isa in isas or ["baseline"]] + [("2", ""), ("3", "")]
        policies = set()
        for number, (threads, isa) in enumerate(runs):
            environment = dict(os.environ, **({"THREELINK_ISA": isa} if isa else {}))
            result = subprocess.run(
                TRAIN + ["--config", CONFIG, "--out", self.out + str(number), "--episodes", "60",
                         "--seed", "0", "--threads", threads, "--no-plot"],
                env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                universal_newlines=True)
            self.assertEqual(result.returncode, 0, result.stderr)
            if isa:
                self.assertIn("own kernels: " + isa, result.stdout)
            policies.add(result.stdout.splitlines()[-1].split()[-1])
        self.assertEqual(len(policies), 1)

    def test_the_other_backend(self):
        result = train("--config", CONFIG, "--out", self.out, "--episodes", "40", "--no-plot",
                       "--backend", "libtorch")
        if "LibTorch was missing" in result.stderr:
            self.skipTest("no LibTorch")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("BLAS: /", result.stdout)

    def test_a_failing_plot_is_a_warning(self):
        environment = dict(os.environ, MPLCONFIGDIR=self.other, PYTHONHOME="/nowhere")
        result = subprocess.run(
            [PROGRAM, "--config", CONFIG, "--out", self.out, "--episodes", "40"],
            env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            universal_newlines=True)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("warning: no learning curve", result.stderr)

    def test_plot_training(self):
        self.assertEqual(train("--config", CONFIG, "--out", self.out, "--episodes", "80",
                               "--no-plot").returncode, 0)
        picture = self.other + ".svg"
        plot = ["rosrun", "threelink_agent", "plot_training"]
        self.assertEqual(subprocess.call(plot + [self.out, "--out", picture]), 0)
        self.assertGreater(os.path.getsize(picture), 1000)
        self.assertEqual(subprocess.call(plot + ["/nowhere"], stderr=subprocess.DEVNULL), 2)

    def test_on_a_terminal_a_bar_is_redrawn(self):
        leader, follower = pty.openpty()
        process = subprocess.Popen(
            [PROGRAM, "--config", CONFIG, "--out", self.out, "--episodes", "60", "--no-plot"],
            stdout=follower, stderr=subprocess.PIPE)
        os.close(follower)
        output = b""
        while True:
            try:
                output += os.read(leader, 4096)
            except OSError:  # the other end was closed
                break
        os.close(leader)
        _, errors = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 0, errors)
        bars = [piece for piece in output.decode().split("\r") if "episodes  " in piece]
        self.assertEqual(len(bars), 3)
        for piece in bars:
            for part in ("k steps/s", "return ", "speed ", " left"):
                self.assertIn(part, piece + " left")  # 80 columns may cut the end

    def test_wrong_configurations(self):
        with open(CONFIG) as file:
            text = file.read()
        path = self.other + ".yaml"
        for found, put, message in (
                ("clip: 0.2", "clp: 0.2", "update.clp: unknown key (the nearest known one is update.clip)"),
                ("clip: 0.2", "clip: 2.0", "update.clip = 2.0: must be in (0, 1)"),
                ("clip: 0.2", "clip: .nan", "update.clip = .nan: must be finite"),
                ("2.0e-3", "2e-3", "update.actor_learning_rate = 2e-3: must be a number"),
                ("epochs: 5 ", "epochs: 1.5 ", "update.epochs = 1.5: must be a whole number")):
            self.assertIn(found, text)
            with open(path, "w") as file:
                file.write(text.replace(found, put, 1))
            self.refused("train: %s: %s" % (path, message), "--config", path, "--out", self.out)
        self.assertFalse(os.path.exists(self.out))

    def test_a_signal_ends_the_run_and_saves(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            out = "%s%d" % (self.out, number)
            process = subprocess.Popen(
                [PROGRAM,
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
        self.refused("/nowhere.yaml: cannot open", "--config", "/nowhere.yaml", "--out", self.out)
        for arguments in (["--seed", "-1"], ["--seed", "one"], ["--seed", "9223372036854775808"],
                          ["--episodes", "0"], ["--episodes", "1.5"], ["--threads", "0"],
                          ["--backend", "cuda"], ["--checkpoint-every", "0"],
                          ["--on-save-error", "ignore"]):
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
        for option in ("--config", "--out", "--seed", "--episodes", "--threads", "--backend", "--resume",
                       "--checkpoint-every", "--on-save-error", "Exit status"):
            self.assertIn(option, result.stdout)


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "train", TrainTest)
