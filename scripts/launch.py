#!/usr/bin/python3
"""roslaunch with an exit status: launch.py [PACKAGE] FILE [NAME:=VALUE ...]

roslaunch itself ends with 0 whatever happens, takes misspelt arguments and drops empty ones without a
word, and may hang, or leave nodes behind, if a signal comes while it starts them. Here the status is
  0    a required node has ended the launch with 0, and nothing but that
  2    wrong arguments, or a node that refused its parameters with 2: a required one, or one that
       would be started anew for ever
  75   the ROS master that this launch started is gone
  128 + the signal's number after SIGINT, SIGTERM or SIGHUP; everything is down within 10 s
  else that of the required node that ended the launch (128 + the number of the signal that killed
       it), or 1 if the launch failed
On the screen is what the nodes and errors say; what roslaunch says about itself is in its log file.
"""
import os
import signal
import sys

SIGNALS = [signal.SIGINT, signal.SIGTERM]
if signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:  # as nohup wants it
    SIGNALS.append(signal.SIGHUP)
for number in SIGNALS:  # while the modules are imported there is nothing to clean up
    signal.signal(number, lambda number, frame: os._exit(128 + number))

# pylint: disable=wrong-import-position
import ast
import contextlib
import re
import subprocess
import threading
import time

import roslaunch
import roslaunch.arg_dump
import roslaunch.nodeprocess
import roslib
from roslaunch.config import load_config_default
from roslaunch.parent import ROSLaunchParent
from roslaunch.pmon import ProcessListener, start_process_monitor

from processes import end_children

# [s] Nodes get SIGINT, then SIGTERM, then SIGKILL; roslaunch's own patience is 15 s and 2 s.
SIGINT_TIMEOUT, SIGTERM_TIMEOUT = 2.5, 1.0
SHUTDOWN_TIMEOUT = 8.0  # [s] for roslaunch to do that; what it leaves is killed

SUCCESS, FAILURE, MISUSE, MASTER_LOST = 0, 1, 2, 75


class WrongArgument(Exception):
    pass


class EndOfLaunch(ProcessListener):
    """Ends the launch with the exit status of the first node whose end is that of the launch."""

    def __init__(self, monitor, config):
        self.monitor = monitor
        self.status = None
        name = lambda node: (node.namespace + node.name).lstrip("/")
        self.required = {name(node) for node in config.nodes if node.required}
        self.respawned = {name(node) for node in config.nodes if node.respawn}
        for node in config.nodes:
            node.required = False  # roslaunch would announce a regular end as an accident

    def process_died(self, process_name, exit_code):
        if self.status is not None or self.monitor.is_shutdown and process_name != "master":
            return
        name = process_name.rpartition("-")[0]  # roslaunch appends a counter
        if process_name == "master":
            print("the ROS master is gone", file=sys.stderr)
            self.end(MASTER_LOST)
        elif name in self.required:
            self.end(exit_code if exit_code >= 0 else 128 - exit_code)
        elif name in self.respawned and exit_code == MISUSE:
            self.end(MISUSE)

    def end(self, status):
        self.status = status
        self.monitor.shutdown()


class Gate:
    """Lets roslaunch start processes until it is closed."""

    def __init__(self):
        self.lock = threading.Lock()
        self.closed = False
        start = roslaunch.nodeprocess.LocalProcess.start

        def start_if_open(process):
            with self.lock:
                return not self.closed and start(process)

        roslaunch.nodeprocess.LocalProcess.start = start_if_open

    def close(self):
        with self.lock:
            self.closed = True


def end_master_by_sigterm():
    """For SIGINT, with which roslaunch begins, Python has a traceback while the master starts."""
    stop = roslaunch.nodeprocess.LocalProcess.stop

    def stop_or_terminate(process, errors=None):
        if process.name == "master" and process.popen:
            process.popen.terminate()
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.popen.wait(SIGTERM_TIMEOUT)
        stop(process, errors)

    roslaunch.nodeprocess.LocalProcess.stop = stop_or_terminate


def check_arguments(file, arguments):
    """What roslaunch would take for something else, or drop."""
    known = roslaunch.arg_dump.get_args([file])
    given = set()
    for argument in arguments:
        name, separator, value = argument.partition(":=")
        if not separator:
            raise WrongArgument(f"argument `{argument}` is not of the form NAME:=VALUE")
        if name not in known:
            raise WrongArgument(f"unknown argument `{name}`; there are {', '.join(sorted(known))}")
        if name in given:
            raise WrongArgument(f"argument `{name}` is given twice")
        if not value.strip():
            raise WrongArgument(f"argument `{name}` has no value; without it, it has its default")
        if value != value.strip() or ":=" in value or "$(" in value:
            raise WrongArgument(f"argument `{argument}`: roslaunch takes no value with a space at an "
                                "end of it, or with `:=` or `$(` in it")
        given.add(name)
    missing = [name for name, (_, default) in known.items() if default is None and name not in given]
    if missing:
        raise WrongArgument(f"argument `{missing[0]}` is required: {known[missing[0]][0]}")


def sentence(error):
    """What is wrong, out of roslaunch's message with all the XML around it."""
    text = str(error)
    refusal = re.search(r"Invalid <arg> tag: ((['\"]).*\2)\. \n\nArg xml is", text, re.DOTALL)
    if refusal:  # by the launch file itself, a KeyError
        return ast.literal_eval(refusal.group(1))
    text = re.sub(r"(?m)^while processing .*:\n", "", text)
    text = re.sub(r"^(?:error loading|Invalid) <\w+> tag: *", "", text)
    return " ".join(re.split(r"\.? *\n\n?(?:\w+ )?(?:XML|xml) is ", text)[0].split())


def load(arguments):
    """The launch file, and its configuration with these arguments."""
    try:
        file, *rest = roslaunch.rlutil.resolve_launch_arguments(arguments)
        given = [argument for argument in arguments if ":=" in argument]
        check_arguments(file, rest + given)
        return file, load_config_default([(file, given)], None)
    except WrongArgument:
        raise
    except Exception as error:  # of any kind: the file evaluates expressions
        raise WrongArgument(sentence(error)) from error


class Launch(threading.Thread):
    """Runs a launch file to its end. In a thread of its own, so that no signal handler interrupts
    roslaunch where it holds a lock."""

    def __init__(self, arguments):
        super().__init__(daemon=True)
        self.arguments = arguments
        self.monitor = self.error = None
        self.status = FAILURE

    def run(self):
        try:
            self.status = self.play()
        except Exception as error:
            self.error = error

    def play(self):
        file, config = load(self.arguments)
        run_id = roslaunch.rlutil.get_or_generate_uuid(None, False)
        roslaunch.configure_logging(run_id)
        parent = ROSLaunchParent(run_id, [file], show_summary=False, sigint_timeout=SIGINT_TIMEOUT,
                                 sigterm_timeout=SIGTERM_TIMEOUT)
        parent.config = config
        parent.pm = self.monitor = start_process_monitor()
        wanted = [node for node in config.nodes if node.required or node.respawn]
        end = EndOfLaunch(parent.pm, config)
        parent.pm.add_process_listener(end)
        try:
            parent.start()
            for node in wanted:
                if not node.process_name and end.status is None:
                    raise roslaunch.RLException(f"{node.package}/{node.type} could not be started")
        except roslaunch.RLException:
            if end.status is None:  # else a node ended while others were being started
                raise
        while not parent.pm.done:
            time.sleep(0.05)
        return FAILURE if end.status is None else end.status

    def shut_down(self):
        """Ends the nodes, unless they have ended."""
        if self.monitor:
            self.monitor.is_shutdown = True
            self.monitor.join(SHUTDOWN_TIMEOUT)


class Signals:
    """The number of the first signal that came in; 0 before that."""

    def __init__(self):
        self.first = 0
        for number in SIGNALS:
            signal.signal(number, self.on_signal)

    def on_signal(self, number, _):
        self.first = self.first or number


def main(argv):
    roslib.set_interactive(True)  # roslaunch then installs no signal handlers
    gate = Gate()
    end_master_by_sigterm()
    signals = Signals()
    launch = Launch(argv)
    with open(os.devnull, "w") as nowhere, contextlib.redirect_stdout(nowhere):
        launch.start()
        while launch.is_alive() and not signals.first:
            time.sleep(0.05)
        gate.close()
        launch.shut_down()
        end_children()
    if signals.first:
        return 128 + signals.first
    if launch.error:
        print(f"{' '.join(argv[:2])}: {launch.error}", file=sys.stderr)
        return MISUSE if isinstance(launch.error, WrongArgument) else FAILURE
    return launch.status


if __name__ == "__main__":
    STATUS = main(sys.argv[1:])
    sys.stderr.flush()
    os._exit(STATUS)  # roslaunch's threads would be waited for
