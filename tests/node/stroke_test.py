#!/usr/bin/python3
"""stroke_node: the simulator's swimmer makes the stroke of a file, or Purcell's, step by step."""
import json
import os
import signal
import subprocess
import tempfile
import unittest

import roslib.packages
import rospkg
import rospy
import rostest

from threelink_msgs.msg import SwimmerState

from waiting import wait

PROGRAM = roslib.packages.find_node("threelink_sim", "stroke_node")[0]
STROKE = os.path.join(rospkg.RosPack().get_path("threelink_tasks"), "config/strokes/speed.json")


def start(*parameters, space="threelink"):
    if rospy.has_param("/%s/stroke" % space):
        rospy.delete_param("/%s/stroke" % space)
    return subprocess.Popen([PROGRAM, "__name:=stroke", "__ns:=" + space, *parameters],
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                            universal_newlines=True)


class StrokeTest(unittest.TestCase):
    def played(self, steps, *parameters, space="threelink"):
        """The states of the episode that the node starts, up to this step."""
        received = []
        topic = rospy.Subscriber("/%s/state" % space, SwimmerState, received.append,
                                 tcp_nodelay=True)

        def latest_episode():  # an earlier one's last state is latched
            states = list(received)
            episode = max((state.episode for state in states), default=0)
            return {state.step: state for state in states if state.episode == episode}

        node = start(*parameters, space=space)
        try:
            self.assertTrue(wait(lambda: len(latest_episode()) > steps), node.poll())
            states = latest_episode()
            return [states[k] for k in range(steps + 1)]
        finally:
            topic.unregister()
            node.send_signal(signal.SIGINT)
            node.communicate(timeout=20)

    def refused(self, text, *parameters):
        node = start(*parameters)
        output, _ = node.communicate(timeout=20)
        self.assertEqual(node.returncode, 2, output)
        self.assertIn(text, output)

    def test_a_file_is_played_as_it_is(self):
        with open(STROKE) as file:
            stroke = json.load(file)
        self.assertEqual(stroke["dt"], 0.1)
        for space in ("threelink", "near"):  # whatever the observation shows of the target
            with self.subTest(space):
                states = self.played(stroke["pieces"], "_file:=" + STROKE, space=space)
                for state, rates in zip(states[1:], stroke["rates"]):
                    for found, wanted in zip(state.hinge_rates, rates):
                        self.assertAlmostEqual(found, wanted, delta=1e-12)
                self.assertAlmostEqual(states[-1].centroid[0], stroke["displacement"], delta=1e-11)
                self.assertAlmostEqual(states[-1].centroid[1], 0, delta=1e-11)
                self.assertAlmostEqual(sum(state.work for state in states), stroke["work"],
                                       delta=1e-11)

    def test_purcells_stroke_keeps_its_angles_at_any_step(self):
        # A side takes 2 pi/3 / 0.1 = 20.9 steps: the corners are cut, and do not drift.
        states = self.played(3 * 84, "_amplitude:=%r" % (1.0471975511965976,))
        for hinge in range(2):
            angles = [state.alpha[hinge] for state in states]
            self.assertLess(max(angles), 1.0471975511965976 + 1e-9)
            self.assertGreater(max(angles), 1.0471975511965976 - 0.1)
            self.assertGreater(min(angles), -1.0471975511965976 - 1e-9)
            self.assertLess(min(angles), -1.0471975511965976 + 0.1)
        # Three periods of 83.8 steps, 0.0637 each, within the way of a step and the cut corners.
        self.assertAlmostEqual(states[-1].centroid[0], 3 * 0.0637, delta=0.01)

    def test_refusals(self):
        self.refused("/no/such/file: cannot open", "_file:=/no/such/file")
        self.refused("amplitude = 3", "_amplitude:=3.0")
        with open(STROKE) as file:
            stroke = json.load(file)
        too_far = {"joint_limit": 3.0, "dt": 1.0, "start": {"alpha": [1.5, 0.0]},
                   "rates": [[1.0, 0.0], [-1.0, 0.0]]}
        for change, said in (({"gamma": 0.75}, "gamma = 0.75; the simulator has 3, 0.5"),
                             (too_far, "rates, row 1: a hinge would pass the joint limit")):
            with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
                json.dump({**stroke, **change}, file)
                file.flush()
                self.refused(said, "_file:=" + file.name)


if __name__ == "__main__":
    rospy.init_node("stroke_test")
    rostest.rosrun("threelink_tests", "stroke", StrokeTest)
