#!/usr/bin/python3
"""launch.py ends completely and with 130, whenever Ctrl-C comes; its topics are bound to loopback."""
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

import rosgraph
import rosunit

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, os.path.join(HERE, "../node"))
from waiting import wait  # pylint: disable=wrong-import-position

LAUNCH = os.path.join(HERE, "../../scripts/launch.py")
MARKER = "THREELINK_LAUNCH_SIGNALS_TEST"


def free_port():
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


def read(path):
    try:
        with open(path, "rb") as file:
            return file.read()
    except OSError:
        return b""


def marked(value):
    """{process number: command line} of what was started for this test."""
    text = ("%s=%s\0" % (MARKER, value)).encode()
    found = {}
    for name in filter(str.isdigit, os.listdir("/proc")):
        command = read("/proc/%s/cmdline" % name)
        if command and text in read("/proc/%s/environ" % name):
            found[int(name)] = command.decode(errors="replace")
    return found


def listening(process):
    """[(address, port)] of the TCP sockets on which a process listens."""
    inodes = set()
    folder = "/proc/%d/fd" % process
    for name in os.listdir(folder):
        try:
            inodes.add(os.readlink(os.path.join(folder, name)))
        except OSError:
            pass  # closed meanwhile
    found = []
    for line in read("/proc/net/tcp").decode().splitlines()[1:]:
        fields = line.split()
        if fields[3] == "0A" and "socket:[%s]" % fields[9] in inodes:
            address, port = fields[1].split(":")
            found.append((socket.inet_ntoa(bytes.fromhex(address)[::-1]), int(port, 16)))
    return found


class LaunchSignalsTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        self.uri = "http://127.0.0.1:%d" % free_port()
        self.run = "%d_%d" % (os.getpid(), id(self))
        self.process = subprocess.Popen(
            ["/usr/bin/python3", LAUNCH, "threelink_tasks", "pursuit.launch", "rviz:=false",
             "v_ratio:=1", "bag_dir:=" + self.folder],
            env=dict(os.environ, ROS_MASTER_URI=self.uri, **{MARKER: self.run}),
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)

    def tearDown(self):
        for number in marked(self.run):  # of a test that failed
            os.kill(number, signal.SIGKILL)

    def started(self, name):
        return wait(lambda: any(name in command for command in marked(self.run).values()), 30)

    def catches(self, number):
        for line in read("/proc/%d/status" % self.process.pid).splitlines():
            if line.startswith(b"SigCgt:"):
                return bool(int(line.split()[1], 16) >> (number - 1) & 1)
        return False

    def end(self, number=signal.SIGINT):
        begin = time.monotonic()
        self.process.send_signal(number)
        output, _ = self.process.communicate(timeout=30)
        self.assertLess(time.monotonic() - begin, 10)
        self.assertEqual(self.process.returncode, 128 + number, output)
        self.assertNotIn("Traceback", output)
        self.assertEqual(marked(self.run), {})

    def test_while_it_imports(self):
        self.assertTrue(wait(lambda: self.catches(signal.SIGTERM)))  # which Python does not by itself
        self.end()

    def test_while_the_master_starts(self):
        self.assertTrue(self.started("rosmaster"))
        self.end()

    def test_while_nodes_start(self):
        self.assertTrue(self.started("simulator_node"))
        self.end(signal.SIGTERM)

    def test_when_the_first_bag_opens(self):
        self.assertTrue(wait(lambda: any(name.endswith(".active") for name in os.listdir(self.folder)),
                             60))
        self.check_ports()
        self.end()
        self.assertFalse([name for name in os.listdir(self.folder) if name.endswith(".active")])

    def check_ports(self):
        """Only roscpp's XML-RPC ports, which know nothing else, are on all addresses."""
        master = rosgraph.Master("/test", self.uri)
        for name in ("simulator", "agent", "task", "recorder"):
            port = int(master.lookupNode("/threelink/" + name).rstrip("/").rpartition(":")[2])
            (number,) = [number for number, command in marked(self.run).items()
                         if "/%s_node" % name in command]
            ports = listening(number)
            self.assertEqual([at for at in ports if at[1] == port], [("0.0.0.0", port)])
            others = [at for at in ports if at[1] != port]
            self.assertTrue(others)
            self.assertEqual({address for address, _ in others}, {"127.0.0.1"})


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "launch_signals", LaunchSignalsTest)
