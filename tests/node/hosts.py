"""Two hosts on one machine: network namespaces, joined by a cable. Needs root and iproute2."""
import os
import signal
import subprocess

ADDRESSES = ("10.77.0.1", "10.77.0.2")


def why_not():
    """Why there can be no hosts here; empty if there can."""
    name = "threelink_%d" % os.getpid()
    try:
        made = subprocess.run(["ip", "netns", "add", name], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, universal_newlines=True)
    except FileNotFoundError:
        return "there is no `ip` (package iproute2)"
    if made.returncode != 0:
        return "no network namespace can be made: " + made.stdout.strip()
    subprocess.run(["ip", "netns", "del", name], check=True)
    return ""


class Hosts:
    """The master and the learner are on the first, at 10.77.0.1, workers on the second."""

    def __init__(self):
        self.names = ["threelink_%d_%s" % (os.getpid(), host) for host in ("a", "b")]
        self.devices = ["tl%s%d" % (host, os.getpid() % 10000000) for host in ("a", "b")]

    def __enter__(self):
        for name in self.names:
            subprocess.run(["ip", "netns", "add", name], check=True)
        try:
            self.lay_cable()
            for host, (device, address) in enumerate(zip(self.devices, ADDRESSES)):
                self.run(host, ["ip", "link", "set", "lo", "up"])
                self.run(host, ["ip", "address", "add", address + "/24", "dev", device])
                self.run(host, ["ip", "link", "set", device, "up"])
        except Exception:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        """With everything that runs on them."""
        for name in self.names:
            found = subprocess.run(["ip", "netns", "pids", name], stdout=subprocess.PIPE)
            for pid in found.stdout.split():
                try:
                    os.kill(int(pid), signal.SIGKILL)
                except ProcessLookupError:
                    pass
            subprocess.run(["ip", "netns", "del", name])

    def lay_cable(self):
        a, b = self.devices
        subprocess.run(["ip", "link", "add", a, "type", "veth", "peer", "name", b], check=True)
        for device, name in zip(self.devices, self.names):
            subprocess.run(["ip", "link", "set", device, "netns", name], check=True)

    def command(self, host, command, **environment):
        """What runs a command on a host."""
        environment = {"ROS_MASTER_URI": "http://%s:11311" % ADDRESSES[0],
                       "ROS_IP": ADDRESSES[host], **environment}
        return (["ip", "netns", "exec", self.names[host], "env", "-u", "ROS_HOSTNAME"] +
                ["%s=%s" % item for item in environment.items()] + list(command))

    def run(self, host, command):
        subprocess.run(self.command(host, command), check=True)

    def limit(self, rate):
        """Of both directions, such as 10mbit."""
        for host, device in enumerate(self.devices):
            self.run(host, ["tc", "qdisc", "replace", "dev", device, "root", "tbf", "rate", rate,
                            "burst", "64kb", "latency", "100ms"])

    def cut(self):
        self.run(0, ["ip", "link", "set", self.devices[0], "down"])

    def mend(self):
        self.run(0, ["ip", "link", "set", self.devices[0], "up"])
