#!/usr/bin/python3
"""Whole pursuits over ROS, as users start them: outcome, bag, picture, signals, playback."""
import collections
import csv
import json
import os
import re
import shutil
import signal
import struct
import subprocess
import tempfile
import time
import unittest
from xmlrpc.client import ServerProxy

import rosbag
import rosgraph
import roslib.packages
import rospkg
import rospy
import rostest
import yaml
from nav_msgs.msg import Path
from rosgraph_msgs.msg import Clock

from threelink_msgs.msg import Episode, SwimmerState

from waiting import wait

LAUNCH = os.path.join(os.path.dirname(os.path.realpath(__file__)), "../../scripts/launch.py")
POLICY = os.path.realpath(os.path.join(rospkg.RosPack().get_path("threelink_tasks"),
                                       "config/policies/homing.safetensors"))
NAMESPACE = "/threelink/"
LOOP = ("state", "target", "observation", "hinge_rates")


def launch(file, **arguments):
    return subprocess.Popen(
        ["/usr/bin/python3", LAUNCH, "threelink_tasks", file, "rviz:=false"] +
        ["%s:=%s" % item for item in arguments.items()],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)


def interrupt(process, number=signal.SIGINT):
    """Ends a launch; returns (seconds that it took, output)."""
    begin = time.monotonic()
    process.send_signal(number)
    output, _ = process.communicate(timeout=20)
    return time.monotonic() - begin, output


def rows(folder):
    path = os.path.join(folder, "episodes.csv")
    if not os.path.exists(path):
        return []
    with open(path) as file:
        return list(csv.DictReader(file))


def read(path):
    """{topic without namespace: [message]} of a bag."""
    messages = collections.defaultdict(list)
    with rosbag.Bag(path) as bag:
        for topic, message, stamp in bag.read_messages():
            messages[topic.replace(NAMESPACE, "", 1)].append((stamp, message))
    return messages


def policy_metadata():
    with open(POLICY, "rb") as file:
        (size,) = struct.unpack("<Q", file.read(8))
        return json.loads(file.read(size).decode())["__metadata__"]


class EpisodesTest(unittest.TestCase):
    """Two episodes after a diffusing target, at full speed."""

    SEED = 3

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.process = launch("pursuit.launch", realtime_factor=0, v_ratio=0, seed=cls.SEED,
                             episodes=2, bag_dir=cls.folder)
        cls.output, _ = cls.process.communicate(timeout=120)
        cls.rows = rows(cls.folder)
        cls.bags = [read(os.path.join(cls.folder, row["bag"])) for row in cls.rows]

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def setUp(self):
        self.assertEqual(len(self.bags), 2, self.output)

    def test_ends_by_itself_with_success(self):
        self.assertEqual(self.process.returncode, 0, self.output)

    def test_prints_one_line_for_each_episode(self):
        lines = re.findall(r"^episode (\d+): captured after (\d+) steps \(t = (\S+), "
                           r"distance (\S+), mean speed (\S+)\), bag (\S+), picture (\S+)$",
                           self.output, re.MULTILINE)
        self.assertEqual([line[0] for line in lines], ["1", "2"], self.output)
        for line, row in zip(lines, self.rows):
            _, steps, t, distance, speed, bag, picture = line
            self.assertEqual(steps, row["steps"])
            self.assertAlmostEqual(float(t), 0.1 * int(steps), places=6)
            self.assertLess(float(distance), 0.001)
            self.assertAlmostEqual(float(speed), float(row["mean_speed"]), delta=1e-4)
            self.assertEqual(bag, os.path.join(self.folder, row["bag"]))
            self.assertEqual(picture, bag[:-len(".bag")] + ".png")

    def test_index_agrees_with_the_bags(self):
        for number, (row, bag) in enumerate(zip(self.rows, self.bags), 1):
            self.assertRegex(row["bag"],
                             r"^pursuit_\d{4}(-\d\d){5}_ep%04d\.bag$" % number)
            end = bag["episode"][-1][1]
            self.assertEqual(row["episode"], str(number))
            self.assertEqual(row["task"], "pursuit")
            self.assertEqual(row["seed"], str(self.SEED))
            self.assertEqual(row["status"], "captured")
            self.assertEqual(row["steps"], str(end.step))
            self.assertEqual(float(row["time"]), end.time)
            self.assertEqual(float(row["distance"]), end.distance)
            self.assertEqual(float(row["mean_speed"]), end.mean_speed)
            self.assertEqual(row["policy_sha256"], end.policy_sha256)
            self.assertEqual(row["messages"], str(sum(len(m) for m in bag.values())))
            self.assertEqual(row["recovered"], "no")

    def test_bags_hold_every_step(self):
        for number, bag in enumerate(self.bags, 1):
            states = [message for _, message in bag["state"]]
            last = len(states) - 1
            self.assertEqual([state.step for state in states], list(range(last + 1)))
            self.assertEqual({state.episode for state in states}, {number})
            stamps = [state.header.stamp for state in states]
            self.assertEqual(stamps, sorted(set(stamps)))
            for topic in ("observation", "hinge_rates"):
                answers = [message for _, message in bag[topic]]
                self.assertEqual([answer.step for answer in answers], list(range(last)), topic)
                self.assertEqual({answer.episode for answer in answers}, {number})
            # The last state is the outcome: it is not answered.
            for topic in ("target", "observation", "hinge_rates"):
                self.assertEqual([m.header.stamp for _, m in bag[topic]], stamps[:-1], topic)
            for topic in ("joint_states", "pose"):
                self.assertEqual(bag[topic][-1][1].header.stamp, stamps[-1], topic)
            self.assertIn("base_link", {transform.child_frame_id for _, message in bag["/tf"]
                                        for transform in message.transforms})
            # Played with --clock, the bag shows simulation time.
            for topic in LOOP:
                for stamp, message in bag[topic]:
                    self.assertEqual(stamp, message.header.stamp)

    def test_bags_explain_themselves(self):
        metadata = policy_metadata()
        for number, bag in enumerate(self.bags, 1):
            start, end = (message for _, message in bag["episode"])
            self.assertEqual((start.status, end.status), (Episode.STARTED, Episode.CAPTURED))
            self.assertEqual((start.episode, start.seed, start.step), (number, self.SEED, 0))
            self.assertEqual(start.header.stamp, bag["state"][0][1].header.stamp)
            self.assertEqual(end.header.stamp, bag["state"][-1][1].header.stamp)
            self.assertEqual(start.policy_sha256, metadata["sha256"])
            self.assertEqual({m.policy for _, m in bag["hinge_rates"]}, {metadata["sha256"][:16]})
            self.assertEqual(start.policy_file, POLICY)
            self.assertRegex(start.revision, r"^([0-9a-f]{40}(-dirty)?|unknown)$")
            config = yaml.safe_load(start.config)
            self.assertEqual(config["task"]["seed"], self.SEED)
            self.assertEqual(config["task"]["v_ratio"], 0)
            self.assertEqual(config["task"]["diffusivity"], 5e-5)
            self.assertEqual(config["simulator"]["dt"], 0.1)
            self.assertEqual(config["simulator"]["links"], 3)
            # As the policy wants it.
            self.assertEqual(config["simulator"]["observation"], "target")
            self.assertEqual(config["agent"], {"sampled": True, "seed": self.SEED})
            self.assertEqual({(m.kind, len(m.values)) for _, m in bag["observation"]}, {("target", 7)})

    def test_chunks_are_small(self):
        for row in self.rows:
            with rosbag.Bag(os.path.join(self.folder, row["bag"])) as bag:
                sizes = [header.uncompressed_size for header in bag._chunk_headers.values()]
            self.assertGreater(len(sizes), 10)
            self.assertLessEqual(max(sizes), 16 * 1024)

    def test_pictures_are_drawn(self):
        for row in self.rows:
            with open(os.path.join(self.folder, row["bag"][:-len("bag")] + "png"), "rb") as file:
                picture = file.read()
            self.assertEqual(picture[:8], b"\x89PNG\r\n\x1a\n")
            self.assertGreater(len(picture), 10000)

    def test_equals_the_episode_in_one_process_to_the_bit(self):
        program = roslib.packages.find_node("threelink_tests", "play_episode")[0]
        for number, bag in enumerate(self.bags, 1):
            lines = subprocess.run([program, POLICY, str(self.SEED), str(number), "pursuit",
                                    "{v_ratio: 0}", "sampled"], check=True, stdout=subprocess.PIPE, universal_newlines=True).stdout
            played = [[float.fromhex(word) for word in line.split()] for line in lines.splitlines()]
            self.assertEqual(len(played), len(bag["state"]))
            for k, (_, state) in enumerate(bag["state"]):
                expected = [*state.centroid, state.theta[1], *state.alpha]
                if k < len(bag["target"]):
                    point, rates = bag["target"][k][1].point, bag["hinge_rates"][k][1].rates
                    self.assertEqual(played[k], expected + [point.x, point.y] + list(rates))
                else:
                    self.assertEqual(played[k][:len(expected)], expected)

    def test_playback_shows_the_episode_again_and_again(self):
        paths = {"swimmer_path": [], "target_path": []}  # stamps of all poses, of each message
        clock = []
        add = lambda message, path: path.append([p.header.stamp.to_sec() for p in message.poses])
        topics = [rospy.Subscriber(NAMESPACE + name, Path, add, path)
                  for name, path in paths.items()]
        topics = [*topics, rospy.Subscriber("/clock", Clock, lambda m: clock.append(m.clock.to_sec()))]
        process = launch("playback.launch", rate=60, loop="true",
                         bag=os.path.join(self.folder, self.rows[0]["bag"]))
        try:
            jumps = lambda times: sum(b < a for a, b in zip(times, times[1:]))
            ends = lambda name: [stamps[-1] for stamps in list(paths[name]) if stamps]
            self.assertTrue(wait(lambda: jumps(clock) >= 2 and jumps(ends("swimmer_path")) >= 2
                                 and jumps(ends("target_path")) >= 2, 40))
            self.assertIsNone(process.poll())
            # A path never holds more than one pass.
            for path in paths.values():
                for stamps in path:
                    self.assertEqual(stamps, sorted(set(stamps)))
        finally:
            for topic in topics:
                topic.unregister()
            seconds, output = interrupt(process)
        self.assertLess(seconds, 5)
        self.assertNotRegex(output, "TF_|died|ERROR|Traceback")


class InterruptedTest(unittest.TestCase):
    """Recorder and launch are killed; at the usual pace."""

    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.arrivals = {}
        self.subscriber = rospy.Subscriber(NAMESPACE + "state", SwimmerState, self.on_state)
        self.process = launch("pursuit.launch", realtime_factor=10, v_ratio=1, bag_dir=self.folder)

    def on_state(self, state):
        self.arrivals[state.step] = time.monotonic()

    def active(self):
        return [name for name in os.listdir(self.folder) if name.endswith(".active")]

    def tearDown(self):
        self.subscriber.unregister()
        if self.process.poll() is None:
            interrupt(self.process)
        shutil.rmtree(self.folder)

    def test_a_killed_recorder_loses_less_than_a_second(self):
        self.assertTrue(wait(lambda: len(self.arrivals) > 200))
        uri = rosgraph.Master("/test").lookupNode(NAMESPACE + "recorder")
        pid = ServerProxy(uri).getPid("/test")[2]
        os.kill(pid, signal.SIGKILL)
        killed = time.monotonic()
        # It comes back, recovers the bag and records the rest of the episode.
        self.assertTrue(wait(lambda: rows(self.folder)))
        (row,) = rows(self.folder)
        self.assertEqual((row["recovered"], row["status"], row["seed"]), ("yes", "aborted", "0"))
        self.assertRegex(row["bag"], r"^pursuit_\S+_ep0001_recovered\.bag$")
        path = os.path.join(self.folder, row["bag"])
        self.assertTrue(wait(lambda: os.path.exists(path)))  # it is named after its row is written
        bag = read(path)
        old = [step for step, arrival in self.arrivals.items() if arrival < killed - 0.5]
        recovered = {message.step for _, message in bag["state"]}
        self.assertGreater(len(old), 100)
        self.assertGreaterEqual(len(recovered & set(old)), 0.99 * len(old))
        self.assertEqual(bag["episode"][0][1].status, Episode.STARTED)
        self.assertEqual(row["steps"], str(max(recovered)))
        self.assertEqual(row["messages"], str(sum(len(m) for m in bag.values())))

        self.assertTrue(wait(lambda: self.active()))
        seconds, output = interrupt(self.process)
        self.assertLess(seconds, 5, output)
        self.assertEqual(self.active(), [])
        rest = read(os.path.join(self.folder, rows(self.folder)[1]["bag"]))
        self.assertGreater(rest["state"][0][1].step, max(recovered))

    def test_signals_close_the_bag(self):
        self.assertTrue(wait(lambda: len(self.arrivals) > 50))
        seconds, output = interrupt(self.process, signal.SIGTERM)
        self.assertLess(seconds, 5, output)
        self.assertEqual(self.process.returncode, 128 + signal.SIGTERM)
        self.assertRegex(output, r"(?m)^episode 1: aborted \(interrupted\) after \d+ steps")
        (row,) = rows(self.folder)
        self.assertEqual((row["status"], row["recovered"]), ("aborted", "no"))
        bag = read(os.path.join(self.folder, row["bag"]))
        end = bag["episode"][-1][1]
        self.assertEqual((end.status, end.reason), (Episode.ABORTED, "interrupted"))
        steps = [m.step for _, m in bag["state"]]
        self.assertEqual(steps, list(range(len(steps))))
        self.assertIn(steps[-1] - end.step, (0, 1))  # the simulator may have been on its way
        self.assertEqual(self.active(), [])


class RefusalTest(unittest.TestCase):
    def test_a_folder_in_which_nothing_can_be_written_is_refused_before_the_first_step(self):
        process = launch("pursuit.launch", realtime_factor=0, bag_dir="/proc/bags")
        output, _ = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 2, output)
        self.assertRegex(output, "the recorder cannot record: ~bag_dir = /proc/bags: the folder cannot "
                                 "be made: No such file or directory")
        self.assertNotRegex(output, "(?m)^episode")


if __name__ == "__main__":
    rospy.init_node("pursuit_test", disable_signals=True)
    rostest.rosrun("threelink_tests", "pursuit", "__main__")
