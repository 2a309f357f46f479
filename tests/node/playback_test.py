#!/usr/bin/python3
"""A recorded episode in rviz (in a loop, from any start, no tf warnings) and as a picture."""
import os
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

import rosbag
import roslib.packages
import rosnode
import rospy
import rostest
from nav_msgs.msg import Path
from rosgraph_msgs.msg import Clock

from waiting import wait

HERE = os.path.dirname(os.path.realpath(__file__))
LAUNCH = os.path.join(HERE, "../../scripts/launch.py")
STEPS = 400  # 40 s of simulation
LOOPS = int(os.environ.get("THREELINK_LOOPS", 3))
NODES = ["/threelink/play", "/threelink/playback", "/threelink/robot_state_publisher"]
# What tf2 has to complain about goes to standard error.
LISTENER = """
import rospy, tf2_ros
rospy.init_node("tf_listener")
buffer = tf2_ros.Buffer()
listener = tf2_ros.TransformListener(buffer)
rospy.spin()
"""


def launch(file, **arguments):
    return subprocess.Popen(["/usr/bin/python3", LAUNCH, *file, "rviz:=false"] +
                            ["%s:=%s" % item for item in arguments.items()],
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                            universal_newlines=True)


class PlaybackTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        episode = launch([os.path.join(HERE, "short_episode.launch")], bag_dir=cls.folder,
                         max_steps=STEPS)
        cls.output, _ = episode.communicate(timeout=60)
        bags = [name for name in os.listdir(cls.folder) if name.endswith(".bag")]
        cls.bag = os.path.join(cls.folder, bags[0]) if bags else None

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def setUp(self):
        self.assertIsNotNone(self.bag, self.output)
        with rosbag.Bag(self.bag) as bag:
            self.begin = bag.get_start_time()
        self.clock = []
        self.paths = {"swimmer_path": [], "target_path": []}  # stamps of all poses of each message
        self.processes = []
        add = lambda message, paths: paths.append([p.header.stamp.to_sec() for p in message.poses])
        self.topics = [rospy.Subscriber("/threelink/" + name, Path, add, paths)
                       for name, paths in self.paths.items()]
        self.topics.append(rospy.Subscriber(
            "/clock", Clock, lambda message: self.clock.append(message.clock.to_sec())))

    def tearDown(self):
        for topic in self.topics:
            topic.unregister()
        for process in self.processes:
            if process.poll() is None:
                self.end(process)

    def start(self, **arguments):
        process = launch(["threelink_tasks", "playback.launch"], bag=self.bag, **arguments)
        self.processes.append(process)
        return process

    def end(self, process):
        process.send_signal(signal.SIGINT)
        return process.communicate(timeout=20)[0]

    def passes(self):
        """The clock's times, split where it jumped back."""
        passes = []
        for now in list(self.clock):
            if not passes or now < passes[-1][-1]:
                passes.append([])
            passes[-1].append(now)
        return passes

    def ends(self, name):
        """The last stamp of a path in each pass that is over."""
        paths = list(self.paths[name])
        return [a[-1] for a, b in zip(paths, paths[1:]) if a and b and b[-1] < a[-1]]

    def test_loops_without_dead_nodes_and_tf_warnings(self):
        listener = subprocess.Popen(["/usr/bin/python3", "-c", LISTENER], stdout=subprocess.PIPE,
                                    stderr=subprocess.STDOUT, universal_newlines=True)
        self.processes.append(listener)
        process = self.start(rate=20, loop="true")
        begin = time.monotonic()
        self.assertTrue(wait(lambda: len(self.passes()) > LOOPS and
                             all(len(self.ends(name)) >= LOOPS for name in self.paths),
                             20 + 5 * LOOPS))
        self.assertGreater(time.monotonic() - begin, 1)
        for node in NODES:
            self.assertTrue(rosnode.rosnode_ping(node, max_count=1), node)
        # A trail never holds more than one pass, and each pass is shown nearly to its end.
        for name, paths in self.paths.items():
            for stamps in paths:
                self.assertEqual(stamps, sorted(set(stamps)), name)
            self.assertGreater(min(self.ends(name)), self.begin + 0.1 * STEPS - 6, name)
        output = self.end(process)
        self.assertNotRegex(output, "died|ERROR|Traceback|TF_")
        self.assertIsNone(listener.poll())
        listener.send_signal(signal.SIGINT)
        warnings = listener.communicate(timeout=20)[0]
        self.assertNotIn("TF_", warnings)

    def test_starts_anywhere_and_ends(self):
        process = self.start(rate=40, start=25)
        output, _ = process.communicate(timeout=40)
        self.assertEqual(process.returncode, 0, output)
        self.assertNotRegex(output, "died|ERROR|Traceback|TF_")
        for name, paths in self.paths.items():
            stamps = max(paths, key=len)
            self.assertGreater(len(stamps), 100, name)
            self.assertGreaterEqual(stamps[0], self.begin + 24.95, name)
            self.assertEqual(stamps, sorted(set(stamps)), name)

    def test_is_drawn_as_a_picture(self):
        program = roslib.packages.find_node("threelink_tasks", "plot_episode")[0]
        for ending, begin in (("png", b"\x89PNG\r\n"), ("pdf", b"%PDF")):
            picture = os.path.join(self.folder, "picture." + ending)
            subprocess.run([program, self.bag, "--out", picture], check=True, timeout=60)
            with open(picture, "rb") as file:
                content = file.read()
            self.assertTrue(content.startswith(begin))
            self.assertGreater(len(content), 20000)
        subprocess.run([program, self.bag, "--path", "--out", picture], check=True, timeout=60)
        text = os.path.join(self.folder, "text.bag")
        with open(text, "w") as file:
            file.write("no bag")
        for arguments in ((text,), ("/no/such.bag",), (), (self.bag, "--out", "/no/such/folder.png"),
                          (self.bag, "--out", os.path.join(self.folder, "picture.nothing"))):
            status = subprocess.run([program, *arguments], stderr=subprocess.DEVNULL, timeout=60)
            self.assertEqual(status.returncode, 2, arguments)


if __name__ == "__main__":
    rospy.init_node("playback_test", disable_signals=True)
    rostest.rosrun("threelink_tests", "playback", PlaybackTest)
