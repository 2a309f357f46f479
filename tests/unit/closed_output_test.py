#!/usr/bin/python3
"""Command-line tools whose output nobody takes: a word, status 1, and a training that is saved."""
import os
import subprocess
import tempfile
import unittest

import rosunit

CONFIG = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "config")
POLICY = os.path.join(CONFIG, "policies", "vfs.safetensors")
DATA = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "data", "bags_1")
BAG = os.path.join(DATA, sorted(os.listdir(DATA))[-1])
TAKEN = "standard output cannot be written: "


def program(package, name):
    return subprocess.check_output(["catkin_find", "--first-only", "--libexec", package, name],
                                   universal_newlines=True).strip()


def closed_pipe():
    """The end to write into of a pipe that nobody reads."""
    reader, writer = os.pipe()
    os.close(reader)
    return os.fdopen(writer, "wb", buffering=0)


def run(command, output):
    return subprocess.run(command, stdout=output, stderr=subprocess.PIPE, universal_newlines=True)


class ClosedOutputTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def expect_a_word(self, name, command):
        """Of a tool that prints, and of its help."""
        command = [program(*name), *command]
        for arguments in (command, [command[0], "--help"]):
            with closed_pipe() as pipe, open("/dev/full", "wb") as full:
                for output, reason in ((pipe, "Broken pipe"), (full, "No space left on device")):
                    with self.subTest(arguments=arguments, reason=reason):
                        result = run(arguments, output)
                        self.assertEqual(result.returncode, 1, result.stderr)
                        lines = result.stderr.splitlines()
                        self.assertEqual(lines[-1], "%s: %s%s" % (name[1], TAKEN, reason))

    def test_tools_that_print(self):
        stroke = os.path.join(self.folder, "stroke")
        for package, name, arguments in (
                ("threelink_agent", "describe_policy", [POLICY]),
                ("threelink_agent", "evaluate", ["--policy", POLICY, "--trials", "0", "--json"]),
                ("threelink_sim", "bench", ["--json", "--seconds", "0.1"]),
                ("threelink_sim", "make_urdf", []),
                ("threelink_tasks", "verify_bag", [BAG]),
                ("threelink_sim", "optimal_stroke",
                 ["--square=-1,1", "--pieces", "4", "--out", stroke, "--json"])):
            self.expect_a_word((package, name), arguments)
        self.assertEqual(sorted(os.listdir(self.folder)), ["stroke.csv", "stroke.json"])

    def test_a_stream_that_is_closed_from_the_start(self):
        result = subprocess.run(["bash", "-c", '"$@" >&-', "bash",
                                 program("threelink_agent", "describe_policy"), POLICY],
                                stderr=subprocess.PIPE, universal_newlines=True)
        self.assertEqual(result.returncode, 1)
        self.assertIn(TAKEN, result.stderr)

    def test_a_training_saves_its_run_first(self):
        train = [program("threelink_agent", "train"), "--config",
                 os.path.join(CONFIG, "train_vfs.yaml"), "--episodes", "60", "--no-plot", "--out"]
        read = os.path.join(self.folder, "read")
        self.assertEqual(run(train + [read], subprocess.DEVNULL).returncode, 0)
        for name, output in (("pipe", closed_pipe()), ("full", open("/dev/full", "wb"))):
            with self.subTest(name), output:
                out = os.path.join(self.folder, name)
                result = run(train + [out], output)
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assertIn("train: " + TAKEN.rstrip(": "), result.stderr)
                for file in ("policy.safetensors", "last.safetensors"):
                    with open(os.path.join(out, file), "rb") as left, \
                            open(os.path.join(read, file), "rb") as right:
                        self.assertEqual(left.read(), right.read())


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "closed_output", ClosedOutputTest)
