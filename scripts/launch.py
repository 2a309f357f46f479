#!/usr/bin/python3
"""roslaunch with an exit status: launch.py PACKAGE FILE [NAME:=VALUE ...]

roslaunch itself ends with 0 whatever happens and ignores misspelt arguments. Here the status is that
of the required node that ended the launch; 128 + the signal's number after SIGINT, SIGTERM or SIGHUP;
2 for wrong arguments; 1 if the launch failed. On the screen is what the nodes and errors say; what
roslaunch says about itself is in its log file.
"""
import contextlib
import os
import signal
import sys

import roslaunch
import roslaunch.arg_dump
from roslaunch.config import load_config_default
from roslaunch.parent import ROSLaunchParent
from roslaunch.pmon import ProcessListener, start_process_monitor

# Everything is down within 5 s of a signal; roslaunch's own patience is 15 s and 2 s.
SIGINT_TIMEOUT, SIGTERM_TIMEOUT = 2.5, 1.0


class EndOfRequiredNode(ProcessListener):
    """Ends the launch with the exit status of the first required node that ends."""

    def __init__(self, monitor, config):
        self.monitor = monitor
        self.status = 0
        self.names = set()
        for node in config.nodes:
            if node.required:
                self.names.add((node.namespace + node.name).lstrip("/"))
                node.required = False  # roslaunch would announce a regular end as an accident

    def process_died(self, process_name, exit_code):
        name_of_node = process_name.rpartition("-")[0]  # roslaunch appends a counter
        if name_of_node in self.names and not self.monitor.is_shutdown:
            self.status = exit_code if exit_code >= 0 else 128 - exit_code
            self.monitor.shutdown()


class SignalRecord:
    """Which signals came in; independent of the handlers, which roslaunch replaces at will."""

    def __init__(self):
        self.reader, writer = os.pipe()
        os.set_blocking(self.reader, False)
        os.set_blocking(writer, False)
        signal.set_wakeup_fd(writer)

    def first(self):
        """The number of the first signal, or 0."""
        try:
            return os.read(self.reader, 1)[0]
        except BlockingIOError:
            return 0


class WrongArgument(Exception):
    pass


def check_arguments(file, arguments):
    known = roslaunch.arg_dump.get_args([file])
    for argument in arguments:
        name, separator, _ = argument.partition(":=")
        if not separator:
            raise WrongArgument(f"argument `{argument}` is not of the form NAME:=VALUE")
        if name not in known:
            raise WrongArgument(f"unknown argument `{name}`; there are {', '.join(sorted(known))}")


def launch(file):
    """Runs a launch file to its end; returns the exit status of the node that ended it."""
    run_id = roslaunch.rlutil.get_or_generate_uuid(None, False)
    roslaunch.configure_logging(run_id)
    parent = ROSLaunchParent(run_id, [file], show_summary=False, sigint_timeout=SIGINT_TIMEOUT,
                             sigterm_timeout=SIGTERM_TIMEOUT)
    parent.config = load_config_default([file], None)
    parent.pm = start_process_monitor()
    end = EndOfRequiredNode(parent.pm, parent.config)
    parent.pm.add_process_listener(end)
    try:
        parent.start()
        parent.spin()
    except roslaunch.RLException:
        if end.status == 0:  # else the node ended while others were being started
            raise
    return end.status


def main(argv):
    signals = SignalRecord()
    try:
        with open(os.devnull, "w") as nowhere, contextlib.redirect_stdout(nowhere):
            file = roslaunch.rlutil.resolve_launch_arguments(argv[:2])[0]
            check_arguments(file, argv[2:])
            status = launch(file)
    except WrongArgument as error:
        print(f"{argv[1]}: {error}", file=sys.stderr)
        status = 2
    except (roslaunch.RLException, ValueError) as error:
        print(f"{argv[1]}: {error}", file=sys.stderr)
        status = 1
    except KeyboardInterrupt:  # before roslaunch put its handlers in place
        status = 0
    signalled = signals.first()
    return 128 + signalled if signalled else status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
