"""Learners and workers as processes, for the tests of distributed training."""
import os
import signal
import subprocess
import tempfile
import unittest

import roslib.packages
import rospy
import yaml
from diagnostic_msgs.msg import DiagnosticArray
from threelink_msgs.msg import EpisodeBatch, Leases, PolicyWeights, TrainingStatus, WorkerStatus

from waiting import wait

CONFIG = os.path.join(os.path.dirname(os.path.realpath(__file__)),
                      "..", "..", "config", "train_vfs.yaml")


def program(name, package="threelink_agent"):
    return roslib.packages.find_node(package, name)[0]


def write_config(path, **settings):
    """The shipped configuration with other settings; a__b is b in the section a."""
    with open(CONFIG) as file:
        config = yaml.safe_load(file)
    for name, value in settings.items():
        section, _, key = name.rpartition("__")
        part = config[section] if section else config
        assert key in part, name
        part[key] = value
    with open(path, "w") as file:
        yaml.safe_dump(config, file)
    return path


def small_config(path, episodes=600):
    """Ten episodes an update, of 50 steps, for small networks."""
    return write_config(path, episodes=episodes, evaluate_every=1000, hidden=[16, 16],
                        environment__steps=50, update__episodes=10, update__minibatch=250)


class Process:
    """A program whose output is kept."""

    def __init__(self, command, stdout=None, **environment):
        self.output = tempfile.TemporaryFile("w+")
        self.process = subprocess.Popen(command, stdout=stdout or self.output,
                                        stderr=subprocess.STDOUT if stdout is None else None,
                                        env={**os.environ, **environment})

    def running(self):
        return self.process.poll() is None

    def kill(self, number=signal.SIGKILL):
        self.process.send_signal(number)
        return self.process.wait(timeout=20)

    def end(self):
        if self.running():
            self.kill()
        self.output.close()

    def text(self):
        self.output.seek(0)
        return self.output.read()


class TrainingTestCase(unittest.TestCase):
    """Everything that is said on the topics, and a folder for the runs."""

    @classmethod
    def setUpClass(cls):
        cls.statuses, cls.diagnostics, cls.batches = [], {}, []
        cls.leases, cls.workers, cls.policies = [], [], []
        listen = lambda name, kind, heard: rospy.Subscriber("/threelink/" + name, kind, heard)
        cls.topics = [listen("training_status", TrainingStatus, cls.statuses.append),
                      listen("episodes", EpisodeBatch, cls.batches.append),
                      listen("leases", Leases, cls.leases.append),
                      listen("workers", WorkerStatus, cls.workers.append),
                      listen("policy", PolicyWeights, cls.policies.append),
                      rospy.Subscriber("/diagnostics", DiagnosticArray, cls.on_diagnostics)]

    @classmethod
    def on_diagnostics(cls, message):
        for status in message.status:
            if status.hardware_id == "threelink_learner":
                cls.diagnostics = {value.key: value.value for value in status.values}
                cls.diagnostics["message"] = status.message

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.processes = []
        self.addCleanup(lambda: [process.end() for process in self.processes])
        self.config = small_config(os.path.join(self.folder, "train.yaml"))
        for heard in (self.statuses, self.batches, self.leases, self.workers, self.policies):
            heard.clear()

    def start(self, command, **environment):
        self.processes.append(Process(command, **environment))
        return self.processes[-1]

    def node(self, kind, name, environment=None, package="threelink_agent", remap=(),
             **parameters):
        if rospy.has_param("/threelink/" + name):
            rospy.delete_param("/threelink/" + name)  # of the one before
        return self.start([program(kind, package), "__ns:=threelink", "__name:=" + name, *remap] +
                          ["_%s:=%s" % item for item in parameters.items()],
                          **(environment or {}))

    def learner(self, out="run", name="learner", environment=None, **parameters):
        given = {"config": self.config, "out": os.path.join(self.folder, out), "plot": "false"}
        return self.node("learner_node", name, environment, **{**given, **parameters})

    def worker(self, name, environment=None, step_cost=0, **parameters):
        return self.node("worker_node", name, environment, step_cost=float(step_cost),
                         **parameters)

    def policy_of(self, out="run"):
        with open(os.path.join(self.folder, out, "last.safetensors"), "rb") as file:
            return file.read()

    def in_process(self, *arguments):
        """The policy that `train` gives."""
        out = os.path.join(self.folder, "in_process")
        subprocess.run([program("train"), "--config", self.config, "--out", out, "--no-plot",
                        *arguments], check=True, stdout=subprocess.DEVNULL, timeout=60)
        return self.policy_of("in_process")

    def rows(self, out="run"):
        try:
            with open(os.path.join(self.folder, out, "metrics.csv")) as file:
                return len(file.readlines()) - 1
        except FileNotFoundError:
            return 0

    def updates(self):
        return self.statuses[-1].update if self.statuses else 0

    def wait_for_update(self, update, seconds=20):
        self.assertTrue(wait(lambda: self.updates() >= update, seconds),
                        "update %d of %d; %s" % (self.updates(), update, self.output()))

    def finish(self, learner, status=0, seconds=30):
        self.assertTrue(wait(lambda: not learner.running(), seconds), self.output())
        self.assertEqual(learner.process.returncode, status, self.output())

    def output(self):
        return "\n".join(process.text() for process in self.processes)
