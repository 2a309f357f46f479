#!/usr/bin/python3
"""The task node alone: parameters, a simulator and a recorder that fail it, states out of order."""
import os
import subprocess
import unittest

import rospkg
import roslib.packages
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PointStamped

from threelink_msgs.msg import Episode, EpisodeAbort, Recording, SwimmerState
from threelink_msgs.srv import Reset, ResetResponse

from waiting import wait

PROGRAM = roslib.packages.find_node("threelink_tasks", "task_node")[0]
POLICY = os.path.join(rospkg.RosPack().get_path("threelink_tasks"),
                      "config/policies/vfs.safetensors")
NODE = "/threelink/task"
GOOD = {"task": "pursuit", "policy": POLICY, "v_ratio": 0.5, "record": False, "start_timeout": 10.0}

# Changed parameters, and what the error must say. None takes a parameter away.
BAD_PARAMETERS = [
    ({"policy": None}, "policy"),
    ({"policy": "/no/such/file"}, "/no/such/file"),
    ({"policy": __file__}, "policy"),
    ({"task": None}, "/threelink/task/task is missing"),
    ({"task": "pursuits"}, "must be one of: clicked_point, direction, path, p"),
    ({"v_ratio": None}, "v_ratio is missing"),
    ({"v_ratio": -0.1}, "v_ratio = -0.1"),
    ({"v_ratio": "1e-1"}, "write 1.0e-1"),
    ({"seed": -1}, "seed = -1"),
    ({"seed": 1.5}, "seed = 1.5"),
    ({"episodes": -1}, "episodes = -1"),
    ({"max_steps": 0}, "max_steps = 0"),
    ({"threshold": 0.0}, "threshold = 0"),
    ({"diffusivity": float("nan")}, "diffusivity = nan"),
    ({"target_x": 1.0e300}, "target_x = 1e+300"),
    ({"capture_between_steps": True}, "capture_between_steps = true (bool): needs a target at rest"),
    ({"simulator": "nobody"}, "/threelink/nobody"),
    ({"treshold": 0.001}, "the nearest one is /threelink/task/threshold"),
]


class Simulator:
    """Starts episodes and sends states, as it is told."""

    def __init__(self):
        self.stamp = 0.0
        self.episode = 0
        self.refusal = ""
        self.resets, self.targets, self.episodes, self.diagnostics = [], [], [], {}
        self.states = rospy.Publisher("/threelink/state", SwimmerState, queue_size=100)
        self.aborts = rospy.Publisher("/threelink/abort", EpisodeAbort, queue_size=10)
        self.topics = [
            rospy.Subscriber("/threelink/target", PointStamped, self.targets.append),
            rospy.Subscriber("/threelink/episode", Episode, self.episodes.append),
            rospy.Subscriber("/diagnostics", DiagnosticArray, self.on_diagnostics)]
        self.service = None

    def serve(self):
        self.service = rospy.Service("/threelink/reset", Reset, self.on_reset)

    def stop(self):
        if self.service:
            self.service.shutdown()
            self.service = None

    def on_diagnostics(self, message):
        for status in message.status:
            if "task" in status.name:
                self.diagnostics = {pair.key: pair.value for pair in status.values}

    def on_reset(self, request):
        self.resets.append(request)
        if self.refusal:
            return ResetResponse(success=False, status=self.refusal)
        self.episode += 1
        return ResetResponse(success=True, state=self.state(0))

    def state(self, step):
        self.stamp += 0.1
        state = SwimmerState(episode=self.episode, step=step, theta=[0, 0, 0], alpha=[0, 0])
        state.header.stamp = rospy.Time(self.stamp)
        state.centroid = [1.5, 0.0]
        return state


class TaskTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.simulator = Simulator()
        cls.recordings = rospy.Publisher("/threelink/recording", Recording, queue_size=1)
        rospy.set_param("/threelink/simulator", {"peer_timeout": 0.1, "realtime_factor": 0})

    def setUp(self):
        self.process = None
        self.simulator.refusal = ""
        for heard in (self.simulator.resets, self.simulator.targets, self.simulator.episodes):
            heard.clear()

    def tearDown(self):
        self.simulator.stop()
        if self.process and self.process.poll() is None:
            self.process.kill()
            self.process.communicate()

    def start(self, **changes):
        rospy.set_param(NODE, {name: value for name, value in dict(GOOD, **changes).items()
                               if value is not None})
        self.process = subprocess.Popen([PROGRAM, "__name:=task", "__ns:=threelink"],
                                        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                        universal_newlines=True)

    def end(self):
        """(exit status, output) of the node."""
        output, _ = self.process.communicate(timeout=20)
        return self.process.returncode, output

    def test_bad_parameters_are_refused(self):
        for changes, message in BAD_PARAMETERS:
            with self.subTest(changes):
                self.start(**changes)
                status, output = self.end()
                self.assertEqual(status, 2, output)
                self.assertIn(message, output)

    def test_without_a_simulator_it_says_so(self):
        self.start(start_timeout=0.3)
        status, output = self.end()
        self.assertEqual(status, 1)
        self.assertIn("no service /threelink/reset", output)

    def test_without_a_recorder_it_says_so(self):
        self.simulator.serve()
        self.start(record=True, start_timeout=1.0)
        status, output = self.end()
        self.assertEqual(status, 1)
        self.assertIn("no recorder is ready on /threelink/recording", output)
        self.assertEqual(self.simulator.resets, [])

    def test_a_refused_start_is_told(self):
        self.simulator.refusal = "no swimmer today"
        self.simulator.serve()
        self.start()
        status, output = self.end()
        self.assertEqual(status, 1)
        self.assertIn("no swimmer today", output)

    def test_starts_as_the_paper_says(self):
        self.simulator.serve()
        self.start(seed=4)
        self.assertTrue(wait(lambda: self.simulator.targets and self.simulator.episodes))
        (reset,) = self.simulator.resets
        self.assertEqual((reset.seed, reset.random_start), (4, False))
        self.assertEqual((tuple(reset.x_1), reset.theta_1, tuple(reset.alpha)), ((1, 0), 0, ()))
        (target,) = self.simulator.targets
        self.assertEqual((target.point.x, target.point.y), (1.5, 0.5))
        self.assertEqual(target.header.frame_id, "world")
        self.assertEqual(target.header.stamp, rospy.Time(self.simulator.stamp))
        (start,) = self.simulator.episodes
        self.assertEqual((start.status, start.seed, start.step), (Episode.STARTED, 4, 0))

    def test_a_silent_simulator_ends_the_episode(self):
        self.simulator.serve()
        self.start()
        status, output = self.end()
        self.assertEqual(status, 1)
        self.assertRegex(output, r"episode \d+: aborted \(no state 1 in 2\.\d s: the simulator is "
                                 r"silent\) after 0 steps")
        self.assertEqual(self.simulator.episodes[-1].status, Episode.ABORTED)

    def test_an_abort_of_the_simulator_ends_the_episode(self):
        self.simulator.serve()
        self.start()
        self.assertTrue(wait(lambda: self.simulator.targets))
        self.assertTrue(wait(lambda: self.simulator.aborts.get_num_connections()))
        for episode in (self.simulator.episode + 1, self.simulator.episode):
            self.simulator.aborts.publish(EpisodeAbort(
                episode=episode, step=0, peer="hinge_rates", reason="the agent sleeps"))
        status, output = self.end()
        self.assertEqual(status, 1)
        self.assertRegex(output, r"episode \d+: aborted \(the agent sleeps\) after 0 steps")

    def test_states_out_of_order_are_not_answered(self):
        self.simulator.serve()
        self.start()
        self.assertTrue(wait(lambda: self.simulator.targets))
        self.assertTrue(wait(lambda: self.simulator.states.get_num_connections()))
        send = lambda step: self.simulator.states.publish(self.simulator.state(step))
        send(0)  # a repetition
        send(2)
        self.simulator.episode += 1
        send(1)
        self.simulator.episode -= 1
        send(1)
        self.assertTrue(wait(lambda: len(self.simulator.targets) == 2))
        self.assertEqual(self.simulator.targets[1].header.stamp, rospy.Time(self.simulator.stamp))
        self.assertTrue(wait(
            lambda: self.simulator.diagnostics.get("state refused: out of order") == "2"))
        self.assertEqual(len(self.simulator.targets), 2)

    def test_a_failed_recording_does_not_stop_it(self):
        self.simulator.serve()
        self.start(record=True, max_steps=1)
        self.assertTrue(wait(lambda: self.recordings.get_num_connections()))
        self.recordings.publish(Recording(state=Recording.READY))
        self.assertTrue(wait(lambda: self.simulator.targets))
        self.assertTrue(wait(lambda: self.simulator.states.get_num_connections()))
        self.simulator.states.publish(self.simulator.state(1))
        self.assertTrue(wait(
            lambda: self.simulator.episodes[-1].status == Episode.TIMED_OUT))
        self.recordings.publish(Recording(state=Recording.FAILED, status="the disk is full",
                                          episode=self.simulator.episode))
        status, output = self.end()
        self.assertEqual(status, 0, output)
        self.assertRegex(output, r"episode \d+: not captured \(time-out after 1 steps\), t = 0\.1, "
                                 r"distance \S+, mean speed 0, no bag \(the disk is full\)")


if __name__ == "__main__":
    rospy.init_node("task_test", disable_signals=True)
    rostest.rosrun("threelink_tests", "task", TaskTest)
