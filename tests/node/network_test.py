#!/usr/bin/python3
"""Distributed training on two hosts, joined by a cable that is cut for a while."""
import os
import shutil
import subprocess
import time
import unittest

import rostest

import hosts
import skips  # noqa: F401, rosunit's results
from training_processes import TrainingTestCase, program
from waiting import wait


@unittest.skipIf(hosts.why_not(), hosts.why_not())
class NetworkTest(TrainingTestCase):
    @classmethod
    def setUpClass(cls):
        """No topics: they are elsewhere."""
        for heard in ("statuses", "batches", "leases", "workers", "policies"):
            setattr(cls, heard, [])

    def setUp(self):
        super().setUp()
        self.network = hosts.Hosts()
        self.network.__enter__()
        self.addCleanup(self.network.__exit__)
        self.addCleanup(lambda: [process.end() for process in self.processes])  # before that

    def on(self, host, command):
        return self.start(self.network.command(host, command))

    def node(self, kind, name, environment=None, **parameters):
        return self.on(0 if kind == "learner_node" else 1,
                       [program(kind), "__ns:=threelink", "__name:=" + name] +
                       ["_%s:=%s" % item for item in parameters.items()])

    def test_two_hosts_give_the_policy_of_one_process(self):
        expected = self.in_process()
        self.on(0, ["rosmaster", "--core", "-p", "11311"])
        learner = self.learner()
        for name in ("worker_1", "worker_2"):
            self.worker(name, step_cost=200)
        self.assertTrue(wait(lambda: self.rows() >= 10), self.output())
        self.network.cut()
        time.sleep(1)  # so long it is cut
        rows = self.rows()
        self.network.mend()
        self.assertTrue(wait(lambda: self.rows() >= rows + 5), self.output())
        self.finish(learner)
        self.assertLess(rows, 55)
        self.assertEqual(self.policy_of(), expected)

    @unittest.skipUnless(shutil.which("sshd", path="/usr/sbin"), "there is no sshd (openssh-server)")
    def test_roslaunch_starts_workers_over_ssh(self):
        expected = self.in_process()
        home = os.path.join(self.folder, "home")
        keys = os.path.join(home, ".ssh")
        os.makedirs(keys)
        for key in ("id_ed25519", "host"):
            subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f",
                            os.path.join(keys, key)], check=True)
        with open(os.path.join(keys, "host.pub")) as public:
            known = "%s %s" % (hosts.ADDRESSES[1], public.read())
        with open(os.path.join(keys, "known_hosts"), "w") as file:
            file.write(known)
        os.makedirs("/run/sshd", exist_ok=True)
        options = {"AuthorizedKeysFile": os.path.join(keys, "id_ed25519.pub"), "StrictModes": "no",
                   "PermitRootLogin": "yes", "PidFile": "none"}
        self.on(1, ["/usr/sbin/sshd", "-D", "-e", "-h", os.path.join(keys, "host")] +
                ["-o%s=%s" % option for option in options.items()])
        out = os.path.join(self.folder, "run")
        trainer = self.on(0, ["env", "HOME=" + home, "roslaunch", "threelink_tasks",
                              "train_cluster.launch", "hosts:=" + hosts.ADDRESSES[1],
                              "config:=" + self.config, "out:=" + out])
        self.finish(trainer, seconds=60)
        said = trainer.text()
        self.assertIn("[10.77.0.2-0]: process[threelink/on_10_77_0_2_2-1]: started", said)
        self.assertIn("workers of every machine that reaches 10.77.0.1 can connect", said)
        self.assertEqual(self.policy_of(), expected)


if __name__ == "__main__":
    rostest.rosrun("threelink_tests", "network", NetworkTest)
