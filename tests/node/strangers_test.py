#!/usr/bin/python3
"""Strangers on the graph: whatever they say, no node ends, starves or is deafened by it."""
import os
import signal
import time
import unittest
import xmlrpc.client

import rosgraph
import rosnode
import rospkg
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from std_msgs.msg import String
from threelink_msgs.msg import HingeRates, Observation, WorkerStatus
from threelink_msgs.srv import Reset

from strangers import GROUPS, NAMESPACE, claims, raw, said
from training_processes import Process, TrainingTestCase, program
from waiting import wait

POLICY = os.path.join(rospkg.RosPack().get_path("threelink_tasks"),
                      "config/policies/vfs.safetensors")
STRANGER = os.path.join(os.path.dirname(os.path.realpath(__file__)), "strangers.py")


def memory(process):
    """[MB] that it had at most."""
    with open("/proc/%d/status" % process.process.pid) as file:
        return next(int(line.split()[1]) / 1024 for line in file if line.startswith("VmHWM"))


class TrainingTest(TrainingTestCase):
    def test_a_training_among_strangers_ends_with_the_policy_of_one_process(self):
        expected = self.in_process()
        stranger = self.start(["/usr/bin/python3", STRANGER, "--count", "1000000", "training"])
        self.assertTrue(wait(lambda: said(stranger) > 0))
        workers = [self.worker("worker_%d" % i, step_cost=150) for i in (1, 2)]
        status = self.start([program("status")])
        learner = self.learner()
        before = said(stranger)
        self.finish(learner, seconds=60)
        self.assertGreater(said(stranger), before + 1000)
        self.assertEqual(self.policy_of(), expected)
        self.assertNotIn("set aside", self.output())
        for worker in workers:
            self.assertTrue(worker.running(), worker.text())
            begin = time.monotonic()
            self.assertEqual(worker.kill(signal.SIGINT), 0)
            self.assertLess(time.monotonic() - begin, 3)
        self.assertNotIn("\x1b", learner.text().replace("\x1b[0m", "").replace("\x1b[33m", "")
                         .replace("\x1b[31m", ""))
        self.assertTrue(wait(lambda: not status.running()))
        self.assertNotIn("\x07", status.text())

    def test_invented_workers_do_not_slow_the_learner_or_its_end(self):
        worker = self.worker("worker_1", step_cost=500)
        learner = self.learner()
        self.wait_for_update(2)
        names = rospy.Publisher("/threelink/workers", WorkerStatus, queue_size=10000)
        self.addCleanup(names.unregister)
        self.assertTrue(wait(lambda: names.get_num_connections() >= 2))  # this test listens, too
        true = self.workers[-1]
        for i in range(5000):
            names.publish(WorkerStatus(name="/invented/%d" % i, instance=i + 1, host="h",
                                       protocol=true.protocol, fingerprint=true.fingerprint))
        before = self.updates()
        self.wait_for_update(before + 5, 20)
        self.assertLess(len(self.statuses[-1].worker_reports), 10)
        self.assertTrue(wait(lambda: int(self.diagnostics.get(
            "workers refused: another node", "0")) >= 1000), self.diagnostics)
        begin = time.monotonic()
        self.assertEqual(learner.kill(signal.SIGINT), 0)
        self.assertLess(time.monotonic() - begin, 2)
        self.assertTrue(worker.running())


class NodeTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.diagnostics = {}
        cls.subscriber = rospy.Subscriber("/diagnostics", DiagnosticArray, cls.on_diagnostics)

    @classmethod
    def tearDownClass(cls):
        cls.subscriber.unregister()

    @classmethod
    def on_diagnostics(cls, message):
        for status in message.status:
            cls.diagnostics[status.hardware_id] = {pair.key: pair.value for pair in status.values}

    def setUp(self):
        self.processes = []
        self.addCleanup(lambda: [process.end() for process in self.processes])

    def node(self, kind, name, package, **parameters):
        if rospy.has_param("/threelink/" + name):
            rospy.delete_param("/threelink/" + name)
        self.processes.append(Process([program(kind, package), "__ns:=threelink", "__name:=" + name] +
                                      ["_%s:=%s" % item for item in parameters.items()]))
        return self.processes[-1]

    def simulator(self, **parameters):
        simulator = self.node("simulator_node", "simulator", "threelink_sim", realtime_factor=0.0,
                              **parameters)
        rospy.wait_for_service("/threelink/reset", 20)
        return simulator

    def agent(self):
        return self.node("agent_node", "agent", "threelink_agent", policy=POLICY)

    def publisher(self, name, kind, connections=1):
        publisher = rospy.Publisher(NAMESPACE + name, kind, queue_size=100000, latch=False)
        self.addCleanup(publisher.unregister)
        if connections:
            self.assertTrue(wait(lambda: publisher.get_num_connections() >= connections))
        return publisher

    def test_claims_of_gigabytes_cost_nothing(self):
        self.diagnostics.clear()
        nodes = [self.simulator(), self.agent(),
                 self.node("worker_node", "worker_9", "threelink_agent"),
                 self.node("stroke_node", "stroke", "threelink_sim")]
        kinds = dict(GROUPS["training"], **GROUPS["loop"])
        for name in ("target", "hinge_rates", "episode", "observation", "state", "policy", "leases"):
            Raw = raw(kinds[name])
            publisher = self.publisher(name, Raw)
            def claim():
                for data in claims(kinds[name]):
                    message = Raw()
                    message.data = data
                    publisher.publish(message)
                return True
            refused = lambda: sum(int(values.get(name + " refused: malformed", "0"))
                                  for values in self.diagnostics.values())
            before = refused()
            self.assertTrue(wait(lambda: claim() and refused() > before), self.diagnostics)
        for node in nodes:
            self.assertTrue(node.running(), node.text())
            self.assertLess(memory(node), 300)
        for node in nodes:
            begin = time.monotonic()
            self.assertEqual(node.kill(signal.SIGINT), 0, node.text())
            self.assertLess(time.monotonic() - begin, 3)

    def test_a_publisher_of_another_type_is_named(self):
        stranger = rospy.Publisher("/threelink/hinge_rates", String, queue_size=1)
        self.addCleanup(stranger.unregister)
        begin = time.monotonic()
        simulator = self.simulator(peer_timeout=6.0)
        said = ("%s publishes /threelink/hinge_rates as std_msgs/String (md5sum %s), and this node "
                "takes threelink_msgs/HingeRates (md5sum %s)" %
                (rospy.get_name(), String._md5sum, HingeRates._md5sum))
        self.assertTrue(wait(lambda: said in simulator.text(), 10), simulator.text())
        self.assertLess(time.monotonic() - begin, 10)
        self.assertEqual(simulator.text().count(said), 1)

    def test_a_node_that_is_shut_down_from_outside_says_so(self):
        for node in (self.simulator(), self.agent()):
            name = "/threelink/simulator" if node is self.processes[0] else "/threelink/agent"
            self.assertTrue(wait(lambda: rosgraph.Master("/test").lookupNode(name)))
            uri = rosnode.get_api_uri(rosgraph.Master("/test"), name)
            xmlrpc.client.ServerProxy(uri).shutdown("/stranger", "because")
            self.assertEqual(node.process.wait(timeout=10), 76, node.text())
            self.assertIn("shut down from outside", node.text())

    def test_refusals_do_not_fill_the_log(self):
        agent = self.agent()
        observations = self.publisher("observation", Observation)
        for i in range(5000):
            observations.publish(Observation(kind="kind %d" % i))
            observations.publish(Observation(kind="direction", values=[0.5] * (5 + i % 40)))
            observations.publish(Observation(kind="direction", values=[1e7 + i] * 4))
        refused = lambda: sum(int(value) for key, value in
                              self.diagnostics.get("threelink_agent", {}).items()
                              if key.startswith("observation refused"))
        self.assertTrue(wait(lambda: refused() > 5000), self.diagnostics)
        self.assertLess(len(agent.text()), 5000)

    def test_another_node_cannot_take_an_announced_episode_over(self):
        simulator = self.simulator()
        self.agent()
        task = self.node("task_node", "task", "threelink_tasks", task="pursuit", policy=POLICY,
                         v_ratio=3.0, record="false", max_steps=100000000)
        self.assertTrue(wait(lambda: int(self.diagnostics.get("threelink_task", {}).get(
            "step", "0")) > 100), self.diagnostics)
        answer = rospy.ServiceProxy("/threelink/reset", Reset)(seed=1)
        self.assertFalse(answer.success)
        self.assertIn("/threelink/task runs", answer.status)
        stranger = Process(["/usr/bin/python3", STRANGER, "--count", "500", "loop"])
        self.processes.append(stranger)
        self.assertTrue(wait(lambda: not stranger.running(), 60))
        self.assertGreater(said(stranger), 3000)
        step = lambda: int(self.diagnostics["threelink_task"]["step"])
        before = step()
        self.assertTrue(wait(lambda: step() > before), task.text())
        begin = time.monotonic()
        self.assertEqual(task.kill(signal.SIGTERM), 0, task.text())
        self.assertLess(time.monotonic() - begin, 4)
        self.assertTrue(simulator.running())


if __name__ == "__main__":
    rospy.init_node("strangers_test", disable_signals=True)
    rostest.rosrun("threelink_tests", "strangers", "__main__")
