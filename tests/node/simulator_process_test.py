#!/usr/bin/python3
"""The simulator node as a process: parameters, signals, the master, silent and late peers."""
import os
import signal
import socket
import subprocess
import time
import unittest

import rosgraph
import roslib.packages
import rospy
import rostest
import yaml
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PointStamped
from rosgraph_msgs.msg import Clock

from threelink_msgs.msg import EpisodeAbort, HingeRates, Observation, SwimmerState
from threelink_msgs.srv import Reset

from waiting import wait

NODE = "/threelink/simulator"
PROGRAM = roslib.packages.find_node("threelink_sim", "simulator_node")[0]

# YAML of one parameter, and what the error must say. Each for a reason of its own.
BAD_PARAMETERS = [
    ("links: 1", "links = 1 (int): must be in [2, 32]"),
    ("links: 33", "links = 33 (int): must be in [2, 32]"),
    ("links: 3.0", "links = 3 (double): must be a whole number"),
    ("links: three", 'links = "three" (string): must be a whole number'),
    ("gamma: 0.0", "gamma = 0 (double)"),
    ("gamma: -0.5", "gamma = -0.5 (double)"),
    ("gamma: .nan", "gamma = nan (double): must be finite"),
    ("gamma: .inf", "gamma = inf (double): must be finite"),
    ("gamma: [0.5]", "gamma = a list: must be a number"),
    ("gamma: {x: 0.5}", "gamma = a dictionary: must be a number"),
    ("gamma: true", "gamma = true (bool): must be a number"),
    ("dt: 1e-3", 'dt = "1e-3" (string): must be a number; write 1.0e-3'),
    ('dt: "0.1"', 'dt = "0.1" (string): must be a number; write it without quotes'),
    ("dt: 0", "dt = 0 (int): must be in [0.001, 1]"),
    ("dt: 2.0", "dt = 2 (double): must be in [0.001, 1]"),
    ("joint_limit: 3.2", "joint_limit = 3.2 (double)"),
    ("reward_b: 0.0", "reward_b = 0 (double)"),
    ("reward_c: -1", "reward_c = -1 (int)"),
    ("length_scale: 0.0", "length_scale = 0 (double)"),
    ("time_scale: 1.0e+9", "time_scale = 1000000000 (double)"),
    ("realtime_factor: -1.0", "realtime_factor = -1 (double)"),
    ("realtime_factor: 1.0e+300", "realtime_factor = 1e+300 (double)"),
    ("peer_timeout: 0.0", "peer_timeout = 0 (double)"),
    ("watchdog_periods: 0.5", "watchdog_periods = 0.5 (double)"),
    ("display_rate: 0.0", "display_rate = 0 (double)"),
    ("observation: everything", 'observation = "everything" (string): must be one of: direction'),
    ("observation: 1", "observation = 1 (int): must be text"),
    ("lenght_scale: 2.0", "lenght_scale: no such parameter; the nearest one is " + NODE +
     "/length_scale"),
    ("realtime: 1.0", "realtime: no such parameter"),
]


def start(arguments=("__name:=simulator", "__ns:=threelink"), **environment):
    return subprocess.Popen([PROGRAM, *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                            universal_newlines=True, env=dict(os.environ, **environment))


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def registered(uri):
    try:
        return rosgraph.Master("/test", master_uri=uri).lookupNode(NODE)
    except (rosgraph.MasterException, OSError):
        return None


class Peers:
    """What the simulator says, and the means to answer it."""

    def __init__(self):
        self.states, self.observations, self.aborts, self.summaries = [], [], [], []
        self.topics = [
            rospy.Subscriber("/threelink/state", SwimmerState, self.on_state, tcp_nodelay=True),
            rospy.Subscriber("/threelink/observation", Observation, self.on_observation,
                             tcp_nodelay=True),
            rospy.Subscriber("/threelink/abort", EpisodeAbort, self.aborts.append),
            rospy.Subscriber("/diagnostics", DiagnosticArray, self.on_diagnostics)]
        self.target = rospy.Publisher("/threelink/target", PointStamped, queue_size=10,
                                      tcp_nodelay=True)
        self.rates = rospy.Publisher("/threelink/hinge_rates", HingeRates, queue_size=10,
                                     tcp_nodelay=True)
        self.aiming, self.answering = True, True

    def close(self):
        for topic in self.topics + [self.target, self.rates]:
            topic.unregister()

    def on_state(self, state):
        self.states.append((time.monotonic(), state))
        if self.aiming:
            target = PointStamped()
            target.header.stamp = state.header.stamp
            target.header.frame_id = "world"
            target.point.x = 5.0
            self.target.publish(target)

    def on_observation(self, observation):
        self.observations.append(observation)
        if self.answering:
            self.answer(observation)

    def answer(self, observation):
        rates = [0.5, -0.5] if observation.step % 2 else [-0.5, 0.5]
        self.rates.publish(HingeRates(episode=observation.episode, step=observation.step,
                                      rates=rates))

    def on_diagnostics(self, array):
        self.summaries += [(status.level, status.message) for status in array.status
                           if status.hardware_id == "threelink_simulator"]

    def connected(self):
        return (all(topic.get_num_connections() == 1 for topic in self.topics[:3]) and
                self.target.get_num_connections() == 1 and self.rates.get_num_connections() == 1)


class SimulatorProcessTest(unittest.TestCase):
    def setUp(self):
        self.processes, self.peers = [], None
        if rospy.has_param(NODE):
            rospy.delete_param(NODE)

    def tearDown(self):
        if self.peers:
            self.peers.close()
        for process in self.processes:
            if process.poll() is None:
                process.kill()
            process.communicate()

    def run_simulator(self, **parameters):
        rospy.set_param(NODE, parameters)
        self.processes.append(start())
        self.peers = Peers()
        rospy.wait_for_service("/threelink/reset", 10)
        self.assertTrue(wait(self.peers.connected))
        return self.processes[-1]

    def reset(self):
        response = rospy.ServiceProxy("/threelink/reset", Reset)(
            seed=0, random_start=False, x_1=[0, 0], theta_1=0, alpha=[])
        self.assertTrue(response.success, response.status)
        return response.state

    def assert_ends(self, process, status, text="", seconds=10.0):
        try:
            output, _ = process.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            self.fail("it did not end within %g s" % seconds)
        self.assertEqual(process.returncode, status, output)
        self.assertIn(text, output)

    def test_bad_parameters_are_named(self):
        processes = []
        for i, (text, _) in enumerate(BAD_PARAMETERS):
            name = "simulator_%d" % i
            rospy.set_param("/threelink/" + name, yaml.safe_load(text))
            processes.append(start(("__name:=" + name, "__ns:=threelink")))
        self.processes += processes
        for i, (process, (_, message)) in enumerate(zip(processes, BAD_PARAMETERS)):
            message = message.replace(NODE, "/threelink/simulator_%d" % i)
            self.assert_ends(process, 2, "/threelink/simulator_%d/%s" % (i, message), 30)

    def test_help_and_arguments(self):
        offline = {"ROS_MASTER_URI": "http://127.0.0.1:1"}
        for argument in ("--help", "-h"):
            self.processes.append(start([argument], **offline))
            self.assert_ends(self.processes[-1], 0, "~realtime_factor")
        self.processes.append(start(["--fast"], **offline))
        self.assert_ends(self.processes[-1], 2, "unknown argument `--fast`")

    def test_signals_end_it(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            process = self.run_simulator(realtime_factor=0.0)
            self.reset()
            self.assertTrue(wait(lambda: len(self.peers.states) > 50))
            process.send_signal(number)
            self.assert_ends(process, 0, seconds=5)
            self.peers.close()

    def test_second_clock_is_refused(self):
        clock = rospy.Publisher("/clock", Clock, queue_size=1)
        try:
            self.processes.append(start())
            self.assert_ends(self.processes[-1], 2,
                             "/clock is already published by " + rospy.get_name())
        finally:
            clock.unregister()

    def test_silent_peers_are_named(self):
        self.run_simulator(realtime_factor=0.0, peer_timeout=0.3)
        self.peers.aiming = self.peers.answering = False
        begun = time.monotonic()
        state = self.reset()
        self.assertTrue(wait(lambda: len(self.peers.aborts) == 1))
        self.assertGreater(time.monotonic() - begun, 0.3)
        abort = self.peers.aborts[0]
        self.assertEqual((abort.episode, abort.step, abort.peer), (state.episode, 0, "target"))
        self.assertEqual(abort.header.stamp, state.header.stamp)
        self.assertIn("the task is silent", abort.reason)
        self.assertTrue(wait(lambda: (DiagnosticStatus.ERROR, abort.reason)
                             in self.peers.summaries))

        self.peers.aiming = True
        self.reset()
        self.assertTrue(wait(lambda: len(self.peers.aborts) == 2))
        self.assertEqual(self.peers.aborts[1].peer, "hinge_rates")
        self.assertIn("the agent is silent", self.peers.aborts[1].reason)
        # After an abort a reset is all that it takes.
        self.peers.answering = True
        self.reset()
        self.assertTrue(wait(lambda: self.peers.states[-1][1].step > 20))

    def test_watchdog(self):
        period = 0.05  # [s] of wall time; an action lasts 0.1 s of simulation time
        self.run_simulator(realtime_factor=0.1 / period)
        self.reset()
        self.assertTrue(wait(lambda: self.peers.states[-1][1].step >= 10))
        # The pace: at least nine periods for nine steps.
        times = {state.step: at for at, state in self.peers.states}
        self.assertGreater(times[10] - times[1], 8.5 * period)

        self.peers.answering = False
        self.assertTrue(wait(lambda: (DiagnosticStatus.WARN,
                                      "watchdog: hinge rates are late, steps with zero rates")
                             in self.peers.summaries))
        tripped = self.peers.states[-1][1].step
        self.assertTrue(wait(lambda: self.peers.states[-1][1].step > tripped + 5))
        silent_since = max(step for step, rates in self.steps() if any(rates))
        times = {state.step: at for at, state in self.peers.states}
        # Time stands still for three actions of 0.1 s, then goes on with zero rates.
        self.assertGreater(times[silent_since + 1] - times[silent_since], 2.5 * 0.1)
        shapes = {tuple(state.alpha) for _, state in self.peers.states
                  if state.step >= silent_since}
        self.assertEqual(len(shapes), 1)

        self.peers.answering = True
        resumed = self.peers.states[-1][1].step
        self.assertTrue(wait(lambda: self.peers.states[-1][1].step > resumed + 10))
        self.assertTrue(all(any(rates) for step, rates in self.steps() if step > resumed + 3))
        # No step is left out, and each is one step of simulation time long.
        states = [state for _, state in self.peers.states if state.episode == 1]
        for before, after in zip(states, states[1:]):
            self.assertEqual(after.step, before.step + 1)
            self.assertEqual((after.header.stamp - before.header.stamp).to_nsec(), 100000000)

    def steps(self):
        return [(state.step, state.hinge_rates) for _, state in self.peers.states if state.step]

    def test_master_that_is_missing_or_goes_away(self):
        uri = "http://127.0.0.1:%d" % free_port()
        begun = time.monotonic()
        self.processes.append(start(ROS_MASTER_URI=uri))
        self.assert_ends(self.processes[-1], 75, "ROS_MASTER_URI=" + uri)
        self.assertLess(time.monotonic() - begun, 8)

        # As soon as they are known, when some of them are about to set a parameter.
        simulators = []
        for _ in range(6):
            port = free_port()
            uri = "http://127.0.0.1:%d" % port
            master = subprocess.Popen(["rosmaster", "--core", "-p", str(port)],
                                      stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            simulators.append((start(ROS_MASTER_URI=uri), uri))
            self.processes += [master, simulators[-1][0]]
            self.assertTrue(wait(lambda: registered(uri)))
            master.kill()
        for simulator, uri in simulators:
            self.assert_ends(simulator, 75, "the ROS master at " + uri)


if __name__ == "__main__":
    rospy.init_node("simulator_process_test", disable_signals=True)
    rostest.rosrun("threelink_tests", "simulator_process", SimulatorProcessTest)
