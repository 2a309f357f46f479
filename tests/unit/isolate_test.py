#!/usr/bin/python3
"""`./threelink isolate`: a network of its own for a command, which knows nothing of it."""
import os
import signal
import subprocess
import sys
import tempfile
import unittest

import roslib.packages
import rosunit

FOLDER = os.path.dirname(os.path.realpath(__file__))
ROOT = os.path.realpath(os.path.join(FOLDER, "..", ".."))
sys.path.insert(0, os.path.join(FOLDER, "..", "node"))
import skips  # noqa: F401, E402, rosunit's results
from waiting import wait  # noqa: E402

ENTRY = os.path.join(ROOT, "threelink")
ISOLATE = ["/usr/bin/python3", os.path.join(ROOT, "scripts", "isolate.py")]
NOBODY = 65534


def run(command, **options):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True, timeout=60, **options)


def listeners(pid):
    """{inode: (address, port)} of the TCP sockets that wait for connections, as that process sees
    them."""
    found = {}
    for name in ("tcp", "tcp6"):
        with open("/proc/%s/net/%s" % (pid, name)) as file:
            for fields in map(str.split, list(file)[1:]):
                if fields[3] == "0A":
                    address, _, port = fields[1].partition(":")
                    found[int(fields[9])] = (address, int(port, 16))
    return found


class RefusalTest(unittest.TestCase):
    def test_wrong_arguments(self):
        for arguments, reason in (([], "needs a command"), (["build"], "does not take `build`"),
                                  (["isolate", "true"], "does not take `isolate`")):
            result = run([ENTRY, "isolate"] + arguments)
            self.assertEqual(result.returncode, 2)
            self.assertIn(reason, result.stderr)

    def test_a_kernel_that_does_not_allow_it(self):
        # In a user namespace of its own even an ordinary user may forbid network namespaces.
        forbid = "echo 0 > /proc/sys/user/max_net_namespaces && exec \"$@\""
        namespace = ["unshare", "--user", "--map-root-user", "sh", "-c", forbid, "sh"]
        if run(namespace + ["true"]).returncode != 0:
            self.skipTest("no user namespace can be made here")
        for command in (ISOLATE + ["true"], [ENTRY, "isolate", "pursuit"]):
            result = run(namespace + command)
            self.assertEqual(result.returncode, 2)
            self.assertIn("no network of its own can be made", result.stderr)
            self.assertEqual(result.stdout, "")


class IsolateTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        possible = run(ISOLATE + ["true"])
        if possible.returncode != 0:
            raise unittest.SkipTest(possible.stderr.strip())

    def start(self, command, **options):
        process = subprocess.Popen(ISOLATE + command, **options)

        def end():
            try:
                os.killpg(process.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
            process.wait()
        self.addCleanup(end)
        return process

    def test_ports_are_not_open_to_others(self):
        simulator = roslib.packages.find_node("threelink_sim", "simulator_node")[0]
        environment = dict(os.environ, ROS_MASTER_URI="http://127.0.0.1:11311", ROS_IP="127.0.0.1")
        environment.pop("ROS_HOSTNAME", None)
        graph = ("rosmaster --core -p 11311 & "
                 "until (exec 3<>/dev/tcp/127.0.0.1/11311) 2>/dev/null; do sleep 0.1; done; exec ")
        process = self.start(["bash", "-c", graph + simulator], env=environment,
                             start_new_session=True, stdout=subprocess.DEVNULL,
                             stderr=subprocess.DEVNULL)
        inside = {}

        def all_are_there():  # the master's port, and the node's for topics and for XML-RPC
            self.assertIsNone(process.poll(), "the simulator has ended")
            if os.path.samefile("/proc/%d/ns/net" % process.pid, "/proc/self/ns/net"):
                return False  # not yet in there
            inside.clear()
            inside.update(listeners(process.pid))
            return len(inside) >= 3
        self.assertTrue(wait(all_are_there, 60), inside)
        # The one of the node's XML-RPC server is on all addresses, which ROS_IP does not change.
        self.assertIn("00000000", [address for address, _ in inside.values()])
        self.assertIn(11311, [port for _, port in inside.values()])
        self.assertFalse(set(inside) & set(listeners("self")))
        shown = run(["ss", "-Hltnep"]).stdout
        self.assertNotIn("pid=%d," % process.pid, shown)
        for inode in inside:
            self.assertNotRegex(shown, r"\bino:%d\b" % inode)

    def test_nothing_but_the_loopback_is_there(self):
        seen = run(ISOLATE + ["ip", "-o", "address"]).stdout
        self.assertIn("127.0.0.1/8", seen)
        self.assertEqual({line.split()[1] for line in seen.splitlines()}, {"lo"})

    def test_status_and_streams_are_those_of_the_command(self):
        result = run(ISOLATE + ["sh", "-c", "cat; echo oops >&2; exit 7"], input="hello")
        self.assertEqual((result.returncode, result.stdout, result.stderr), (7, "hello", "oops\n"))
        self.assertEqual(run(ISOLATE + ["nowhere"]).returncode, 127)
        self.assertEqual(run(ISOLATE + ["/"]).returncode, 126)
        # Python ignores SIGPIPE; the command does not.
        self.assertIn("SigIgn:\t0000000000000000",
                      run(ISOLATE + ["cat", "/proc/self/status"]).stdout)

    def test_ctrl_c_reaches_the_command(self):
        process = self.start(["sleep", "60"], start_new_session=True)

        def sleeps():
            with open("/proc/%d/cmdline" % process.pid) as file:
                return file.read().startswith("sleep")
        self.assertTrue(wait(sleeps))
        os.killpg(process.pid, signal.SIGINT)
        self.assertEqual(process.wait(timeout=10), -signal.SIGINT)

    def test_an_ordinary_user_stays_one(self):
        def become_nobody():
            if os.geteuid() == 0:
                os.setgroups([])
                os.setgid(NOBODY)
                os.setuid(NOBODY)
        user = NOBODY if os.geteuid() == 0 else os.geteuid()
        with tempfile.TemporaryDirectory(prefix="threelink_") as folder:
            os.chmod(folder, 0o777)
            # The repository may lie where only root can read.
            program = os.path.join(folder, "isolate.py")
            with open(ISOLATE[1]) as source, open(program, "w") as copy:
                copy.write(source.read())
            os.chmod(program, 0o755)
            result = run(["/usr/bin/python3", program, "sh", "-c",
                          "touch made; id -u; grep CapEff /proc/self/status"],
                         preexec_fn=become_nobody, cwd=folder)
            if result.returncode == 2:
                self.skipTest(result.stderr.strip())
            self.assertEqual(result.stdout.split(), [str(user), "CapEff:", "0" * 16])
            self.assertEqual(os.stat(os.path.join(folder, "made")).st_uid, user)

    def test_the_entry_gives_its_environment(self):
        doctor = run([ENTRY, "doctor"]).stdout
        if "workspace     built" not in doctor:
            self.skipTest("the workspace is older than its sources, and would be built here")
        result = run([ENTRY, "isolate", "--", "sh", "-c",
                      "echo $ROS_MASTER_URI; rospack find threelink_sim; exit 7"],
                     env=dict(os.environ, ROS_MASTER_URI="http://192.0.2.1:11311"))
        self.assertEqual(result.returncode, 7, result.stderr)
        self.assertEqual(result.stdout.splitlines(),
                         ["http://127.0.0.1:11311", os.path.join(ROOT, "src", "threelink_sim")])


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "isolate", "__main__")
