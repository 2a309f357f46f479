#!/usr/bin/python3
"""SIGINT, as by Ctrl-C, and SIGTERM in turn at random moments of ./threelink pursuit: the exit status, the
seconds until it is back, and what is left behind.

    tests/benchmark/signal_benchmark.py [--runs 30] [--load N] [--seed 0]

--load runs N processes beside it that use all of a core each. Exit status: 0 if every run ended with 130 or
143, within 10 s, without a traceback, and left no process and no open bag behind.
"""
import argparse
import glob
import os
import random
import signal
import subprocess
import sys
import tempfile
import time

ROOT = os.path.join(os.path.dirname(os.path.realpath(__file__)), "../..")
LONGEST = 8.0  # [s] until the signal
ALLOWED = 10.0  # [s] until everything is down


def processes_with(marker):
    """Command lines of the processes that have this in their environment."""
    found = []
    for name in os.listdir("/proc"):
        if not name.isdigit() or int(name) == os.getpid():
            continue
        try:
            with open("/proc/%s/environ" % name, "rb") as file:
                marked = marker in file.read()
            with open("/proc/%s/cmdline" % name, "rb") as file:
                command = file.read().replace(b"\0", b" ").decode(errors="replace")
        except OSError:
            continue
        if marked and command:
            found.append(command)
    return found


def run(number, sent, delay, folder):
    """(status, seconds, whether there was a traceback, processes and open bags left)"""
    marker = "THREELINK_SIGNAL_RUN=%d_%d" % (os.getpid(), number)
    name, _, value = marker.partition("=")
    environment = {key: text for key, text in os.environ.items() if not key.startswith("ROS_M")}
    with tempfile.TemporaryFile("w+") as output:
        process = subprocess.Popen(
            [os.path.join(ROOT, "threelink"), "pursuit", "rviz:=false", "v_ratio:=1",
             "bag_dir:=" + folder], env=dict(environment, **{name: value}), stdout=output,
            stderr=subprocess.STDOUT, start_new_session=True)
        time.sleep(delay)
        if sent == signal.SIGINT:
            os.killpg(process.pid, sent)  # as a terminal does
        else:
            process.send_signal(sent)  # as a service manager does
        begin = time.monotonic()
        try:
            status = process.wait(60)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            status = process.wait()
        seconds = time.monotonic() - begin
        output.seek(0)
        traceback = "Traceback" in output.read()
    left = processes_with(marker.encode()) + glob.glob(folder + "/*.active")
    return status, seconds, traceback, left


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=30)
    parser.add_argument("--load", type=int, default=0)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    subprocess.run([os.path.join(ROOT, "threelink"), "build"], check=True)
    delays = random.Random(options.seed)
    burners = [subprocess.Popen([sys.executable, "-c", "while True: pass"])
               for _ in range(options.load)]
    bad, longest = 0, 0.0
    try:
        with tempfile.TemporaryDirectory() as folder:
            for number in range(options.runs):
                # Half of them while the launch is coming up.
                delay = delays.uniform(0, LONGEST if number % 2 else 1.5)
                sent = signal.SIGTERM if number // 2 % 2 else signal.SIGINT
                status, seconds, traceback, left = run(number, sent, delay, folder)
                if status == -sent:
                    status = 128 + sent  # as a shell tells it
                fine = status == 128 + sent and seconds < ALLOWED and not traceback and not left
                bad += not fine
                longest = max(longest, seconds)
                print("%s after %.2f s: status %d, back after %.2f s%s%s%s"
                      % (sent.name, delay, status, seconds, ", traceback" if traceback else "",
                         ", left: %s" % left if left else "", "" if fine else "  <- wrong"),
                      flush=True)
    finally:
        for burner in burners:
            burner.kill()
    print("%d of %d as promised; the longest end took %.2f s"
          % (options.runs - bad, options.runs, longest))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
