#!/usr/bin/python3
"""The loop over topics as a worker: its episodes are those of one process, or are not handed in."""
import os
import signal
import sys

import rospy
import rostest
from threelink_msgs.msg import HingeRates

from toy_robot import ToyRobot
from training_processes import TrainingTestCase, small_config
from waiting import wait


class LiveTest(TrainingTestCase):
    def setUp(self):
        super().setUp()
        small_config(self.config, episodes=60)  # 3,000 steps

    def simulator(self, **parameters):
        """A simulator that goes as fast as it can, with times and tf of its own."""
        given = {"realtime_factor": 0.0, "peer_timeout": 1.0, "display_rate": 1.0}
        return self.node("simulator_node", "simulator", package="threelink_sim",
                         remap=["/clock:=clock", "/tf:=tf"], **{**given, **parameters})

    def agent(self, name="agent", **parameters):
        return self.node("agent_node", name, collect="true", **parameters)

    def test_the_loop_alone_gives_the_policy_of_one_process(self):
        expected = self.in_process()
        learner = self.learner()
        agent = self.agent()
        simulator = self.simulator(reward_c=3.0)  # another swimmer than the training's
        reason = "simulator/reward_c is 3, and must be 0"
        self.assertTrue(wait(lambda: reason in agent.text() and reason in learner.text()),
                        self.output())
        self.assertEqual(self.rows(), 0)
        simulator.kill()
        self.simulator()
        self.finish(learner)
        self.assertEqual(self.policy_of(), expected)
        self.assertEqual({status.name for status in self.workers}, {"/threelink/agent"})

    def test_beside_an_ordinary_worker(self):
        expected = self.in_process()
        self.simulator()
        self.agent()
        learner = self.learner()
        self.worker("worker_1", step_cost=300)  # about as fast
        self.finish(learner)
        self.assertEqual(self.policy_of(), expected)
        self.assertEqual(len({batch.worker for batch in self.batches if not batch.given_back}), 2)

    def test_the_simulator_is_killed_and_comes_back(self):
        expected = self.in_process()
        learner = self.learner()
        agent = self.agent()
        simulator = self.simulator()
        for _ in range(2):
            self.wait_for_update(self.updates() + 2)
            simulator.kill()
            self.assertTrue(wait(lambda: any(batch.given_back for batch in self.batches)),
                            self.output())
            self.batches.clear()
            simulator = self.simulator()
        self.finish(learner)
        self.assertEqual(self.policy_of(), expected)
        self.assertIn("goes back to the learner", agent.text())
        self.assertIn("gave lease", learner.text())

    def test_a_simulator_that_hangs_loses_its_episode(self):
        expected = self.in_process()
        learner = self.learner()
        agent = self.agent(reset_timeout=2.0)
        simulator = self.simulator(peer_timeout=0.1)
        self.wait_for_update(2)
        simulator.process.send_signal(signal.SIGSTOP)
        self.assertTrue(wait(lambda: "goes back to the learner" in agent.text()), self.output())
        simulator.process.send_signal(signal.SIGCONT)
        self.finish(learner)
        self.assertEqual(self.policy_of(), expected)

    def test_a_robot_needs_no_more_than_the_topics(self):
        robot = ToyRobot("/threelink/", start_error=0.02)
        self.addCleanup(robot.end)
        learner = self.learner(episodes=20, replay=0)
        agent = self.agent()
        self.assertTrue(wait(lambda: "alpha_1 at the start is" in agent.text()), self.output())
        agent.kill()
        agent = self.agent(exact="false", start_tolerance=0.01)
        self.assertTrue(wait(lambda: "must be within 0.01 of" in agent.text()), self.output())
        self.assertEqual(self.rows(), 0)
        agent.kill()
        agent = self.agent(exact="false")
        self.finish(learner)
        self.assertEqual(agent.text(), "")
        # It was shown the headings that the training asks for.
        self.assertNotEqual(self.policy_of(), self.in_process("--episodes", "20"))
        played = [batch for batch in self.batches if not batch.given_back]
        self.assertEqual(sum(batch.episodes for batch in played), 20)
        self.assertGreater(max(played[0].rewards), 0)

    def test_a_launch_with_loop_and_watchers_gives_the_policy_of_one_process(self):
        expected = self.in_process("--episodes", "300")
        watched = []
        topic = rospy.Subscriber("/threelink/watch/hinge_rates", HingeRates, watched.append)
        self.addCleanup(topic.unregister)
        launch = self.start(["roslaunch", "threelink_tasks", "train.launch", "workers:=0",
                             "live:=true", "watch:=true", "rviz:=false", "episodes:=300",
                             "config:=" + self.config, "out:=" + os.path.join(self.folder, "run")])
        self.finish(launch, seconds=60)
        self.assertEqual(self.policy_of(), expected)
        self.assertEqual({status.name for status in self.workers}, {"/threelink/live/agent"})
        self.assertGreater(len(watched), 0)
        self.assertEqual({len(rates.policy) for rates in watched}, {16})
        rospy.delete_param("/use_sim_time")


if __name__ == "__main__":
    rospy.init_node("live_test")
    rostest.rosrun("threelink_tests", "live", LiveTest, sys.argv)
