#!/usr/bin/python3
"""The tool optimal_stroke as a user runs it: its files, that swim plays them, refusals."""
import csv
import json
import os
import shlex
import subprocess
import tempfile
import time
import unittest

import rosunit

DATA = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "data", "reference")
FIELDS = {"format", "objective", "links", "gamma", "joint_limit", "dt", "pieces", "period", "start",
          "rates", "displacement", "rotation", "work", "speed", "power", "efficiency", "swim"}
OF_SEARCH = {"value", "seed", "seconds", "climbs"}


def run(*command):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True)


class OptimalStrokeToolTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.out = os.path.join(folder.name, "stroke")

    def tool(self, *arguments):
        return run("rosrun", "threelink_sim", "optimal_stroke", *arguments, "--out", self.out)

    def stroke(self, *arguments):
        """The JSON that was printed, after a look at the files."""
        result = self.tool(*arguments, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        stroke = json.loads(result.stdout)
        with open(self.out + ".json") as file:
            self.assertEqual(json.load(file), stroke)
        with open(self.out + ".csv") as file:
            rates = [[float(cell) for cell in row] for row in csv.reader(file)]
        self.assertEqual(rates, stroke["rates"])
        self.assertEqual(len(rates), stroke["pieces"])
        return stroke

    def played(self, stroke):
        """First and last row of what swim makes of the stroke."""
        out = self.out + "_played.csv"
        result = run(*shlex.split(stroke["swim"].replace("OUT.csv", out)))
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(out) as file:
            rows = list(csv.DictReader(file))
        return [{name: float(cell) for name, cell in rows[i].items()} for i in (0, -1)]

    def test_speed(self):
        stroke = self.stroke("--objective", "speed", "--pieces", "40", "--starts", "2", "--seed", "3")
        self.assertEqual(set(stroke), FIELDS | OF_SEARCH)
        self.assertEqual(stroke["format"], "threelink-stroke-1")
        self.assertEqual((stroke["objective"], stroke["seed"]), ("speed", 3))
        self.assertEqual(stroke["value"], stroke["speed"])
        self.assertAlmostEqual(stroke["speed"], 0.0129154, delta=4e-4 * 0.0129154)
        self.assertLessEqual(max(abs(rate) for row in stroke["rates"] for rate in row), 1)
        self.assertEqual([climb["name"] for climb in stroke["climbs"]],
                         ["start 1", "start 2", "refinement"])
        for climb in stroke["climbs"]:
            self.assertEqual(set(climb),
                             {"name", "pieces", "converged", "value", "seconds", "history"})
            self.assertTrue(climb["converged"])
            self.assertEqual([step[0] for step in climb["history"]],
                             list(range(1, len(climb["history"]) + 1)))
            self.assertAlmostEqual(climb["history"][-1][1], climb["value"], delta=1e-8)
        # One period closes the shape and goes along x as far as the file says.
        first, last = self.played(stroke)
        self.assertAlmostEqual(last["t"], stroke["period"], delta=1e-12)
        for i in ("theta_1", "theta_2", "theta_3"):
            self.assertAlmostEqual(last[i], first[i], delta=2e-8)
        self.assertAlmostEqual(last["theta_3"] - last["theta_2"],
                               first["theta_3"] - first["theta_2"], delta=1e-12)
        self.assertAlmostEqual(first["xc"], 0, delta=1e-15)
        self.assertAlmostEqual(last["xc"], stroke["displacement"], delta=1e-12)
        self.assertAlmostEqual(last["yc"], 0, delta=1e-12)
        self.assertAlmostEqual(last["work"], stroke["work"], delta=1e-12)
        self.assertAlmostEqual(stroke["speed"], stroke["displacement"] / stroke["period"])
        self.assertAlmostEqual(stroke["efficiency"],
                               0.5 * stroke["speed"] ** 2 / stroke["power"], delta=1e-15)

    def test_energy_aware(self):
        stroke = self.stroke("--objective", "energy_aware", "--b", "3", "--c", "1", "--dt", "0.2",
                             "--starts", "1")
        self.assertEqual(set(stroke), FIELDS | OF_SEARCH | {"b", "c"})
        self.assertEqual(stroke["dt"], 0.2)
        self.assertAlmostEqual(stroke["value"], 3 * stroke["speed"] - stroke["power"], delta=1e-14)

    def test_square(self):
        with open(os.path.join(DATA, "strokes.json")) as file:
            strokes = json.load(file)["strokes"]
        for wanted in strokes:
            if wanted["order"] != "CW":
                continue
            stroke = self.stroke("--square=%s,%s" % (wanted["lo"], wanted["hi"]))
            self.assertEqual(set(stroke), FIELDS)
            _, last = self.played(stroke)
            for name, key in (("xc", "dx_centroid"), ("yc", "dy_centroid"),
                              ("theta_2", "net_rotation"), ("work", "work_per_cycle")):
                self.assertAlmostEqual(last[name], float(wanted[key]), delta=1e-9)

    def test_text_and_progress(self):
        result = self.tool("--objective", "speed", "--pieces", "12", "--starts", "1")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("speed 0.01", result.stdout)
        self.assertIn(self.out + ".csv", result.stdout)
        lines = result.stderr.splitlines()
        self.assertEqual(len(lines), 2)  # not a terminal: one line a climb
        self.assertTrue(lines[0].startswith("start 1"))
        self.assertTrue(lines[1].startswith("refinement"))

    def test_six_links_take_less_than_a_minute(self):
        begin = time.monotonic()
        stroke = self.stroke("--objective", "speed", "--links", "6")
        self.assertLess(time.monotonic() - begin, 60)
        self.assertEqual((stroke["links"], stroke["pieces"]), (6, 240))
        self.assertAlmostEqual(stroke["speed"], 0.0387526, delta=1e-6)
        _, last = self.played(stroke)
        self.assertAlmostEqual(last["xc"], stroke["displacement"], delta=1e-12)
        self.assertAlmostEqual(last["yc"], 0, delta=1e-9)

    def test_a_refusal_leaves_what_was_there(self):
        self.stroke("--square=-1,1", "--pieces", "8")
        with open(self.out + ".csv") as file:
            before = file.read()
        self.assertEqual(self.tool("--objective", "speed", "--pieces", "2").returncode, 2)
        with open(self.out + ".csv") as file:
            self.assertEqual(file.read(), before)

    def test_refusals(self):
        for text, arguments in (
                ("--objective or --square is required", []),
                ("spee", ["--objective", "spee"]),
                ("links = 2", ["--objective", "speed", "--links", "2"]),
                ("gamma = -1", ["--objective", "speed", "--gamma", "-1"]),
                ("c = 99", ["--objective", "energy_aware", "--c", "99"]),
                ('--seed: "9223372036854775808" must be a whole number in [0, 9223372036854775807]',
                 ["--objective", "speed", "--seed", "9223372036854775808"]),
                ('--starts: "0.5" must be a whole number in [1, 1000]',
                 ["--objective", "speed", "--starts", "0.5"]),
                ('--dt: "1e-9" must be a number in [0.001, 1]',
                 ["--objective", "speed", "--dt", "1e-9"]),
                ("energy_aware only", ["--objective", "speed", "--c", "3"]),
                ("--pieces", ["--objective", "speed", "--pieces", "80", "--dt", "0.1"]),
                ("pieces = 5", ["--square=-1,1", "--pieces", "5"]),
                ("low angle 1 must be below", ["--square=1,-1"]),
                ("alpha_1", ["--square=-3,1"]),
                ("excludes", ["--square=-1,1", "--objective", "speed"])):
            with self.subTest(text):
                result = self.tool(*arguments)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertIn(text, result.stderr)
        result = run("rosrun", "threelink_sim", "optimal_stroke", "--objective", "speed", "--out",
                     "/no/such/folder/x")
        self.assertEqual(result.returncode, 2)
        self.assertIn("/no/such/folder/x.csv: cannot be written", result.stderr)

    def test_a_refusal_leaves_no_file(self):
        self.assertEqual(self.tool("--square=1,-1").returncode, 2)
        self.assertEqual(os.listdir(os.path.dirname(self.out)), [])


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "optimal_stroke_tool", OptimalStrokeToolTest)
