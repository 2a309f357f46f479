#!/usr/bin/python3
"""Proof by replay: real bags prove themselves, and any change to one is found."""
import io
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor

import rosbag
import roslib.packages
import rospkg
import rospy
import rostest
import yaml

HERE = os.path.dirname(os.path.realpath(__file__))
LAUNCH = os.path.join(HERE, "../../scripts/launch.py")
PROGRAM = roslib.packages.find_node("threelink_tasks", "verify_bag")[0]
STEPS = 60
MUTATIONS = int(os.environ.get("THREELINK_MUTATIONS", 200))


def verify(path, *options):
    """(exit status, output) of verify_bag."""
    done = subprocess.run([PROGRAM, path, *options], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, universal_newlines=True, timeout=60)
    return done.returncode, done.stdout


def read_raw(path):
    with rosbag.Bag(path) as bag:
        return [(topic, raw, stamp) for topic, raw, stamp in bag.read_messages(raw=True)]


def write_raw(path, messages):
    with rosbag.Bag(path, "w") as bag:
        for topic, raw, stamp in messages:
            bag.write(topic, raw, stamp, raw=True)


def name(topic):
    return topic.rpartition("/")[2]


class VerifyBagTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.output = subprocess.run(
            ["/usr/bin/python3", LAUNCH, os.path.join(HERE, "short_episode.launch"), "rviz:=false",
             "bag_dir:=" + cls.folder, "max_steps:=%d" % STEPS, "episodes:=3"], timeout=100,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True).stdout
        cls.bags = sorted(os.path.join(cls.folder, file) for file in os.listdir(cls.folder)
                          if file.endswith(".bag"))
        cls.raw = read_raw(cls.bags[0]) if cls.bags else []

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def setUp(self):
        self.assertEqual(len(self.bags), 3, self.output)

    def changed(self, change, number=0):
        """(exit status, output) for the first bag as change(messages) leaves its raw messages."""
        path = os.path.join(self.folder, "changed_%d.bag" % number)
        write_raw(path, change(list(self.raw)))
        try:
            return verify(path)
        finally:
            os.remove(path)

    def changed_field(self, topic, index, change):
        """The same, for a message of a topic as change(message) leaves it."""
        def apply(messages):
            places = [i for i, message in enumerate(messages) if name(message[0]) == topic]
            place = places[index]
            full_name, (kind, data, md5sum, position, python_type), stamp = messages[place]
            message = python_type()
            message.deserialize(data)
            change(message)
            buffer = io.BytesIO()
            message.serialize(buffer)
            messages[place] = (full_name, (kind, buffer.getvalue(), md5sum, position, python_type),
                               stamp)
            return messages
        return self.changed(apply)

    def without(self, topic, index):
        def apply(messages):
            places = [i for i, message in enumerate(messages) if name(message[0]) == topic]
            del messages[places[index]]
            return messages
        return self.changed(apply)

    def test_real_bags_prove_themselves(self):
        for path in self.bags:
            status, output = verify(path)
            self.assertEqual(status, 0, output)
            self.assertIn("OK: episode", output)
            status, output = verify(path, "--json")
            result = json.loads(output)
            self.assertEqual((status, result["ok"], result["whole"]), (0, True, True))
            self.assertEqual(result["actions_proven"], STEPS)
            self.assertTrue(result["targets_proven"])
            self.assertEqual(result["agreed"]["state"], STEPS + 1)
            for topic in ("target", "observation", "hinge_rates"):
                self.assertEqual(result["agreed"][topic], STEPS)
            self.assertEqual(result["agreed"]["episode"], 2)

    def test_a_copy_without_a_change_proves_itself(self):
        status, output = self.changed(lambda messages: messages)
        self.assertEqual(status, 0, output)

    def test_any_changed_byte_and_any_missing_message_is_found(self):
        def mutation(number):
            chance = random.Random(number)
            def apply(messages):
                place = chance.randrange(len(messages))
                if number % 4 == 0:
                    del messages[place]
                    return messages
                topic, (kind, data, *rest), stamp = messages[place]
                data = bytearray(data)
                data[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
                messages[place] = (topic, (kind, bytes(data), *rest), stamp)
                return messages
            return self.changed(apply, number)
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            results = list(pool.map(mutation, range(MUTATIONS)))
        missed = [number for number, (status, _) in enumerate(results) if status not in (1, 2)]
        print("%d of %d changes found" % (len(results) - len(missed), len(results)), file=sys.stderr)
        self.assertEqual(missed, [])

    def test_the_first_difference_is_named_with_both_values(self):
        def nudge(state):
            state.alpha = (state.alpha[0], state.alpha[1] + 1e-15)
        status, output = self.changed_field("state", 30, nudge)
        self.assertEqual(status, 1)
        self.assertRegex(output, r"NOT PROVEN: episode 1 of pursuit, seed 5, step 30, "
                                 r"state\.alpha\[1\]\n  recorded: -?[\d.e-]+\n  replayed: ")
        recorded, replayed = (float(line.split(": ")[1]) for line in output.splitlines()[1:3])
        self.assertAlmostEqual(recorded, replayed, delta=2e-15)
        self.assertNotEqual(recorded, replayed)
        self.assertRegex(output, r"\b30 state\b")

        cases = [("target", 7, lambda m: setattr(m.point, "x", m.point.x * (1 + 1e-15)),
                  "step 7, target.point.x"),
                 ("observation", 0, lambda m: setattr(m, "distance", 0.4),
                  "step 0, observation.distance"),
                 ("hinge_rates", 59, lambda m: setattr(m, "rates", (0.25, 0.5)),
                  r"step 59, hinge_rates.rates\[0\]"),
                 ("state", 60, lambda m: setattr(m, "reward", m.reward + 1),
                  "step 60, state.reward"),
                 ("state", 5, lambda m: setattr(m, "power", 0), "step 5, state.power"),
                 ("pose", 0, lambda m: setattr(m.pose.orientation, "w", 0.5), "pose.pose.orientation.w"),
                 ("joint_states", 0, lambda m: setattr(m, "name", ["hinge_1", "hinge_3"]),
                  r"joint_states.name\[1\]"),
                 ("episode", 0, lambda m: setattr(m, "seed", 6), "episode.seed"),
                 ("episode", 1, lambda m: setattr(m, "status", 1), "episode.status"),
                 ("state", 9, lambda m: setattr(m.header, "seq", 77777),
                  "messages of /threelink/state"),
                 ("tf_static", 0, lambda m: setattr(m.transforms[0].transform.translation, "x", 1),
                  "messages of /tf_static")]
        for topic, index, change, where in cases:
            status, output = self.changed_field(topic, index, change)
            self.assertEqual(status, 1, output)
            self.assertRegex(output, where)

    def test_missing_messages_are_named(self):
        for topic in ("state", "target", "observation", "hinge_rates"):
            status, output = self.without(topic, 20)
            self.assertEqual(status, 1)
            self.assertRegex(output, r"step 20, %s\n" % topic)
        for topic, index in (("episode", 0), ("episode", 1), ("joint_states", 0), ("recording", 0)):
            status, output = self.without(topic, index)
            self.assertEqual(status, 1, (topic, index))
            self.assertIn("NOT PROVEN", output)

    def test_a_wrong_parameter_is_found(self):
        def with_config(section, key, value):
            def apply(messages):
                for i, (topic, raw, stamp) in enumerate(messages):
                    if name(topic) != "episode":
                        continue
                    message = raw[4]()
                    message.deserialize(raw[1])
                    config = yaml.safe_load(message.config)
                    self.assertIn(key, config[section])
                    config[section][key] = value
                    message.config = yaml.safe_dump(config)
                    buffer = io.BytesIO()
                    message.serialize(buffer)
                    messages[i] = (topic, (raw[0], buffer.getvalue(), *raw[2:]), stamp)
                return messages
            return self.changed(apply)
        for section, key, value in (
                ("simulator", "gamma", 0.51), ("simulator", "dt", 0.11),
                ("simulator", "reward_b", 6.5), ("simulator", "length_scale", 2.0),
                ("simulator", "links", 4), ("task", "seed", 6), ("task", "diffusivity", 6.0e-5),
                ("task", "max_steps", 61), ("task", "v_ratio", 0.25), ("task", "v_m", 0.0128)):
            status, output = with_config(section, key, value)
            self.assertEqual(status, 1, (key, output))
            self.assertIn("NOT PROVEN", output)

    def test_without_its_policy_the_actions_are_not_claimed(self):
        def apply(messages):
            for i, (topic, raw, stamp) in enumerate(messages):
                if name(topic) not in ("episode", "hinge_rates"):
                    continue
                data = raw[1]
                message = raw[4]()
                message.deserialize(data)
                if name(topic) == "episode":
                    message.policy_sha256 = "ab" * 32
                else:
                    message.policy = "ab" * 8
                buffer = io.BytesIO()
                message.serialize(buffer)
                messages[i] = (topic, (raw[0], buffer.getvalue(), *raw[2:]), stamp)
            return messages
        status, output = self.changed(apply)
        self.assertEqual(status, 1)  # what the recorder wrote is another policy
        self.assertIn("checksum of the messages of /threelink/episode", output)
        self.assertIn("recomputed: 0 of %d actions" % STEPS, output)

    def test_a_bag_that_was_cut_off_says_so_and_how_far_it_agrees(self):
        def cut(messages):
            return [m for m in messages if m[2] <= messages[0][2] + rospy.Duration(3.05)
                    and name(m[0]) != "recording"]
        status, output = self.changed(cut)
        self.assertEqual(status, 1)
        self.assertIn("this bag is not whole", output)
        self.assertRegex(output, r"step 30, episode\n  recorded: no message")
        self.assertRegex(output, r"\b31 state\b")

    def test_the_rest_of_an_episode_is_verified_too(self):
        def late(messages):
            return [m for m in messages if m[2] > messages[0][2] + rospy.Duration(3.05)
                    or name(m[0]) == "episode"]
        status, output = self.changed(late)
        self.assertEqual(status, 1)
        self.assertRegex(output, r"\b30 state\b")

    def test_what_cannot_be_read_is_an_error(self):
        path = os.path.join(self.folder, "text.bag")
        with open(path, "w") as file:
            file.write("no bag")
        for arguments in ((path,), ("/no/such.bag",), (self.bags[0], "--policy", path),
                          (self.bags[0], "--nothing")):
            self.assertEqual(verify(*arguments)[0], 2, arguments)
        self.assertEqual(verify(self.bags[0], "--help")[0], 0)
        os.remove(path)

    def test_the_shipped_policy_can_be_named(self):
        policy = os.path.join(rospkg.RosPack().get_path("threelink_tasks"),
                              "config/policies/homing.safetensors")
        self.assertEqual(verify(self.bags[0], "--policy", policy)[0], 0)


if __name__ == "__main__":
    rospy.init_node("verify_bag_test", disable_signals=True)
    rostest.rosrun("threelink_tests", "verify_bag", VerifyBagTest)
