#!/usr/bin/python3
"""How soon faults are noticed and what is left of them: F7, F9, F10 and F11 of docs/reliability.md.

  source devel/setup.bash && tests/benchmark/fault_benchmark.py [--runs 50]

Exit status: 0 if each of them went as promised, every time.
"""
import argparse
import glob
import os
import signal
import subprocess
import sys
import tempfile
import time

import rosgraph
import rospkg
import rospy
from std_msgs.msg import String
from threelink_msgs.msg import SwimmerState

from training_runs import Here, Run, table
from training_processes import program, small_config
from waiting import wait

POLICY = os.path.join(rospkg.RosPack().get_path("threelink_tasks"),
                      "config/policies/vfs.safetensors")
LOOP = "/loop"  # and not that of the training, of which the agent would take the policies
PERIOD = 0.1  # [s] of one action, in real time
AGENT, SIM, TASKS = "threelink_agent", "threelink_sim", "threelink_tasks"


class Graph(Run):
    """A master and nodes, with what the faults are done to."""

    def __init__(self, here, folder):
        self.folder = folder
        super().__init__(here, small_config(os.path.join(folder, "train.yaml"), 10000000),
                         os.path.join(folder, "run"))

    def add(self, package, kind, name, namespace=LOOP, **parameters):
        return self.start(0, [program(kind, package), "__ns:=" + namespace, "__name:=" + name] +
                          ["_%s:=%s" % item for item in parameters.items()])

    def loop(self, pace, **task):
        """A pursuit that nothing but a fault ends; its nodes by their names."""
        master = rosgraph.Master("/fault_benchmark", master_uri=self.hosts.uri)
        self.needs(master.is_online, "the master is up")
        simulator = self.add(SIM, "simulator_node", "simulator", realtime_factor=pace)
        self.needs(lambda: master.hasParam(LOOP + "/simulator/dt"), "the simulator has parameters")
        return {
            "simulator": simulator,
            "agent": self.add(AGENT, "agent_node", "agent", policy=POLICY),
            "task": self.add(TASKS, "task_node", "task", task="pursuit", policy=POLICY, v_ratio=3.0,
                             max_steps=100000000, **task)}

    def training(self):
        nodes = {name: self.worker(name, 100) for name in ("worker_1", "worker_2")}
        nodes["learner"] = self.learner()
        self.wait(lambda: len(self.rows()) > 2, 60)
        return nodes

    def settings(self):
        return {"config": self.config, "out": self.out, "resume": "true", "plot": "false"}

    def clear(self):
        """Ends all but the master."""
        for process in self.processes[1:]:
            if process.running():
                process.kill(signal.SIGINT)  # so that the master forgets it
            process.end()
        del self.processes[1:]

    def needs(self, condition, what, seconds=20):
        if not wait(condition, seconds):
            sys.exit("%s: not within %g s; what was said:\n%s"
                     % (what, seconds, "\n".join(each.text() for each in self.processes)))


class Frozen:
    """F7: the agent is stopped in mid-episode and goes on later."""

    head = ["F7", "zero rates after", "steps left out", "leaps of an angle"]

    def __init__(self):
        self.states = []  # (when, state)
        rospy.Subscriber(LOOP + "/state", SwimmerState, tcp_nodelay=True,
                         callback=lambda state: self.states.append((time.monotonic(), state)))

    def moving(self, count=10):
        return (len(self.states) > count and
                all(any(state.hinge_rates) for _, state in self.states[-count:]))

    def run(self, graph, runs):
        agent = graph.loop(1, record="false")["agent"]
        latest = 0.0
        for _ in range(runs):
            graph.needs(self.moving, "the swimmer moves")
            stopped, begin = len(self.states), time.monotonic()
            agent.process.send_signal(signal.SIGSTOP)
            zeros = lambda: [at for at, state in self.states[stopped:] if not any(state.hinge_rates)]
            graph.needs(lambda: len(zeros()) >= 3, "the watchdog trips")
            latest = max(latest, zeros()[0] - begin)
            agent.process.send_signal(signal.SIGCONT)
        graph.needs(self.moving, "the swimmer moves again")
        states = [state for _, state in self.states]
        pairs = list(zip(states, states[1:]))
        gaps = sum(b.step != a.step + 1 for a, b in pairs)
        leaps = sum(abs(y - x) > 0.1 + 1e-12 for a, b in pairs for x, y in zip(a.alpha, b.alpha))
        # Three periods of the watchdog, the rest of the one in which it was stopped, and one for noise.
        return (latest < 5 * PERIOD and not gaps and not leaps,
                ["%d stops" % runs, "%.1f periods at most" % (latest / PERIOD), gaps, leaps])


class LostMaster:
    """F9: the master is killed while a pursuit is recorded and two workers train."""

    head = ["F9", "all seven nodes ended after", "with status 75", "bags closed, each step proven",
            "trainings that went on"]

    def run(self, here, runs):
        longest, ended, proven, resumed = 0.0, 0, 0, 0
        for _ in range(runs):
            with tempfile.TemporaryDirectory() as folder, Graph(here, folder) as graph:
                bags = os.path.join(folder, "bags")
                nodes = {"recorder": graph.add(TASKS, "recorder_node", "recorder", bag_dir=bags),
                         **graph.loop(10), **graph.training()}
                graph.needs(lambda: glob.glob(bags + "/*.active"), "a bag is open")
                graph.master.kill()
                begin = time.monotonic()
                graph.needs(lambda: not any(node.running() for node in nodes.values()), "all end", 30)
                longest = max(longest, time.monotonic() - begin)
                ended += all(node.process.returncode == 75 for node in nodes.values())
                left = glob.glob(bags + "/*.bag*")
                proven += len(left) == 1 and self.steps_are_proven(left[0])
                before = len(graph.rows())
                graph.start_master()
                graph.worker("worker_1", 100)
                graph.learner(resume="true")
                graph.needs(lambda: len(graph.rows()) > before + 2, "the training goes on")
                resumed += 1
        return (longest < 10 and ended == proven == resumed == runs,
                ["%d kills" % runs, "%.1f s at most" % longest, ended, proven, resumed])

    @staticmethod
    def steps_are_proven(bag):
        """Whether all that misses is the message that would end the episode: its node ended before."""
        found = subprocess.run([program("verify_bag", TASKS), bag], stdout=subprocess.PIPE,
                               universal_newlines=True).stdout
        return bag.endswith(".bag") and (found.startswith("OK") or (
            "replayed: the one that ends the episode" in found and "equal to the bit" in found))


class Second:
    """F10: a second simulator, learner and trainer."""

    head = ["F10", "the second simulator ended after", "learner", "trainer", "the first named"]

    def run(self, graph, runs):
        nodes = {**graph.loop(0, record="false"), **graph.training()}
        seconds, named = {"simulator": 0.0, "learner": 0.0, "trainer": 0.0}, 0
        for number in range(runs):
            config = ["--config", graph.config, "--out", graph.out, "--resume"]
            second = {
                "simulator": (lambda: graph.add(SIM, "simulator_node", "another_%d" % number),
                              LOOP + "/simulator"),
                "learner": (lambda: graph.add(AGENT, "learner_node", "another_%d" % number,
                                              **graph.settings()),
                            str(nodes["learner"].process.pid)),
                "trainer": (lambda: graph.start(0, [program("train"), *config]),
                            str(nodes["learner"].process.pid))}
            for kind, (start, first) in second.items():
                begin = time.monotonic()
                process = start()
                graph.needs(lambda: not process.running(), "the second %s ends" % kind)
                seconds[kind] = max(seconds[kind], time.monotonic() - begin)
                named += process.process.returncode != 0 and first in process.text()
        alive = all(node.running() for node in nodes.values())
        return (alive and named == 3 * runs,
                ["%d times each" % runs, *("%.1f s at most" % each for each in seconds.values()),
                 "%d of %d" % (named, 3 * runs)])


class OtherType:
    """F11: who publishes a topic publishes text, where a node takes a message of another type."""

    TOPICS = {"simulator": "hinge_rates", "agent": "observation", "stroke": "state",
              "learner": "episodes", "worker": "leases"}
    head = ["F11"] + ["the %s names that of %s after" % item for item in TOPICS.items()]

    def run(self, graph, runs):
        strangers = [rospy.Publisher("/%s_alone/%s" % item, String, queue_size=1)
                     for item in self.TOPICS.items()]
        longest = dict.fromkeys(self.TOPICS, 0.0)
        for _ in range(runs):
            begin = time.monotonic()
            add = lambda kind, package, **parameters: graph.add(
                package, kind + "_node", kind, kind + "_alone", **parameters)
            nodes = {"simulator": add("simulator", SIM), "agent": add("agent", AGENT, policy=POLICY),
                     "stroke": add("stroke", SIM),
                     "learner": add("learner", AGENT, **graph.settings()),
                     "worker": add("worker", AGENT)}
            for kind, topic in self.TOPICS.items():
                said = "%s publishes /%s_alone/%s as std_msgs/String (md5sum %s)" % (
                    rospy.get_name(), kind, topic, String._md5sum)
                graph.needs(lambda: said in nodes[kind].text(), "the %s names it" % kind)
                longest[kind] = max(longest[kind], time.monotonic() - begin)
            for node in nodes.values():
                node.kill(signal.SIGINT)  # so that the master forgets it
        for stranger in strangers:
            stranger.unregister()
        return (max(longest.values()) < 10,
                ["%d times each" % runs, *("%.1f s at most" % each for each in longest.values())])


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=50, help="of F7; a fifth of it of the others (50)")
    options = parser.parse_args()
    fine, few = True, max(1, options.runs // 5)

    def tell(fault, *arguments):
        nonlocal fine
        went, row = fault.run(*arguments)
        table(fault.head, [row])
        print(flush=True)
        fine = fine and went

    with Here() as here, tempfile.TemporaryDirectory() as folder, Graph(here, folder) as graph:
        os.environ.update(ROS_MASTER_URI=here.uri, ROS_IP="127.0.0.1")
        os.environ.pop("ROS_HOSTNAME", None)
        graph.needs(rosgraph.is_master_online, "the master is up")
        rospy.init_node("fault_benchmark", disable_signals=True, log_level=rospy.FATAL)
        for fault, runs in ((Frozen(), options.runs), (Second(), few), (OtherType(), few)):
            tell(fault, graph, runs)
            graph.clear()
    with Here() as here:
        tell(LostMaster(), here, few)
    return 0 if fine else 1


if __name__ == "__main__":
    sys.exit(main())
