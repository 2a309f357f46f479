"""Two hosts on one machine: network namespaces, joined by a cable. Needs root and iproute2."""
import functools
import os
import signal
import subprocess

ADDRESSES = ("10.77.0.1", "10.77.0.2")


@functools.lru_cache(maxsize=None)
def why_not():
    """Why there can be no hosts here; empty if there can. Some machines, such as containers, let
    namespaces be made, but not be entered or joined: so two are made and used."""
    try:
        with Hosts() as hosts:
            hosts.run(0, ["true"])
    except FileNotFoundError as error:
        return "there is no `%s`" % error.filename
    except subprocess.CalledProcessError as error:
        return "`%s` is not allowed here: %s" % (" ".join(error.cmd), error.stdout.strip())
    return ""


def done(command):
    """Runs a command to its end; what it says is in the error if it fails."""
    subprocess.run(command, check=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                   universal_newlines=True)


class Hosts:
    """The master and the learner are on the first, at 10.77.0.1, workers on the second."""

    def __init__(self):
        self.names = ["threelink_%d_%s" % (os.getpid(), host) for host in ("a", "b")]
        self.devices = ["tl%s%d" % (host, os.getpid() % 10000000) for host in ("a", "b")]

    def __enter__(self):
        try:
            for name in self.names:
                done(["ip", "netns", "add", name])
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
            if not os.path.exists("/var/run/netns/" + name):
                continue
            found = subprocess.run(["ip", "netns", "pids", name], stdout=subprocess.PIPE)
            for pid in found.stdout.split():
                try:
                    os.kill(int(pid), signal.SIGKILL)
                except ProcessLookupError:
                    pass
            subprocess.run(["ip", "netns", "del", name])

    def lay_cable(self):
        a, b = self.devices
        done(["ip", "link", "add", a, "type", "veth", "peer", "name", b])
        for device, name in zip(self.devices, self.names):
            done(["ip", "link", "set", device, "netns", name])

    def command(self, host, command, **environment):
        """What runs a command on a host. `ip netns exec` would mount /sys anew, which is not allowed
        in every container; nsenter enters the network only."""
        environment = {"ROS_MASTER_URI": "http://%s:11311" % ADDRESSES[0],
                       "ROS_IP": ADDRESSES[host], **environment}
        return (["nsenter", "--net=/var/run/netns/" + self.names[host],
                 "env", "-u", "ROS_HOSTNAME"] +
                ["%s=%s" % item for item in environment.items()] + list(command))

    def run(self, host, command):
        done(self.command(host, command))

    def limit(self, rate):
        """Of both directions, such as 10mbit."""
        for host, device in enumerate(self.devices):
            self.run(host, ["tc", "qdisc", "replace", "dev", device, "root", "tbf", "rate", rate,
                            "burst", "64kb", "latency", "100ms"])

    def cut(self):
        self.run(0, ["ip", "link", "set", self.devices[0], "down"])

    def mend(self):
        self.run(0, ["ip", "link", "set", self.devices[0], "up"])
