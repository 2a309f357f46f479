"""Everything that the recorder listens to, for its tests."""
import csv
import os
import shutil
import subprocess
import tempfile
import unittest

import roslib.packages
import rospy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PointStamped, PoseStamped
from sensor_msgs.msg import JointState
from tf2_msgs.msg import TFMessage

from threelink_msgs.msg import (Episode, EpisodeAbort, HingeRates, Observation, Recording,
                                SwimmerState)

from waiting import wait

PROGRAM = roslib.packages.find_node("threelink_tasks", "recorder_node")[0]
NODE = "/threelink/recorder"


class Peers:
    """Everything that the recorder listens to, and what it answers."""

    def __init__(self):
        self.recordings, self.summaries = [], []
        self.stamp = 0
        publish = lambda name, kind: rospy.Publisher(name, kind, queue_size=1000)
        self.state = publish("/threelink/state", SwimmerState)
        self.target = publish("/threelink/target", PointStamped)
        self.observation = publish("/threelink/observation", Observation)
        self.rates = publish("/threelink/hinge_rates", HingeRates)
        self.joints = publish("/threelink/joint_states", JointState)
        self.pose = publish("/threelink/pose", PoseStamped)
        self.transforms = publish("/tf", TFMessage)
        self.abort = publish("/threelink/abort", EpisodeAbort)
        self.episode = rospy.Publisher("/threelink/episode", Episode, queue_size=10, latch=True)
        self.topics = [
            rospy.Subscriber("/threelink/recording", Recording, self.recordings.append),
            rospy.Subscriber("/diagnostics", DiagnosticArray, self.on_diagnostics)]

    def on_diagnostics(self, message):
        for status in message.status:
            if status.name.startswith(NODE[1:]) or status.name.startswith(NODE):
                self.summaries.append((ord(status.level) if isinstance(status.level, bytes)
                                       else status.level, status.message))

    def send_state(self, episode, step):
        self.stamp += 1
        state = SwimmerState(episode=episode, step=step, theta=[0, 0, 0], alpha=[0, 0])
        state.header.stamp = rospy.Time(self.stamp)
        self.state.publish(state)

    def send_episode(self, episode, step, status):
        message = Episode(episode=episode, step=step, status=status, task="pursuit", seed=9,
                          policy_sha256="ab" * 32)
        message.header.stamp = rospy.Time(self.stamp)
        self.episode.publish(message)

    def said(self, state, episode):
        return next((recording for recording in self.recordings
                     if (recording.state, recording.episode) == (state, episode)), None)


class RecorderCase(unittest.TestCase):
    """A recorder, its folder, and its peers."""

    @classmethod
    def setUpClass(cls):
        cls.peers = Peers()

    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.processes = []
        self.peers.recordings.clear()
        self.peers.summaries.clear()
        self.peers.stamp += 100  # simulation time never goes back

    def tearDown(self):
        for process in self.processes:
            process.kill()
            process.communicate()
        self.peers.send_episode(0, 0, Episode.ABORTED)  # what the next recorder hears first
        shutil.rmtree(self.folder)

    def start(self, folder=None, limit=None, **parameters):
        rospy.set_param(NODE, {"bag_dir": folder or self.folder, "picture": False, "min_free_mb": 0,
                               **parameters})
        process = subprocess.Popen([PROGRAM, "__name:=recorder", "__ns:=threelink"],
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   universal_newlines=True, preexec_fn=limit, restore_signals=False)
        self.processes.append(process)
        return process

    def start_and_wait(self, **options):
        process = self.start(**options)
        self.assertTrue(wait(lambda: self.peers.said(Recording.READY, 0)))
        return process

    def active(self):
        return [name for name in self.files() if name.endswith(".active")]

    def files(self):
        return sorted(os.listdir(self.folder))

    def rows(self):
        with open(os.path.join(self.folder, "episodes.csv")) as file:
            return list(csv.DictReader(file))

    def play_to_the_end(self, episode, steps):
        """The path of the bag of a whole episode."""
        self.play(episode, steps)
        self.assertTrue(wait(lambda: self.peers.said(Recording.WRITTEN, episode)))
        return self.peers.said(Recording.WRITTEN, episode).bag

    def play(self, episode, steps, status=Episode.CAPTURED):
        """An episode with the given states."""
        self.peers.send_state(episode, steps[0])
        self.peers.send_episode(episode, steps[0], Episode.STARTED)
        for step in steps[1:]:
            self.peers.send_state(episode, step)
        if status is not None:
            self.peers.send_episode(episode, steps[-1], status)
