#!/usr/bin/python3
"""The trainer as a process: killed and resumed, full disks, two at a time, signals."""
import csv
import os
import re
import random
import resource
import signal
import subprocess
import tempfile
import time
import unittest

import rosunit

FOLDER = os.path.dirname(os.path.realpath(__file__))
SHIPPED = os.path.join(FOLDER, "..", "..", "config", "train_vfs.yaml")
TRAIN = subprocess.check_output(
    ["catkin_find", "--first-only", "--libexec", "threelink_agent", "train"],
    universal_newlines=True).strip()
TIMES = ("seconds", "steps_per_s")
KILLS = int(os.environ.get("THREELINK_KILLS", "5"))


def small_config(path, episodes):
    """A training of 100 updates in a second or two."""
    with open(SHIPPED) as file:
        text = file.read()
    for key, value in (("episodes", episodes), ("hidden", "[32, 32]"), ("  episodes", 10),
                       ("  steps", 100), ("evaluate_every", 10), ("  epochs", 10)):
        text, count = re.subn("(?m)^%s: [^#]*" % key, "%s: %s " % (key, value), text)
        assert count == 1, key
    with open(path, "w") as file:
        file.write(text)
    return path


def rows_of(run):
    """metrics.csv without the times."""
    with open(os.path.join(run, "metrics.csv")) as file:
        rows = list(csv.DictReader(file))
    return [{key: value for key, value in row.items() if key not in TIMES} for row in rows]


def content_of(run, name):
    with open(os.path.join(run, name), "rb") as file:
        return file.read()


def checkpoints(run):
    return sorted(name for name in os.listdir(run) if name.startswith("checkpoint_"))


class ResumeTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.run = os.path.join(folder.name, "run")
        self.config = small_config(os.path.join(folder.name, "train.yaml"), 1000)

    def arguments(self, *more, out=None):
        return [TRAIN, "--config", self.config, "--out", out or self.run, "--no-plot"] + list(more)

    def start(self, *more, **popen):
        process = subprocess.Popen(self.arguments(*more), stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, universal_newlines=True, **popen)
        self.addCleanup(lambda: process.poll() is None and process.kill())
        return process

    def complete(self, *more, status=0, out=None):
        result = subprocess.run(self.arguments(*more, out=out), stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, universal_newlines=True, timeout=300)
        self.assertEqual(result.returncode, status, result.stderr)
        return result

    def wait_for(self, condition, process):
        deadline = time.monotonic() + 60
        while not condition():
            self.assertIsNone(process.poll(), "the trainer ended early")
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.005)

    def updates_done(self):
        try:
            return content_of(self.run, "metrics.csv").count(b"\n") - 1
        except FileNotFoundError:
            return -1

    def kill_and_resume(self, kills):
        """Kills one run again and again at random moments; its files must be those of another."""
        unbroken = os.path.join(self.folder, "unbroken")
        started = time.monotonic()
        self.complete(out=unbroken)
        whole = time.monotonic() - started
        moments = random.Random(kills)
        counted = 0
        while counted < kills:
            process = self.start("--resume")
            # Also before the first checkpoint, and in the middle of a write.
            try:
                process.communicate(timeout=moments.uniform(0, 1.5 * whole / kills))
                self.assertEqual(process.returncode, 0)
                # It has come to its end; what follows is another run.
                self.assert_same_run(unbroken)
                subprocess.check_call(["rm", "-r", self.run])
            except subprocess.TimeoutExpired:
                process.kill()
                process.communicate()
                counted += 1
        self.complete("--resume")
        self.assert_same_run(unbroken)

    def assert_same_run(self, unbroken):
        for name in ("policy.safetensors", "last.safetensors", "config.yaml"):
            self.assertEqual(content_of(self.run, name), content_of(unbroken, name), name)
        self.assertEqual(rows_of(self.run), rows_of(unbroken))
        self.assertEqual(len(checkpoints(self.run)), 3)
        self.assertEqual([n for n in os.listdir(self.run) if n.endswith(".tmp")], [])

    def test_killed_at_random_moments(self):
        self.kill_and_resume(KILLS)

    def test_a_finished_run_says_so(self):
        first = self.complete("--episodes", "30").stdout.splitlines()[-1]
        again = self.complete("--episodes", "30", "--resume").stdout
        self.assertIn("had finished", again)
        self.assertEqual(again.splitlines()[-1], first)
        # Its own configuration is enough.
        result = subprocess.run([TRAIN, "--out", self.run, "--resume"], stdout=subprocess.PIPE,
                                universal_newlines=True)
        self.assertEqual((result.returncode, result.stdout), (0, again))

    def test_another_configuration_is_refused(self):
        self.complete("--episodes", "30")
        for more, text in ((["--episodes", "40"], "episodes = 40, but this run has 30"),
                           (["--episodes", "30", "--seed", "7"], "seed = 7, but this run has 0"),
                           (["--episodes", "30", "--backend", "libtorch"], "this run has fused")):
            self.assertIn(text, self.complete("--resume", *more, status=2).stderr)

    def test_damaged_checkpoints_are_named_and_passed_over(self):
        self.complete("--episodes", "60")
        policy = content_of(self.run, "policy.safetensors")
        newest = os.path.join(self.run, checkpoints(self.run)[-1])
        with open(newest, "r+b") as file:
            file.seek(-1, os.SEEK_END)
            last = file.read(1)[0]
            file.seek(-1, os.SEEK_END)
            file.write(bytes([last ^ 1]))
        result = self.complete("--episodes", "60", "--resume")
        self.assertIn(newest + ": damaged", result.stderr)
        self.assertEqual(content_of(self.run, "policy.safetensors"), policy)

    def test_a_second_trainer_ends_at_once(self):
        self.config = small_config(self.config, 1000000)
        first = self.start()
        self.wait_for(lambda: self.updates_done() > 1, first)
        started = time.monotonic()
        second = self.complete("--resume", status=2)
        self.assertLess(time.monotonic() - started, 2)
        self.assertIn("is in use by process %d" % first.pid, second.stderr)
        first.send_signal(signal.SIGTERM)
        first.communicate(timeout=30)

    def test_signals_end_it_and_more_of_them_harm_nothing(self):
        self.config = small_config(self.config, 1000000)
        for number in (signal.SIGINT, signal.SIGTERM):
            process = self.start("--resume")
            before = self.updates_done()
            self.wait_for(lambda: self.updates_done() > before + 3, process)
            for _ in range(20):
                process.send_signal(number)
                time.sleep(0.001)
                if process.poll() is not None:
                    break
            output, _ = process.communicate(timeout=10)
            self.assertEqual(process.returncode, 128 + number)
            self.assertIn("stopped by signal %d" % number, output)
            # Nothing is redone after an end by a signal.
            last = checkpoints(self.run)[-1]
            self.assertEqual(last, "checkpoint_%08d.safetensors" % self.updates_done())
            self.assertTrue(os.path.exists(os.path.join(self.run, "last.safetensors")))

    def limited(self, size):
        """Popen arguments for a process that cannot write files beyond `size` bytes."""
        return {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))}

    def test_what_cannot_be_written_ends_it_with_path_and_bytes(self):
        process = self.start(**self.limited(20000))  # a checkpoint has more
        output, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1, output)
        self.assertRegex(errors, self.run + r"/checkpoint_0000000\d.safetensors: "
                                            r"cannot write \d+ bytes: File too large")
        self.assertEqual(checkpoints(self.run), [])
        self.complete("--resume")
        self.assertEqual(len(rows_of(self.run)), 100)

    def test_or_is_told_and_tried_again(self):
        self.config = small_config(self.config, 200)
        process = self.start("--on-save-error", "continue", **self.limited(20000))
        output, errors = process.communicate(timeout=60)
        self.assertIn("training goes on", errors)
        self.assertIn("200/200 episodes", output)
        self.assertEqual(process.returncode, 1)  # its result is lost
        self.assertEqual(len(rows_of(self.run)), 20)


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "resume", ResumeTest)
