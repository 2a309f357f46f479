#!/usr/bin/python3
"""The tool swim as a user runs it: files in, files out, refusals."""
import csv
import json
import os
import subprocess
import tempfile
import unittest

import rosunit

DATA = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "data", "reference")
START = "1,0,0,0,0"


def swim(folder, rates, *arguments):
    path = os.path.join(folder, "rates.csv")
    with open(path, "w") as file:
        file.write(rates)
    out = os.path.join(folder, "out.csv")
    if "--out" not in arguments:
        arguments += ("--out", out)
    result = subprocess.run(["rosrun", "threelink_sim", "swim", "--rates", path, *arguments],
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                            universal_newlines=True)
    rows = []
    if result.returncode == 0:
        with open(out) as file:
            rows = list(csv.reader(file))
    return result, rows


class SwimTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def swim(self, rates, *arguments):
        return swim(self.folder.name, rates, *arguments)

    def refused(self, text, rates, *arguments):
        result, _ = self.swim(rates, *arguments)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn(text, result.stderr)

    def test_reference_runs(self):
        with open(os.path.join(DATA, "zero_order_hold.json")) as file:
            runs = json.load(file)["runs"]
        for run in runs:
            start, end = run["start"], run["final"]
            values = [start["x1"], start["y1"], start["theta1"]] + start["alpha"]
            rates = "".join(",".join(repr(r) for r in row) + "\n" for row in run["rates"])
            result, rows = self.swim(
                rates, "--start", ",".join(repr(v) for v in values), "--dt", repr(run["dt"]),
                "--gamma", repr(run["gamma"]), "--links", str(run["links"]))
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(rows[0], ["t", "x1", "y1", "theta_1", "theta_2", "theta_3", "xc",
                                       "yc", "work", "dissipation"])
            self.assertEqual(len(rows), 2 + len(run["rates"]))
            last = [float(cell) for cell in rows[-1]]
            # In still water all of the work is dissipated.
            expected = [end["x1"], end["y1"]] + end["theta"] + [end["xc"], end["yc"], end["work"], end["work"]]
            self.assertAlmostEqual(last[0], len(run["rates"]) * run["dt"], delta=1e-12)
            for found, wanted in zip(last[1:], expected):
                self.assertAlmostEqual(found, wanted, delta=1e-11)

    def test_first_row_is_the_start(self):
        result, rows = self.swim("0.1,0.2\n", "--start", "1,0,0.5,0.1,-0.2")
        self.assertEqual(result.returncode, 0, result.stderr)
        first = [float(cell) for cell in rows[1]]
        for found, wanted in zip(first, [0, 1, 0, 0.5, 0.6, 0.4]):
            self.assertAlmostEqual(found, wanted, delta=1e-15)
        self.assertEqual(first[-1], 0)

    def test_joint_limit(self):
        self.refused("rates.csv:1: a hinge would pass the joint limit", "1,0\n", "--start", "0,0,0,2.05,0")
        result, rows = self.swim("1,0\n", "--start", "0,0,0,2.05,0", "--clip")
        self.assertEqual(result.returncode, 0, result.stderr)
        theta = [float(cell) for cell in rows[-1][3:6]]
        self.assertAlmostEqual(theta[1] - theta[0], 2.0943951023931953, delta=1e-15)

    def test_refusals(self):
        self.refused('rates.csv:2: column 1: "x" is no number', "0,0\nx,0\n", "--start", START)
        self.refused('rates.csv:1: column 2: "nan" is no number', "0,nan\n", "--start", START)
        self.refused('rates.csv:1: "0,0,0" has more than 2 numbers', "0,0,0\n", "--start", START)
        self.refused("git lfs pull", "version https://git-lfs.github.com/spec/v1\n",
                     "--start", START)
        self.refused('--start:1: column 5: "x" is no number', "0,0\n", "--start", "1,0,0,0,x")
        self.refused("has no rows", "", "--start", START)
        self.refused("--start has 4 values", "0,0\n", "--start", "1,0,0,0")
        self.refused("alpha_1 = 3", "0,0\n", "--start", "1,0,0,3,0")
        self.refused("--dt", "0,0\n", "--start", START, "--dt", "0")
        self.refused('--links: "1" must be a whole number in [2, 32]', "0\n", "--start", "1,0,0", "--links", "1")
        self.refused("gamma = -1", "0,0\n", "--start", START, "--gamma", "-1")
        self.refused("--start is required", "0,0\n")

    def test_rates_of_a_spreadsheet(self):
        plain, rows = self.swim("0.9,0\n1e-320,0\n", "--start", START)
        self.assertEqual(plain.returncode, 0, plain.stderr)
        self.assertEqual(self.swim("\ufeff0.9,0\r\n1e-320,0\r\n\r\n", "--start", START)[1], rows)

    def test_out_is_whole_or_as_it_was(self):
        out = os.path.join(self.folder.name, "out.csv")
        with open(out, "w") as file:
            file.write("precious")
        # Only the last row is refused.
        self.refused("rates.csv:21: a hinge", "1,0\n" * 30, "--start", START)
        self.refused("--out", "0,0\n", "--start", START, "--out", self.folder.name)
        with open(out) as file:
            self.assertEqual(file.read(), "precious")
        self.assertEqual(sorted(os.listdir(self.folder.name)), ["out.csv", "rates.csv"])

    def test_out_is_never_the_rates(self):
        rates = os.path.join(self.folder.name, "rates.csv")
        link = os.path.join(self.folder.name, "link.csv")
        os.symlink("rates.csv", link)
        for path in (rates, link):
            self.refused("is the same file as", "0.1,0\n", "--start", START, "--out", path)
            with open(rates) as file:
                self.assertEqual(file.read(), "0.1,0\n")

    def test_help(self):
        result = subprocess.run(["rosrun", "threelink_sim", "swim", "--help"],
                                stdout=subprocess.PIPE, universal_newlines=True)
        self.assertEqual(result.returncode, 0)
        for option in ("--start", "--rates", "--dt", "--links", "--gamma", "--out", "--clip"):
            self.assertIn(option, result.stdout)


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "swim", SwimTest)
