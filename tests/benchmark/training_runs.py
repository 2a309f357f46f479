"""Distributed trainings for the benchmarks, looked at through their metrics.csv alone."""
import csv
import hashlib
import os
import signal
import socket
import statistics
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "node"))
from training_processes import Process, program  # noqa: E402


signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # so that all is cleaned up


class Here:
    """This machine, all by loopback; stands where a hosts.Hosts can."""

    def __enter__(self):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.uri = "http://127.0.0.1:%d" % free.getsockname()[1]
        return self

    def __exit__(self, *_):
        pass

    def command(self, _host, command):
        return ["env", "-u", "ROS_HOSTNAME", "ROS_MASTER_URI=" + self.uri, "ROS_IP=127.0.0.1",
                *command]


class Run:
    """Master and learner on the first host, workers on the second; all end with the context."""

    def __init__(self, hosts, config, out):
        self.hosts, self.config, self.out = hosts, config, out
        self.processes = []

    def __enter__(self):
        self.start_master()
        return self

    def __exit__(self, *_):
        for process in reversed(self.processes):
            process.end()

    def start(self, host, command):
        logs = self.out + ".ros"
        self.processes.append(Process(self.hosts.command(host, command), ROS_HOME=logs))
        return self.processes[-1]

    def start_master(self):
        port = getattr(self.hosts, "uri", ":11311").rpartition(":")[2]
        self.master = self.start(0, ["rosmaster", "--core", "-p", port])

    def node(self, host, kind, name, parameters):
        return self.start(host, [program(kind), "__ns:=threelink", "__name:=" + name] +
                          ["_%s:=%s" % item for item in parameters.items()])

    def worker(self, name, step_cost=0):
        return self.node(1, "worker_node", name, {"step_cost": float(step_cost)})

    def learner(self, **parameters):
        self.started = self.node(0, "learner_node", "learner", {
            "config": self.config, "out": self.out, "plot": "false", **parameters})
        return self.started

    def rows(self):
        """The whole rows of metrics.csv: an update each."""
        try:
            with open(os.path.join(self.out, "metrics.csv")) as file:
                text = file.read()
        except FileNotFoundError:
            return []
        return list(csv.DictReader(text[:text.rfind("\n") + 1].splitlines()))

    def wait(self, condition, seconds):
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end or self.started.process.poll() not in (None, 0):
                sys.exit("this should have happened by now; what was said:\n" +
                         "\n".join(process.text() for process in self.processes))
            time.sleep(0.01)

    def finish(self, seconds=600):
        self.wait(lambda: not self.started.running(), seconds)


def sha256_of(out):
    with open(os.path.join(out, "last.safetensors"), "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


def in_process(config, out):
    """sha256 and rows of `train`."""
    subprocess.run([program("train"), "--config", config, "--out", out, "--no-plot"], check=True,
                   stdout=subprocess.DEVNULL)
    return sha256_of(out), Run(None, config, out).rows()


def median_speed(rows):
    """[steps/s] over the updates."""
    return statistics.median(float(row["steps_per_s"]) for row in rows)


def table(head, rows):
    print("| " + " | ".join(head) + " |\n" + "|---" * len(head) + "|")
    for row in rows:
        print("| " + " | ".join(map(str, row)) + " |", flush=True)
