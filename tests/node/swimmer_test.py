#!/usr/bin/python3
"""A policy plays the swimmer that it was trained for, of any number of links, and no other one."""
import math
import os
import shutil
import subprocess
import tempfile
import unittest

import rosbag
import roslaunch.config
import roslib.packages
import rospkg
import rospy
import rostest
import yaml
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PointStamped
from threelink_msgs.msg import HingeRates, Observation
from threelink_msgs.srv import LoadPolicy, Reset

from random_policy import write_policy
from waiting import wait

HERE = os.path.dirname(os.path.realpath(__file__))
LAUNCH = os.path.join(HERE, "../../scripts/launch.py")


def program(package, name):
    return roslib.packages.find_node(package, name)[0]


class PlayedSwimmerTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        self.policy = os.path.join(self.folder, "a policy.safetensors")

    def play(self, *arguments):
        return subprocess.run(
            ["/usr/bin/python3", LAUNCH, os.path.join(HERE, "short_episode.launch"), "rviz:=false",
             "max_steps:=50", "bag_dir:=bags", "policy:=" + os.path.basename(self.policy), *arguments],
            cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=60,
            universal_newlines=True)

    def test_its_swimmer_is_that_of_the_policy(self):
        write_policy(self.policy, links=5, dt=0.2, gamma=0.9, joint_limit="1.25")
        done = self.play()
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn("not captured (time-out after 50 steps)", done.stdout)
        folder = os.path.join(self.folder, "bags")
        (bag,) = [os.path.join(folder, name) for name in os.listdir(folder) if name.endswith(".bag")]
        with rosbag.Bag(bag) as file:
            messages = list(file.read_messages())
        (config,) = {m.config for topic, m, _ in messages if topic.endswith("/episode")}
        simulator = yaml.safe_load(config)["simulator"]
        self.assertEqual([simulator[name] for name in ("links", "dt", "gamma", "joint_limit")],
                         [5, 0.2, 0.9, 1.25])
        states = [m for topic, m, _ in messages if topic.endswith("/state")]
        self.assertEqual({len(state.theta) for state in states}, {5})
        self.assertNotEqual(tuple(states[0].alpha), tuple(states[-1].alpha))
        self.assertLessEqual(max(abs(a) for state in states for a in state.alpha), 1.25)
        proof = subprocess.run([program("threelink_tasks", "verify_bag"), bag],
                               stdout=subprocess.PIPE, universal_newlines=True)
        self.assertEqual(proof.returncode, 0, proof.stdout)

    def test_four_links_are_played_recorded_proven_and_shown(self):
        share = rospkg.RosPack().get_path("threelink_tasks")
        shutil.copy(os.path.join(share, "config/policies/vfs_n4.safetensors"), self.policy)
        done = self.play()
        self.assertEqual(done.returncode, 0, done.stdout)
        folder = os.path.join(self.folder, "bags")
        (bag,) = [os.path.join(folder, name) for name in os.listdir(folder) if name.endswith(".bag")]
        with rosbag.Bag(bag) as file:
            messages = list(file.read_messages())
        states = [m for topic, m, _ in messages if topic.endswith("/state")]
        observations = [m for topic, m, _ in messages if topic.endswith("/observation")]
        self.assertEqual(len(observations), 50)
        # It sees the angle of its axis, the mean of the two middle links.
        for state, seen in zip(states, observations):
            theta_d = (state.theta[1] + state.theta[2]) / 2 - seen.theta_t
            self.assertAlmostEqual(seen.values[0], math.cos(theta_d), delta=1e-9)
            self.assertAlmostEqual(seen.values[1], math.sin(theta_d), delta=1e-9)
            self.assertEqual(list(seen.values[2:]), list(state.alpha))
        proof = subprocess.run([program("threelink_tasks", "verify_bag"), bag],
                               stdout=subprocess.PIPE, universal_newlines=True)
        self.assertEqual(proof.returncode, 0, proof.stdout)
        # What rviz and robot_state_publisher get of it, and the picture.
        playback = roslaunch.config.load_config_default(
            [(os.path.join(share, "launch/playback.launch"), ["bag:=" + bag, "rviz:=false"])], None,
            assign_machines=False)
        robot = playback.params["/threelink/robot_description"].value
        self.assertIn('<link name="link_4">', robot)
        self.assertNotIn('<link name="link_5">', robot)
        picture = os.path.join(self.folder, "picture.png")
        subprocess.run([program("threelink_tasks", "plot_episode"), bag, "--out", picture], check=True,
                       timeout=60)
        self.assertGreater(os.path.getsize(picture), 10000)

    def test_another_number_of_links_is_refused_with_both_values(self):
        write_policy(self.policy, links=4)
        done = self.play("links:=3")
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertIn("links = 3 instead of 4", done.stdout)
        done = self.play("links:=3", "allow_other_swimmer:=true")  # which cannot be played
        self.assertEqual(done.returncode, 2, done.stdout)

    def test_another_swimmer_is_refused_by_launch(self):
        write_policy(self.policy, gamma=0.9)
        done = self.play("gamma:=0.5")
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertIn("gamma = 0.5 instead of 0.9", done.stdout)
        done = self.play("gamma:=0.5", "allow_other_swimmer:=true")
        self.assertEqual(done.returncode, 0, done.stdout)


class AgentTest(unittest.TestCase):
    """The agent against simulators that are started by hand."""

    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        self.own = os.path.join(self.folder, "own.safetensors")
        write_policy(self.own)
        self.messages = {}  # of the agent's status, by level
        self.rates = []
        self.observed = 0
        topics = [rospy.Subscriber("/diagnostics", DiagnosticArray, self.on_diagnostics),
                  rospy.Subscriber("hinge_rates", HingeRates, self.rates.append),
                  rospy.Subscriber("observation", Observation, self.on_observation)]
        for topic in topics:
            self.addCleanup(topic.unregister)
        self.target = rospy.Publisher("target", PointStamped, queue_size=10)
        self.addCleanup(self.target.unregister)

    def on_diagnostics(self, array):
        for status in array.status:
            if status.name.startswith("agent"):
                self.messages[status.message] = status.level

    def on_observation(self, _):
        self.observed += 1

    def start(self, package, name, *parameters):
        process = subprocess.Popen([program(package, name), *parameters],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)  # so that the master forgets it
        return process

    def simulate(self, *parameters):
        for name in ("links", "gamma", "dt", "joint_limit"):
            if rospy.has_param("simulator/" + name):
                rospy.delete_param("simulator/" + name)
        process = self.start("threelink_sim", "simulator_node", "_realtime_factor:=0", *parameters)
        rospy.wait_for_service("reset", 20)
        self.assertTrue(wait(lambda: self.target.get_num_connections() > 0))
        return process

    def observe(self):
        """Makes the simulator publish an observation."""
        before = self.observed
        state = rospy.ServiceProxy("reset", Reset)().state
        target = PointStamped()
        target.header = state.header
        target.point.x = 1
        self.target.publish(target)
        self.assertTrue(wait(lambda: self.observed > before))

    def refusal(self, words):
        return wait(lambda: any(words in message for message in list(self.messages)))

    def test_refuses_other_swimmers_with_both_values(self):
        simulator = self.simulate()
        self.assertEqual(rospy.get_param("simulator/gamma"), 0.5)  # defaults, too
        self.start("threelink_agent", "agent_node", "_policy:=" + self.own)
        rospy.wait_for_service("load_policy", 20)
        self.observe()
        self.assertTrue(wait(lambda: self.rates))
        load = rospy.ServiceProxy("load_policy", LoadPolicy)
        for swimmer, words in (({"gamma": 0.9}, "gamma = 0.5 instead of 0.9"),
                               ({"dt": 0.2}, "dt = 0.1 instead of 0.2"),
                               ({"joint_limit": "1.0"}, "instead of 1")):
            path = os.path.join(self.folder, "other.safetensors")
            write_policy(path, **swimmer)
            answer = load(path)
            self.assertFalse(answer.success)
            self.assertIn(words, answer.status)
        # A simulator that is started anew, with another swimmer, is another one.
        simulator.terminate()
        simulator.wait()
        del self.rates[:]
        self.simulate("_gamma:=0.9", "_dt:=0.2")
        self.observe()
        self.assertTrue(self.refusal("gamma = 0.9 instead of 0.5, dt = 0.2 instead of 0.1"))
        self.assertEqual(self.rates, [])

    def test_plays_another_swimmer_if_it_may(self):
        self.simulate("_gamma:=0.9")
        self.start("threelink_agent", "agent_node", "_policy:=" + self.own,
                   "_allow_other_swimmer:=true")
        self.addCleanup(rospy.delete_param, "agent/allow_other_swimmer")
        rospy.wait_for_service("load_policy", 20)
        self.observe()
        self.assertTrue(wait(lambda: self.rates))


if __name__ == "__main__":
    rospy.init_node("swimmer_test", disable_signals=True)
    rostest.rosrun("threelink_tests", "swimmer", "__main__")
