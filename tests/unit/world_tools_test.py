#!/usr/bin/python3
"""Worlds in the tools, as users run them: what they do to the swimmer, and what is refused."""
import csv
import glob
import json
import os
import subprocess
import tempfile
import unittest

import rosunit

ROOT = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..")
WORLDS = sorted(glob.glob(os.path.join(ROOT, "config", "worlds", "*.yaml")))
STILL = ["0.1,0.5", "-0.3,0.2", "0.4,-0.6", "0,0"]


def run(*command):
    return subprocess.run(["rosrun", *command], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True, timeout=100)


class WorldToolsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def file_of(self, name, text):
        path = os.path.join(self.folder, name)
        with open(path, "w") as file:
            file.write(text)
        return path

    def swim(self, world=None, rates=STILL, start="0.3,-0.2,0.7,0.4,-0.9", *options):
        path = self.file_of("rates.csv", "\n".join(rates) + "\n")
        out = os.path.join(self.folder, "out.csv")
        if world is not None:
            options += ("--world", self.file_of("world.yaml", world))
        done = run("threelink_sim", "swim", "--start", start, "--rates", path, "--out", out, *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(out) as file:
            return [[float(cell) for cell in row] for row in list(csv.reader(file))[1:]]

    def motion(self, world, rates="0.5,-0.3"):
        done = run("threelink_sim", "motion", "--state", "0,0.5,0,0.4,-0.9", "--rates", rates, "--json", "--world",
                   self.file_of("world.yaml", world))
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def test_an_empty_world_is_still_water_to_the_bit(self):
        self.assertEqual(self.swim(""), self.swim())

    def test_a_uniform_flow_carries_the_swimmer_and_costs_nothing(self):
        for row, still in zip(self.swim("flow: [{kind: uniform, U: [0.01, -0.02]}]"), self.swim()):
            carried = list(still)
            for place in (1, 6):
                carried[place] += 0.01 * still[0]
                carried[place + 1] -= 0.02 * still[0]
            for found, expected in zip(row, carried):
                self.assertAlmostEqual(found, expected, delta=1e-13)

    def test_a_plugin_is_a_flow(self):
        # It turns a locked swimmer as it turns itself, about the origin: no force, no work.
        motion = self.motion("flow: [{kind: stirred, rate: 0.03}]", "0,0")
        for found, expected in zip(motion["velocity"][0], (-0.03 * 0.5, 0, 0.03)):
            self.assertAlmostEqual(found, expected, delta=1e-15)
        self.assertAlmostEqual(motion["power"], 0, delta=1e-16)
        self.assertAlmostEqual(motion["dissipation"], 0, delta=1e-16)

    def test_the_noise_is_that_of_its_seed(self):
        noise, first = "thermal_noise: 1.0e-4", "0.3,-0.2,0.7,0.4,-0.9"
        once = self.swim(noise, STILL, first, "--seed", "0")
        self.assertEqual(once, self.swim(noise, STILL, first, "--seed", "0"))
        self.assertNotEqual(once, self.swim(noise, STILL, first, "--seed", "1"))
        self.assertNotEqual(once, self.swim())

    def test_every_shipped_world_is_played(self):
        self.assertEqual(len(WORLDS), 6)
        policy = os.path.join(ROOT, "config", "policies", "homing.safetensors")
        for world in WORLDS:
            with self.subTest(os.path.basename(world)):
                done = run("threelink_tasks", "trials", "--task", "pursuit", "--policy", policy, "--trials", "4",
                           "--max-steps", "50", "--json", "--world", world)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual(json.loads(done.stdout)["trials"], 4)

    def test_bad_worlds_are_refused_by_every_tool(self):
        rates = self.file_of("rates.csv", "0,0\n")
        policy = os.path.join(ROOT, "config", "policies", "vfs.safetensors")
        with open(os.path.join(ROOT, "config", "train_vfs.yaml")) as file:
            config = file.read().replace("environment:\n", "environment:\n  world: bad.yaml\n")
            config = config.replace("mirror: true", "mirror: false")  # which flows and obstacles refuse
        out = os.path.join(self.folder, "out")
        for text, words in (("flow: [{kind: shear}]", "bad.yaml/flow[0]/kind = \"shear\""),
                            ("flow: [{kind: uniform, U: [.inf, 0]}]", "bad.yaml/flow[0]/U = inf"),
                            ("flow: [{kind: grid, file: none.csv}]", "none.csv"),
                            ("flow: [{kind: linear, A: [[0, 30], [0, 0]]}]", "sweeps"),
                            ("obstacles: [{kind: half_plane, point: [0, 0], normal: [0, 0]}]", "side"),
                            ("thermal_nois: 1", "thermal_noise"), ("[1, 2]", "bad.yaml")):
            world = self.file_of("bad.yaml", text + "\n")
            for command in (
                    ("threelink_sim", "swim", "--start", "0,0,0,0,0", "--rates", rates, "--out", out, "--world", world),
                    ("threelink_sim", "motion", "--state", "0,0,0,0,0", "--rates", "1,1", "--world", world),
                    ("threelink_tasks", "trials", "--task", "pursuit", "--policy", policy, "--world", world),
                    ("threelink_agent", "train", "--config", self.file_of("train.yaml", config), "--out", out)):
                if command[1] == "motion" and words == "sweeps":
                    continue  # takes no step
                with self.subTest(text, tool=command[1]):
                    done = run(*command)
                    self.assertEqual(done.returncode, 2, done.stderr)
                    self.assertIn(words, done.stderr)
                    self.assertFalse(os.path.exists(out))


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "world_tools_test", WorldToolsTest)
