#!/usr/bin/python3
"""Looking at a training (`status`), and driving one by the action `train`."""
import json
import os
import pty
import re
import signal
import socket
import struct
import sys

import actionlib
import roslib.packages
import rospy
import rostest
from actionlib_msgs.msg import GoalStatus
from threelink_msgs.msg import TrainAction, TrainGoal, TrainResult

from training_processes import TrainingTestCase, program
from waiting import wait


def sha256_of(policy):
    with open(policy, "rb") as file:
        return json.loads(file.read(struct.unpack("<Q", file.read(8))[0]))["__metadata__"]["sha256"]


class StatusTest(TrainingTestCase):
    def test_it_waits_shows_a_line_a_second_and_ends_with_the_training(self):
        status = self.start([program("status")])
        self.assertTrue(wait(lambda: "waiting for one" in status.text()))
        self.worker("worker_1", step_cost=50)  # 1.5 s
        self.finish(self.learner())
        self.finish(status, seconds=5)
        lines = status.text().splitlines()
        self.assertGreaterEqual(len(lines), 3)
        self.assertLessEqual(len(lines), 8)
        self.assertIn("/threelink/training_status", lines[0])
        self.assertRegex(lines[1], r"update \d+/60 .* 1 worker")
        self.assertRegex(lines[-1], r"^100 %  finished  update 60/60  600 episodes .* return ")

    def test_on_a_terminal_it_is_redrawn_in_place(self):
        master, slave = pty.openpty()
        self.worker("worker_1", step_cost=50)
        status = self.start([program("status"), "--namespace", "/threelink"], stdout=slave)
        os.close(slave)
        self.finish(self.learner())
        self.finish(status, seconds=5)
        shown = os.read(master, 100000).decode()
        os.close(master)
        self.assertRegex(shown, r"\x1b\[7A\r\x1b\[J\[#+\] 100 %  finished")
        host = re.escape(socket.gethostname())
        self.assertRegex(shown, r"worker_1 +%s +alive +600 +\d\.\d s +0 +0 +1" % host)

    def test_without_a_master_it_says_so(self):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = str(free.getsockname()[1])
        there = {"ROS_MASTER_URI": "http://127.0.0.1:" + port}
        master = self.start(["rosmaster", "--core", "-p", port])
        status = self.start([program("status")], **there)
        self.assertTrue(wait(lambda: "waiting for one" in status.text()))
        master.kill()
        self.finish(status, status=75, seconds=10)
        for arguments, said in ((["--namespace"], "--namespace"), (["--namespace", "a b"], "a b"),
                                (["more"], "more")):
            with self.subTest(arguments=arguments):
                wrong = self.start([program("status")] + arguments)
                self.finish(wrong, status=2, seconds=5)
                self.assertIn(said, wrong.text())


class TrainActionTest(TrainingTestCase):
    def setUp(self):
        super().setUp()
        self.server = self.node("training_server", "training_server", worker_timeout=1.0,
                                plot="false")
        self.client = actionlib.SimpleActionClient("/threelink/train", TrainAction)
        self.assertTrue(wait(lambda: self.client.wait_for_server(rospy.Duration(0.1))))

    def send(self, client=None, **goal):
        self.feedback = []
        goal = {"config": self.config, "out": os.path.join(self.folder, "run"), **goal}
        (client or self.client).send_goal(TrainGoal(**goal), feedback_cb=self.feedback.append)

    def result(self, state, client=None):
        client = client or self.client
        self.assertTrue(client.wait_for_result(rospy.Duration(30)), self.output())
        self.assertEqual(client.get_state(), state, client.get_goal_status_text())
        return client.get_result()

    def test_a_goal_gives_the_policy_of_train(self):
        self.send()
        result = self.result(GoalStatus.SUCCEEDED)
        feedback = self.feedback
        self.send(resume=True)  # at once: who has the result may go on
        self.assertEqual(self.result(GoalStatus.SUCCEEDED).sha256, result.sha256)
        self.assertEqual((result.outcome, result.reason), (TrainResult.FINISHED, ""))
        self.assertEqual(result.policy, os.path.join(self.folder, "run", "policy.safetensors"))
        self.assertEqual(result.sha256, sha256_of(result.policy))
        self.assertEqual(self.policy_of(), self.in_process())
        updates = [one.status.update for one in feedback]  # some may be dropped
        self.assertEqual(updates, sorted(set(updates)))
        self.assertGreater(len(updates), 5)
        self.assertEqual(feedback[-1].status.episodes, 10 * updates[-1])

    def test_a_cancelled_goal_can_be_resumed_with_other_hands(self):
        self.worker("worker_1", step_cost=150)  # 4 s
        self.send(workers=True)
        self.assertTrue(wait(lambda: self.feedback and self.feedback[-1].status.update >= 3),
                        self.output())
        self.client.cancel_goal()
        result = self.result(GoalStatus.PREEMPTED)
        self.assertEqual(result.outcome, TrainResult.CANCELLED)
        self.assertIn("resume goes on", result.reason)
        done = self.rows()
        self.assertLess(done, 60)
        self.send(config="", resume=True)
        self.assertEqual(self.result(GoalStatus.SUCCEEDED).outcome, TrainResult.FINISHED)
        self.assertEqual(self.feedback[0].status.update, done)
        self.assertEqual(self.policy_of(), self.in_process())

    def test_a_second_goal_is_rejected_and_the_first_goes_on(self):
        self.worker("worker_1", step_cost=30)  # 1 s
        self.send(workers=True)
        self.assertTrue(wait(lambda: self.feedback), self.output())
        second = actionlib.SimpleActionClient("/threelink/train", TrainAction)
        self.assertTrue(second.wait_for_server(rospy.Duration(5)))
        first_feedback = self.feedback
        self.send(second, out=os.path.join(self.folder, "second"))
        result = self.result(GoalStatus.REJECTED, second)
        self.assertEqual(result.outcome, TrainResult.REJECTED)
        self.assertIn(os.path.join(self.folder, "run") + " runs", result.reason)
        self.assertFalse(os.path.exists(os.path.join(self.folder, "second")))
        self.result(GoalStatus.SUCCEEDED)
        self.assertGreater(first_feedback[-1].status.update, 30)
        self.assertEqual(self.policy_of(), self.in_process())

    def test_bad_goals_are_rejected_with_the_reason(self):
        bad = os.path.join(self.folder, "bad.yaml")
        with open(self.config) as good, open(bad, "w") as file:
            file.write(good.read().replace("evaluate_every:", "evaluate_evry:"))
        secret = os.path.join(self.folder, "secret.yaml")
        with open(secret, "w") as file:
            file.write("secret: 1\n")
        for goal, said in (({"config": secret}, secret + ": holds a key that is not known"),
                           ({"config": "/dev/zero"}, "/dev/zero: not a file"),
                           ({"config": "/nowhere.yaml"}, "/nowhere.yaml"), ({"config": bad}, bad),
                           ({"config": ""}, "config is required"), ({"out": ""}, "out is required"),
                           ({"out": self.folder}, "is not empty"), ({"episodes": 2**31}, "episodes")):
            with self.subTest(**goal):
                self.send(**goal)
                result = self.result(GoalStatus.REJECTED)
                self.assertEqual(result.outcome, TrainResult.REJECTED)
                self.assertIn(said, result.reason)
                self.assertEqual(self.client.get_goal_status_text(), result.reason)
                self.assertNotIn("secret: ", result.reason.replace(secret + ": ", ""))
        self.assertFalse(os.path.exists(os.path.join(self.folder, "run")))
        self.send(workers=True)  # there is none
        result = self.result(GoalStatus.ABORTED)
        self.assertEqual(result.outcome, TrainResult.FAILED)
        self.assertIn("no worker for 1 s", result.reason)

    def test_the_example_trains_and_is_cancelled_by_a_signal(self):
        example = roslib.packages.find_node("threelink_agent", "train_client.py")[0]
        run = os.path.join(self.folder, "run")
        call = [example, "--config", self.config, "--out", run]
        client = self.start(call + ["--seed=-1"])
        self.finish(client, status=2)
        self.assertIn("--seed: -1 is not within 0 .. 2147483647", client.text())
        self.worker("worker_1", step_cost=150)
        client = self.start(call + ["--workers"])
        self.assertTrue(wait(lambda: "update 3/60" in client.text()), self.output())
        self.assertEqual(client.kill(signal.SIGINT), 1)
        self.assertIn("cancelled; a checkpoint is in " + run, client.text())
        client = self.start(call + ["--resume"])
        self.finish(client)
        self.assertIn("policy.safetensors sha256 " + sha256_of(run + "/policy.safetensors"),
                      client.text())
        self.assertEqual(self.policy_of(), self.in_process())


if __name__ == "__main__":
    rospy.init_node("training_tools_test", disable_signals=True)
    rostest.rosrun("threelink_tests", "training_tools", "__main__", sys.argv)
