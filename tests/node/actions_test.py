#!/usr/bin/python3
"""Episodes of every kind of task over topics, asked for by the action run_episode."""
import hashlib
import json
import os
import shutil
import struct
import subprocess
import tempfile
import threading
import unittest

import actionlib
import roslib.packages
import rospy
import rostest
import yaml
from actionlib_msgs.msg import GoalStatus
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PointStamped
from visualization_msgs.msg import InteractiveMarkerFeedback, Marker, MarkerArray

from threelink_msgs.msg import Episode, RunEpisodeAction, RunEpisodeGoal, RunEpisodeResult

from pursuit_test import NAMESPACE, POLICY, interrupt, launch, read
from waiting import wait

STAR = "{threshold: 0.05}"


def played_in_one_process(*arguments):
    """[[x, y, heading, alphas, target, rates]] of every state, the last without target and rates."""
    program = roslib.packages.find_node("threelink_tests", "play_episode")[0]
    lines = subprocess.run([program, *map(str, arguments)], check=True, stdout=subprocess.PIPE,
                           universal_newlines=True).stdout
    rows = [[float.fromhex(word) for word in line.split()] for line in lines.splitlines()]
    rows[-1] = rows[-1][:5]  # over topics the last state is not answered with a target
    return rows


def recorded(bag):
    """The same of a bag."""
    rows = []
    for k, (_, state) in enumerate(bag["state"]):
        row = [*state.centroid, state.theta[1], *state.alpha]
        if k < len(bag["target"]):
            point = bag["target"][k][1].point
            row += [point.x, point.y, *bag["hinge_rates"][k][1].rates]
        rows.append(row)
    return rows


def changed_policy(path):
    """A policy file with another last bias; returns its sha256."""
    with open(POLICY, "rb") as file:
        (size,) = struct.unpack("<Q", file.read(8))
        header, data = file.read(size), bytearray(file.read())
    fields = json.loads(header.decode())
    begin, _ = fields["actor.4.bias"]["data_offsets"]
    struct.pack_into("<f", data, begin, struct.unpack_from("<f", data, begin)[0] + 0.001)
    old = fields["__metadata__"]
    sha256 = hashlib.sha256(data).hexdigest()
    header = header.replace(old["sha256"].encode(), sha256.encode())
    zeroed = header.replace(old["header_sha256"].encode(), b"0" * 64)
    header = zeroed.replace(b"0" * 64, hashlib.sha256(zeroed).hexdigest().encode())
    with open(path, "wb") as file:
        file.write(struct.pack("<Q", size) + header + data)
    return sha256


class ActionsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.process = launch("task.launch", task="direction", episodes=0, realtime_factor=0, sampled="false",
                             bag_dir=cls.folder)
        cls.client = actionlib.SimpleActionClient(NAMESPACE + "run_episode", RunEpisodeAction)
        # Its own time-out goes by /clock, which stands still.
        waiting = threading.Thread(target=cls.client.wait_for_server, daemon=True)
        waiting.start()
        waiting.join(30)
        cls.there = not waiting.is_alive() and wait(rospy.get_time)

    @classmethod
    def tearDownClass(cls):
        seconds, output = interrupt(cls.process)
        shutil.rmtree(cls.folder)
        assert seconds < 5, output

    def setUp(self):
        self.assertTrue(self.there)
        self.feedback = []

    def send(self, task, parameters="", seed=0, policy=""):
        self.client.send_goal(RunEpisodeGoal(task=task, parameters=parameters, seed=seed,
                                             policy=policy), feedback_cb=self.feedback.append)

    def result(self, seconds=60):
        # The state is known before the result has come.
        self.assertTrue(wait(lambda: self.client.simple_state == actionlib.SimpleGoalState.DONE,
                             seconds))
        return self.client.get_result()

    def test_a_star_equals_the_one_in_one_process_to_the_bit(self):
        shown = []
        subscriber = rospy.Subscriber(NAMESPACE + "waypoints", MarkerArray, shown.append)
        self.send("waypoints", STAR, seed=5)
        result = self.result()
        self.assertEqual(self.client.get_state(), GoalStatus.SUCCEEDED)
        self.assertEqual((result.outcome, result.reason), (RunEpisodeResult.CAPTURED, ""))
        self.assertEqual(result.waypoint, 10)
        self.assertLess(result.distance, 0.05)
        bag = read(result.bag)
        start, end = (message for _, message in bag["episode"])
        self.assertEqual((end.status, end.step, end.waypoint), (Episode.CAPTURED, result.steps, 10))
        self.assertEqual((end.episode, end.task, end.seed), (result.episode, "waypoints", 5))
        rows = played_in_one_process(POLICY, 5, result.episode, "waypoints", STAR, "mean")
        self.assertEqual(recorded(bag), rows)

        work = sum(state.work for _, state in bag["state"])
        self.assertAlmostEqual(result.time, 0.1 * result.steps, places=9)
        self.assertAlmostEqual(result.energy, work, places=12)
        self.assertEqual(result.mean_speed, end.mean_speed)
        self.assertAlmostEqual(result.efficiency,
                               0.5 * result.mean_speed ** 2 * result.time / work, places=12)
        config = yaml.safe_load(start.config)
        self.assertEqual((config["task"]["name"], config["task"]["threshold"]), ("waypoints", 0.05))
        self.assertEqual(config["agent"], {"sampled": False, "seed": 0})
        steps = [message.step for message in self.feedback]
        self.assertEqual(steps, sorted(steps))
        self.assertGreater(len(steps), 1)

        # Every waypoint is ticked in the end.
        ticks = lambda array: sum(len(m.points) // 4 for m in array.markers if m.ns == "ticks")
        self.assertTrue(wait(lambda: shown and ticks(shown[-1]) == 10))
        numbers = [m.text for m in shown[-1].markers if m.ns == "numbers"]
        self.assertEqual(numbers, [str(i) for i in range(1, 11)])
        self.assertEqual(shown[-1].markers[0].action, Marker.DELETEALL)
        subscriber.unregister()

    def test_a_task_from_another_package_is_played(self):
        parameters = "{threshold: 0.05, period: 300}"
        self.send("pendulum", parameters)
        result = self.result()
        self.assertEqual(result.outcome, RunEpisodeResult.CAPTURED)
        rows = played_in_one_process(POLICY, 0, result.episode, "pendulum", parameters, "mean")
        self.assertEqual(recorded(read(result.bag)), rows)
        self.assertRegex(os.path.basename(result.bag), "^pendulum_")

    def test_a_random_start_is_that_of_the_episode(self):
        parameters = "{threshold: 0.05, min_distance: 0.2}"
        self.send("point", parameters, seed=11)
        result = self.result()
        self.assertEqual(result.outcome, RunEpisodeResult.CAPTURED)
        rows = played_in_one_process(POLICY, 11, result.episode, "point", parameters, "mean")
        self.assertEqual(recorded(read(result.bag)), rows)

    def test_cancelling_leaves_a_whole_bag(self):
        self.send("direction", "{max_steps: 10000000}")
        self.assertTrue(wait(lambda: self.feedback and self.feedback[-1].step > 100))
        self.client.cancel_goal()
        result = self.result()
        self.assertEqual(self.client.get_state(), GoalStatus.PREEMPTED)
        self.assertEqual((result.outcome, result.reason), (RunEpisodeResult.ABORTED, "cancelled"))
        bag = read(result.bag)
        end = [message for _, message in bag["episode"]][-1]
        self.assertEqual((end.status, end.reason), (Episode.ABORTED, "cancelled"))
        steps = [state.step for _, state in bag["state"]]
        self.assertEqual(steps, list(range(len(steps))))
        # The simulator may have been on its way already.
        self.assertIn(steps[-1] - result.steps, (0, 1))
        self.assertFalse([name for name in os.listdir(self.folder) if name.endswith(".active")])

    def test_a_new_goal_takes_the_place_of_the_old_one(self):
        self.send("direction", "{max_steps: 10000000}")
        self.assertTrue(wait(lambda: self.feedback and self.feedback[-1].step > 10))
        self.send("direction", "{max_steps: 5}")
        result = self.result()
        self.assertEqual((result.outcome, result.steps), (RunEpisodeResult.TIMED_OUT, 5))

    def test_bad_goals_are_refused_and_the_next_one_is_played(self):
        for task, parameters, policy, message in (
                ("hovering", "", "", 'there is no task "hovering"'),
                ("pursuit", "", "", "parameters/v_ratio is missing"),
                ("waypoints", "{treshold: 1}", "", "nearest one is parameters/threshold"),
                ("waypoints", "[1, 2]", "", "must be a dictionary"),
                ("waypoints", "{a: [", "", "parameters: is not YAML: line 1"),
                ("waypoints", "{a: &b [*b]}", "", "parameters: line 1, column 5: anchors"),
                ("waypoints", "{a: " + "[" * 10000, "", "parameters: "),
                ("waypoints", "{points: /no/file.csv}", "", "/no/file.csv: cannot open"),
                ("waypoints", "{points: /dev/zero}", "", "/dev/zero: not a file"),
                ("direction", "", "/no/policy", "/no/policy")):
            with self.subTest(task=task, parameters=parameters):
                self.send(task, parameters, policy=policy)
                result = self.result()
                self.assertEqual(self.client.get_state(), GoalStatus.ABORTED)
                self.assertEqual((result.outcome, result.episode), (RunEpisodeResult.ABORTED, 0))
                self.assertIn(message, result.reason)
                self.assertIn(message, self.client.get_goal_status_text())
        self.send("direction", "{max_steps: 3}")
        self.assertEqual(self.result().steps, 3)

    def test_no_file_is_quoted_to_those_who_name_it(self):
        for name, content in (("a.csv", "1,2\nsecret\n"), ("a.yaml", "[secret]"),
                              ("b.yaml", "*secret")):
            path = os.path.join(self.folder, name)
            with open(path, "w") as file:
                file.write(content)
            for task, parameters, policy in (("waypoints", "{points: %s}" % path, ""),
                                             ("direction", "", path)):
                with self.subTest(name, task=task):
                    self.send(task, parameters, policy=policy)
                    result = self.result()
                    self.assertIn(path, result.reason)
                    self.assertNotIn("secret", result.reason)
                    self.assertNotIn("secret", self.client.get_goal_status_text())

    def test_a_goal_may_bring_its_policy(self):
        path = os.path.join(self.folder, "other.safetensors")
        sha256 = changed_policy(path)
        for policy, expected in ((path, sha256), ("", None)):
            self.send("direction", "{max_steps: 5}", policy=policy)
            result = self.result()
            self.assertEqual(result.outcome, RunEpisodeResult.TIMED_OUT, result.reason)
            bag = read(result.bag)
            start = bag["episode"][0][1]
            self.assertEqual({m.policy for _, m in bag["hinge_rates"]}, {start.policy_sha256[:16]})
            self.assertEqual(start.policy_sha256 == sha256, expected is not None)
            self.assertEqual(start.policy_file, policy or POLICY)

    def test_it_goes_where_the_user_points(self):
        clicks = rospy.Publisher("/clicked_point", PointStamped, queue_size=10)
        drags = rospy.Publisher(NAMESPACE + "target_marker/feedback", InteractiveMarkerFeedback,
                                queue_size=10)
        refused = []

        def on_diagnostics(message):
            for status in message.status:
                refused.extend(v.value for v in status.values if v.key == "clicked point refused")
        subscriber = rospy.Subscriber("/diagnostics", DiagnosticArray, on_diagnostics)

        def click(x, y, frame="world"):
            message = PointStamped()
            message.header.frame_id = frame
            message.point.x, message.point.y = x, y
            clicks.publish(message)

        self.send("clicked_point", "{clicks: 2, threshold: 0.05}")
        self.assertTrue(wait(lambda: clicks.get_num_connections() and drags.get_num_connections()
                             and self.feedback))
        click(9, 9, frame="map")
        click(float("nan"), 0)
        self.assertTrue(wait(lambda: "2" in refused))
        click(1.8, 0.3)
        self.assertTrue(wait(lambda: self.feedback[-1].waypoint == 1, 30))
        drag = InteractiveMarkerFeedback(marker_name="target",
                                         event_type=InteractiveMarkerFeedback.POSE_UPDATE)
        drag.header.frame_id = "world"
        drag.client_id = "test"
        drag.pose.position.x, drag.pose.position.y = 1.5, -0.2
        drags.publish(drag)
        result = self.result()
        self.assertEqual((result.outcome, result.waypoint), (RunEpisodeResult.CAPTURED, 2))
        points = [message.point for _, message in read(result.bag)["target"]]
        way = []
        for point in points:
            if (point.x, point.y) not in way:
                way.append((point.x, point.y))
        self.assertEqual(way, [(1.5, 0.0), (1.8, 0.3), (1.5, -0.2)])
        subscriber.unregister()

    def test_the_example_prints_a_table(self):
        program = roslib.packages.find_node("threelink_tasks", "run_episodes.py")[0]
        example = subprocess.run([program, "--episodes", "3", "--seed", "4", "--task", "waypoints",
                                  "--parameters", STAR], stdout=subprocess.PIPE,
                                 universal_newlines=True, timeout=100)
        self.assertEqual(example.returncode, 0, example.stdout)
        lines = example.stdout.splitlines()
        self.assertEqual(len(lines), 4)
        self.assertEqual([line.split()[:2] for line in lines[1:]],
                         [[seed, "captured"] for seed in ("4", "5", "6")])


class SampledTest(unittest.TestCase):
    def test_sampled_episodes_repeat_to_the_bit(self):
        folder = tempfile.mkdtemp()
        process = launch("pursuit.launch", realtime_factor=0, v_ratio=0, seed=8, sampled="true",
                         bag_dir=folder)
        output, _ = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 0, output)
        (name,) = [name for name in os.listdir(folder) if name.endswith(".bag")]
        bag = read(os.path.join(folder, name))
        shutil.rmtree(folder)
        self.assertEqual(yaml.safe_load(bag["episode"][0][1].config)["agent"],
                         {"sampled": True, "seed": 8})
        rows = played_in_one_process(POLICY, 8, 1, "pursuit", "{v_ratio: 0}", "sampled")
        self.assertEqual(recorded(bag), rows)


if __name__ == "__main__":
    rospy.init_node("actions_test", disable_signals=True)
    rostest.rosrun("threelink_tests", "actions", "__main__")
