#!/usr/bin/python3
"""Distributed training by real processes: whatever befalls them, the policy is that of one process."""
import os
import random
import signal
import socket
import subprocess
import sys
import time
import unittest
import xmlrpc.client

import rosgraph
import rosnode
import rospy
import rostest

import skips  # noqa: F401, rosunit's results
from training_processes import TrainingTestCase
from waiting import wait

KILLS = int(os.environ.get("THREELINK_KILLS", 5))
HAS_AVX2 = "avx2" in open("/proc/cpuinfo").read()
RUNS = int(os.environ.get("THREELINK_RUNS", 2))


def pid_of(node):
    uri = rosnode.get_api_uri(rosgraph.Master("/training_test"), node)
    return xmlrpc.client.ServerProxy(uri).getPid("/training_test")[2]


class TrainingTest(TrainingTestCase):
    def test_one_two_and_five_workers_give_the_policy_of_one_process(self):
        expected = self.in_process()
        rows = lambda run: [row.split(",")[:3]
                            for row in open(os.path.join(self.folder, run, "metrics.csv"))]
        names = []
        for count in (1, 2, 5):
            while len(names) < count:
                names.append("worker_%d" % len(names))
                self.worker(names[-1], step_cost=150, threads=1 + len(names) % 2)
            self.assertTrue(wait(lambda: len({status.name for status in self.workers}) == count))
            self.batches.clear()
            run = "with_%d" % count
            self.finish(self.learner(run))
            self.assertEqual(self.policy_of(run), expected)
            self.assertEqual(rows(run), rows("in_process"))
            self.assertEqual(len({batch.worker for batch in self.batches}), count)

    def test_workers_may_come_late_and_be_slow(self):
        expected = self.in_process()
        learner = self.learner()
        self.worker("slow", step_cost=20)
        self.wait_for_update(3)
        self.worker("late")
        self.finish(learner)
        self.assertEqual(self.policy_of(), expected)
        players = {batch.worker for batch in self.batches}
        self.assertEqual(len(players), 2)
        # The slow one is given less.
        last = self.batches[-20:]
        shares = [sum(batch.episodes for batch in last if batch.worker == player)
                  for player in players]
        self.assertLess(min(shares), 0.4 * sum(shares))

    @unittest.skipUnless(HAS_AVX2, "this processor has the baseline kernels only")
    def test_other_instructions_give_the_same_bits_or_are_refused(self):
        expected = self.in_process()
        baseline = self.worker("baseline", {"THREELINK_ISA": "baseline"})
        learner = self.learner()
        self.assertTrue(wait(lambda: "the learner refuses this worker: it computes other bits (base"
                             in baseline.text()), self.output())
        self.assertEqual(self.updates(), 0)
        self.assertTrue(wait(lambda: "refused" in self.diagnostics.get(
            "worker /threelink/baseline", "")))
        self.worker("avx2", {"THREELINK_ISA": "avx2"}, step_cost=10)
        self.worker("widest", step_cost=10)
        self.finish(learner)
        self.assertEqual(self.policy_of(), expected)
        self.assertEqual(len({batch.worker for batch in self.batches}), 2)

    def test_workers_are_killed_and_respawn(self):
        expected = self.in_process()
        moments = random.Random(0)
        learner = self.learner(lease_timeout=20.0)  # longer than the test may last
        workers = {name: self.worker(name, step_cost=50) for name in ("worker_1", "worker_2")}
        self.wait_for_update(2)
        for _ in range(3):
            name = moments.choice(sorted(workers))
            time.sleep(moments.uniform(0, 0.05))  # any moment will do
            workers[name].kill()
            before = self.updates()
            self.wait_for_update(before + 3)  # the other one goes on
            workers[name] = self.worker(name, step_cost=50)
            self.wait_for_update(self.updates() + 1)
        self.finish(learner)
        self.assertEqual(self.policy_of(), expected)
        for batch in self.batches:
            self.assertLessEqual(batch.episodes, 10)

    def test_the_learner_is_killed_and_resumes(self):
        expected = self.in_process()
        moments = random.Random(1)
        for name in ("worker_1", "worker_2"):
            self.worker(name, step_cost=10)
        learner = self.learner()
        for kill in range(KILLS):
            self.wait_for_update(self.updates() + 1)
            time.sleep(moments.uniform(0, 0.1))  # any moment will do
            if not learner.running():
                break
            learner.kill()
            self.statuses.clear()
            learner = self.learner(resume="true")
        self.finish(learner)
        self.assertGreater(kill, 1)
        self.assertEqual(self.policy_of(), expected)

    def test_whatever_happens_at_random(self):
        expected = self.in_process()
        instructions = [{}, {"THREELINK_ISA": "avx2"}] if HAS_AVX2 else [{}]
        for run in range(RUNS):
            with self.subTest(run=run):
                chance = random.Random(run)
                out = "run_%d" % run
                def worker(name):
                    return self.worker(name, chance.choice(instructions),
                                       step_cost=chance.choice([0, 10, 100]),
                                       threads=chance.choice([1, 2]))
                workers = {"worker_%d" % i: worker("worker_%d" % i)
                           for i in range(chance.randint(1, 5))}
                learner = self.learner(out, lease_timeout=chance.choice([0.1, 5.0]))
                for _ in range(chance.randint(2, 6)):
                    time.sleep(chance.uniform(0.05, 0.5))  # any moment will do
                    if not learner.running():
                        break
                    name = chance.choice(["learner", "late"] + sorted(workers))
                    if name == "learner":
                        learner.kill()
                        learner = self.learner(out, resume="true")
                    elif name == "late":
                        name = "late_%d" % len(workers)
                        workers[name] = worker(name)
                    else:
                        workers[name].kill()
                        workers[name] = worker(name)
                self.finish(learner)
                self.assertEqual(self.policy_of(out), expected)
                for process in workers.values():
                    process.kill()

    def test_a_worker_that_crashes_over_and_over_is_set_aside(self):
        expected = self.in_process()
        learner = self.learner()
        told = "set aside for 5 s: it started anew 5 times within 60 s"
        for _ in range(12):  # a lease of the killed one may arrive late, and count for the next one
            crashing = self.worker("crashing", step_cost=1e6)  # so that it never hands anything in
            self.assertTrue(wait(lambda: any(lease.leases for lease in self.leases)
                                 or told in learner.text()))
            if told in learner.text():
                break
            crashing.kill()
            self.leases.clear()
        self.assertTrue(wait(lambda: told in learner.text()), self.output())
        self.assertTrue(wait(lambda: "/threelink/crashing: set aside"
                             in self.diagnostics.get("message", "")))
        self.assertEqual(self.updates(), 0)
        crashing.kill()  # it would be let in again, and hold what it never plays
        self.worker("worker_1")
        self.finish(learner)
        self.assertEqual(self.policy_of(), expected)

    def test_without_a_worker_the_learner_says_so_and_ends(self):
        learner = self.learner(worker_timeout=1.0)
        self.finish(learner, status=1, seconds=10)
        self.assertIn("no worker for 1 s", learner.text())
        learner = self.learner(resume="true", worker_timeout=1.0)
        worker = self.worker("worker_1", step_cost=20)
        self.wait_for_update(3)
        worker.kill()
        self.finish(learner, status=1, seconds=10)
        self.worker("worker_1")
        self.finish(self.learner(resume="true"))
        self.assertEqual(self.policy_of(), self.in_process())

    def test_without_the_master_all_is_saved_and_ends(self):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = str(free.getsockname()[1])
        there = {"ROS_MASTER_URI": "http://127.0.0.1:" + port}
        begin = lambda step_cost: (self.start(["rosmaster", "--core", "-p", port]),
                                   self.worker("worker_1", there, step_cost=step_cost),
                                   self.learner(environment=there, resume="true"))
        master, worker, learner = begin(300)  # 9 s
        self.assertTrue(wait(lambda: self.rows() >= 3), self.output())
        master.kill()
        self.finish(learner, status=75, seconds=10)
        self.finish(worker, status=75, seconds=10)
        self.assertLess(self.rows(), 60)
        master, worker, learner = begin(0)
        self.finish(learner)
        self.assertEqual(self.policy_of(), self.in_process())

    def test_a_folder_has_one_learner(self):
        self.worker("worker_1", step_cost=100)
        learner = self.learner()
        self.wait_for_update(1)
        second = self.learner(name="second", resume="true")
        self.finish(second, status=2, seconds=5)
        self.assertIn(str(learner.process.pid), second.text())
        self.assertTrue(learner.running())

    def test_signals_leave_a_checkpoint(self):
        self.worker("worker_1", step_cost=50)
        for number in (signal.SIGINT, signal.SIGTERM):
            learner = self.learner(resume="true")
            self.wait_for_update(self.updates() + 3)
            self.assertEqual(learner.kill(number), 0, learner.text())
            self.assertIn("resume goes on from it", learner.text())
            self.statuses.clear()
        self.finish(self.learner(resume="true"))
        self.assertEqual(self.policy_of(), self.in_process())

    def test_bad_parameters_are_refused(self):
        for parameters, said in (({"threads": 0}, "threads"), ({"episodes": 0}, "episodes"),
                                 ({"backend": "fast"}, "backend"), ({"thread": 1}, "thread"),
                                 ({"config": "/nowhere.yaml"}, "/nowhere.yaml"),
                                 ({"out": self.folder}, "is not empty"),
                                 ({"worker_timeout": "soon"}, "worker_timeout")):
            with self.subTest(**parameters):
                learner = self.learner(**parameters)
                self.finish(learner, status=2, seconds=10)
                self.assertIn(said, learner.text())

    def test_the_policy_on_the_topic_is_the_one_that_is_played(self):
        learner = self.learner(episodes=30)
        self.worker("worker_1")
        self.finish(learner)
        self.assertEqual([policy.version for policy in self.policies], [0, 1, 2])
        self.assertEqual({lease.version for lease in self.leases if lease.leases}, {0, 1, 2})
        status = self.statuses[-1]
        self.assertEqual((status.update, status.updates, status.episodes, status.steps),
                         (3, 3, 30, 1500))
        self.assertEqual(status.workers, 1)

    def test_the_launches_survive_their_processes_and_end_by_themselves(self):
        expected = self.in_process()
        run = os.path.join(self.folder, "run")
        workers = self.start(["roslaunch", "threelink_tasks", "workers.launch", "workers:=2",
                              "step_cost:=20.0"])
        trainer = self.start(["roslaunch", "threelink_tasks", "train.launch", "workers:=0",
                              "config:=" + self.config, "out:=" + run])
        self.wait_for_update(3)
        # Unless opened to the network, only XML-RPC listens on all interfaces.
        listening = subprocess.run(["ss", "-Hltnp"], stdout=subprocess.PIPE,
                                   universal_newlines=True, check=True).stdout.splitlines()
        addresses = [line.split()[3].rpartition(":")[0] for line in listening
                     if "pid=%d," % pid_of("/threelink/learner") in line]
        self.assertEqual(sorted(addresses), ["0.0.0.0", "127.0.0.1"])
        os.kill(pid_of("/threelink/worker_2"), signal.SIGKILL)
        self.wait_for_update(self.updates() + 3)
        os.kill(pid_of("/threelink/learner"), signal.SIGKILL)
        self.finish(trainer, seconds=40)
        self.assertIn("it goes on from its last checkpoint", trainer.text())
        self.assertEqual(self.policy_of(), expected)
        self.assertTrue(os.path.exists(os.path.join(run, "learning_curve.png")))
        workers.kill(signal.SIGINT)


if __name__ == "__main__":
    rospy.init_node("training_test")
    rostest.rosrun("threelink_tests", "training", TrainingTest, sys.argv)
