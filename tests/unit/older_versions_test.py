#!/usr/bin/python3
"""Runs and policies that an older version wrote: they go on, to the bit, and are played."""
import json
import os
import shutil
import struct
import subprocess
import tempfile
import unittest

import roslib.packages
import rosunit

DATA = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "data", "runs_1")


def program(name):
    return roslib.packages.find_node("threelink_agent", name)[0]


def run(*command):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=120,
                          universal_newlines=True, check=False)


def metadata(path):
    with open(path, "rb") as file:
        (length,) = struct.unpack("<Q", file.read(8))
        return json.loads(file.read(length))["__metadata__"]


class OlderVersionsTest(unittest.TestCase):
    def test_a_training_goes_on_to_the_bits_that_it_would_have_had(self):
        for name in ("direction", "homing"):
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                out = os.path.join(folder, "run")
                shutil.copytree(os.path.join(DATA, name), out)
                ended = run(program("train"), "--resume", "--out", out, "--no-plot")
                self.assertEqual(ended.returncode, 0, ended.stdout)
                found = metadata(os.path.join(out, "last.safetensors"))
                wanted = metadata(os.path.join(DATA, name + ".safetensors"))
                self.assertEqual(found["sha256"], wanted["sha256"])
                self.assertNotIn("version:", wanted["config"])
                self.assertIn("version: 2\n", found["config"])

    def test_its_policies_are_described_and_played(self):
        for name, observation in (("direction", "direction"), ("homing", "target")):
            with self.subTest(name):
                policy = os.path.join(DATA, name + ".safetensors")
                told = run(program("describe_policy"), "--field", "observation", "--", policy)
                self.assertEqual(told.stdout.strip(), observation)
                ended = run(program("evaluate"), "--policy", policy, "--trials", "1")
                self.assertEqual(ended.returncode, 0, ended.stdout)


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "older_versions", OlderVersionsTest)
