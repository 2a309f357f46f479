#!/usr/bin/python3
"""Policy files are readable with numpy alone, by the code that docs/learning.md gives."""
import os
import re
import subprocess
import tempfile
import unittest

import numpy
import rosunit

MANUAL = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "docs", "learning.md")


def reader():
    """What the Python block of the section "Policy files" defines."""
    with open(MANUAL, encoding="utf-8") as file:
        section = file.read().split("## Policy files")[1]
    namespace = {}
    exec(re.search("```python\n(.*?)```", section, re.DOTALL).group(1), namespace)
    return namespace["read_policy"], namespace["act"]


class PolicyNumpyTest(unittest.TestCase):
    def check(self, symmetry, observation="direction", size=4):
        read_policy, act = reader()
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "policy.safetensors")
            lines = subprocess.run(
                ["rosrun", "threelink_tests", "policy_sample", path, symmetry, observation],
                stdout=subprocess.PIPE, universal_newlines=True, check=True).stdout.splitlines()
            metadata, tensors = read_policy(path)
            with open(path, "rb") as file:
                data = bytearray(file.read())
            data[-1] ^= 1
            with open(path, "wb") as file:
                file.write(data)
            self.assertRaises(AssertionError, read_policy, path)
        self.assertEqual(metadata["format"], "threelink-policy-1")
        self.assertEqual(metadata["symmetry"], symmetry)
        self.assertEqual(metadata["observation"], observation)
        self.assertEqual((metadata["links"], float(metadata["dt"])), ("3", 0.1))
        self.assertEqual(tensors["actor.0.weight"].shape, (64, size))
        self.assertEqual(tensors["log_std"].shape, (2,))
        self.assertEqual(len(lines), 200)
        for line in lines:
            values = [float(value) for value in line.split()]
            numpy.testing.assert_allclose(act(metadata, tensors, values[:size]), values[size:],
                                          rtol=0, atol=1e-6)

    def test_without_symmetry(self):
        self.check("none")

    def test_with_reversal(self):
        self.check("reversal")

    def test_of_a_target(self):
        self.check("none", "target", 7)
        self.check("reversal", "target", 7)


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "policy_numpy", PolicyNumpyTest)
