#!/usr/bin/python3
"""The tool trials: its JSON, its agreement with single episodes, what it refuses."""
import json
import os
import subprocess
import tempfile
import unittest

import roslib.packages
import rospkg
import rosunit

POLICIES = os.path.join(rospkg.RosPack().get_path("threelink_tasks"), "config/policies")
POLICY = os.path.join(POLICIES, "vfs.safetensors")
PROGRAM = roslib.packages.find_node("threelink_tasks", "trials")[0]
PLAY = roslib.packages.find_node("threelink_tests", "play_episode")[0]


def trials(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, universal_newlines=True, timeout=100)


def results(task, *arguments, policy=POLICY):
    done = trials("--task", task, "--policy", policy, "--json", *arguments)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def steps(task, parameters, seed, episode, how="mean"):
    lines = subprocess.run([PLAY, POLICY, str(seed), str(episode), task, parameters, how],
                           stdout=subprocess.PIPE, check=True, universal_newlines=True).stdout
    return len(lines.splitlines()) - 1


class TrialsToolTest(unittest.TestCase):
    def test_pursuits_are_those_of_single_episodes(self):
        for how in ("mean", "sampled"):
            told = results("pursuit", "--trials", 3, "--seed", 3, "--v-ratio", 0, "--" + how)
            single = sorted(steps("pursuit", "{v_ratio: 0}", 3, episode, how)
                            for episode in (1, 2, 3))
            self.assertEqual((told["completed"], told["trials"]), (3, 3))
            self.assertEqual(told["median_steps"], single[1])
            self.assertLess(told["final_distance_median"], 0.001)
            self.assertIsNone(told["median_ratio"])

    def test_stars_differ_and_their_ratio_is_that_of_their_way(self):
        one = results("star", "--trials", 40, "--parameters", "{threshold: 0.05}")
        self.assertEqual(one["completed"], 40)
        self.assertTrue(0.95 < one["median_ratio"] < 1.2, one)
        self.assertEqual(one, results("star", "--trials", 40, "--parameters", "{threshold: 0.05}"))
        self.assertNotEqual(one, results("star", "--trials", 40, "--seed", 1, "--parameters",
                                         "{threshold: 0.05}"))

    def test_the_homing_policies_trace_stars_and_reach_points(self):
        for name, most in (("homing", 1.12), ("homing_direction", 1.19)):
            with self.subTest(name):
                policy = os.path.join(POLICIES, name + ".safetensors")
                stars = results("star", "--trials", 40, "--seed", 9, policy=policy)
                self.assertEqual(stars["completed"], 40)
                self.assertLess(stars["median_ratio"], most)
                self.assertLess(stars["final_distance_median"], 0.001)
                # By itself it is played as the policy file says.
                self.assertEqual(stars, results("star", "--trials", 40, "--seed", 9, "--sampled",
                                                policy=policy))
                points = results("point", "--trials", 200, "--seed", 9, policy=policy)
                self.assertGreaterEqual(points["completed"], 197)

    def test_waypoints_of_a_file(self):
        with tempfile.NamedTemporaryFile("w", suffix=".csv") as file:
            file.write("2.0,0.5\n2.5,0.5\n")
            file.flush()
            told = results("star", "--waypoints", file.name, "--trials", 1, "--parameters",
                           "{threshold: 0.05}", "--max-steps", 3000)
        self.assertEqual(told["completed"], 1)
        way = (0.5 ** 2 + 0.5 ** 2) ** 0.5 + 0.5
        self.assertAlmostEqual(told["median_ratio"], told["median_steps"] * 0.00129154 / way)

    def test_what_is_not_completed_is_counted_and_has_no_median(self):
        told = results("point", "--trials", 20, "--max-steps", 1, "--parameters",
                       "{min_distance: 0.4}")
        self.assertEqual((told["completed"], told["trials"]), (0, 20))
        self.assertIsNone(told["median_steps"])
        self.assertTrue(0.39 < told["final_distance_median"] < 0.51)

    def test_parameters_are_those_that_were_given(self):
        slow = results("pursuit", "--trials", 3, "--seed", 3, "--v-ratio", 0)
        self.assertEqual(results("pursuit", "--trials", 3, "--seed", 3,
                                 "--parameters", "{v_ratio: 0}"), slow)
        self.assertNotEqual(results("pursuit", "--trials", 3, "--seed", 3), slow)
        # One star for all, in whose steps no seed changes anything.
        for parameters in ("random_star: false", "radius: 0.8", "rotation: 0.3"):
            stars = [results("star", "--trials", 1, "--seed", seed, "--mean", "--parameters",
                             "{threshold: 0.05, %s}" % parameters) for seed in (1, 2)]
            self.assertEqual(*stars)

    def test_what_is_given_twice_is_refused(self):
        for task, option, value, parameters in (
                ("pursuit", "--v-ratio", "0.5", "{v_ratio: 0.5}"),
                ("star", "--max-steps", "7", "{max_steps: 8}"),
                ("star", "--waypoints", "a.csv", "{points: b.csv}")):
            with self.subTest(option):
                done = trials("--task", task, "--policy", POLICY, option, value,
                              "--parameters", parameters)
                self.assertEqual(done.returncode, 2)
                self.assertIn("%s %s and --parameters %s:" % (option, value, parameters),
                              done.stderr)

    def test_wrong_arguments_are_refused(self):
        good = ("--task", "star", "--policy", POLICY)
        for arguments, message in (
                (("--policy", POLICY), "--task"),
                (("--task", "stars", "--policy", POLICY), 'there is no task "stars"'),
                (("--task", "star", "--policy", "/no/policy"), "/no/policy"),
                (good + ("--mean", "--sampled"), "--mean"),
                (good + ("--trials", "0"), "--trials"),
                (good + ("--seed", "9223372036854775808"), "must be a whole number in [0, 922337"),
                (good + ("--v-ratio", "fast"), "must be a number in [0, 100]"),
                (good + ("--waypoints", "/no/file.csv"), "/no/file.csv: cannot open"),
                (good + ("--parameters", "{treshold: 1}"), "nearest one is parameters/threshold"),
                (good + ("--parameters", "{a: ["), "--parameters"),
                (good + ("--parameters", "abc"), "--parameters abc: must be a dictionary"),
                (good + ("--parameters", "[1]"), "--parameters [1]: must be a dictionary"),
                (good + ("--v-ratio", "1"), "parameters/v_ratio"),
                (("--task", "point", "--policy", POLICY, "--waypoints", "a.csv"),
                 "parameters/points"),
                (good + ("--nonsense",), "--nonsense")):
            with self.subTest(arguments):
                done = trials(*arguments)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(message, done.stderr + done.stdout)
        self.assertEqual(trials("--help").returncode, 0)


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "trials_tool", TrialsToolTest)
