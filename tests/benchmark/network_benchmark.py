#!/usr/bin/python3
"""Training over a network: two hosts (network namespaces) joined by a cable, the learner on one, the
workers on the other. Limits the rate, cuts the cable, delays the packets; compares the policy with
that of one process each time. Needs root, iproute2 and, for the delay, /dev/net/tun.

  source devel/setup.bash && tests/benchmark/network_benchmark.py
"""
import argparse
import os
import statistics
import sys
import tempfile
import time

from training_runs import Here, Run, in_process, median_speed, sha256_of, table
from delayed_hosts import DelayedHosts
from hosts import Hosts, why_not
from training_processes import write_config


def parse():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--episodes", type=int, default=2000, help="of each run (2000)")
    parser.add_argument("--workers", type=int, default=2, help="on the second host (2)")
    parser.add_argument("--rates", nargs="*", default=["1gbit", "100mbit", "10mbit"],
                        help="for tc's tbf (1gbit 100mbit 10mbit)")
    parser.add_argument("--delays", nargs="*", type=float, default=[1, 10, 50],
                        help="[ms] from one host to the other (1 10 50)")
    parser.add_argument("--cut", type=float, default=20, help="[s] without a cable (20)")
    parser.add_argument("--only", choices=["rates", "delays", "cut"], help="one of the tables")
    return parser.parse_args()


class Benchmark:
    def __init__(self, options, folder):
        self.options, self.folder = options, folder
        self.config = write_config(os.path.join(folder, "train.yaml"), episodes=options.episodes,
                                   evaluate_every=100000)
        self.runs = 0
        self.expected, rows = in_process(self.config, self.new_folder())
        self.in_process = median_speed(rows)

    def new_folder(self):
        self.runs += 1
        return os.path.join(self.folder, "run_%d" % self.runs)

    def same(self, run):
        return "yes" if sha256_of(run.out) == self.expected else "NO"

    def train(self, hosts):
        with Run(hosts, self.config, self.new_folder()) as run:
            for i in range(self.options.workers):
                run.worker("worker_%d" % i)
            run.learner()
            run.finish()
        return run

    def rates(self):
        rows = [["one process", "%.0f k" % (self.in_process / 1e3), ""]]
        with Here() as here:
            run = self.train(here)
        rows.append(["loopback", "%.0f k" % (median_speed(run.rows()) / 1e3), self.same(run)])
        for rate in [None] + self.options.rates:
            with Hosts() as hosts:
                if rate:
                    hosts.limit(rate)
                run = self.train(hosts)
            rows.append(["cable, " + (rate or "no limit"),
                         "%.0f k" % (median_speed(run.rows()) / 1e3), self.same(run)])
        table(["network", "steps/s", "same policy"], rows)

    def delays(self):
        rows, base = [], None
        for delay in [0] + self.options.delays:
            with DelayedHosts(delay / 1e3) as hosts:
                run = self.train(hosts)
            seconds = [float(row["seconds"]) for row in run.rows()]
            update = statistics.median(b - a for a, b in zip(seconds, seconds[1:]))
            base = base or update
            trips = "%.1f" % ((update - base) / (2 * delay / 1e3)) if delay else ""
            rows.append(["%g ms" % delay, "%.1f ms" % (1e3 * update),
                         "%.1f k" % (median_speed(run.rows()) / 1e3), trips, self.same(run)])
        table(["delay", "an update", "steps/s", "round trips an update", "same policy"], rows)

    def cut(self):
        """roslaunch starts the workers, and starts those anew that end for want of a master."""
        with Hosts() as hosts, Run(hosts, self.config, self.new_folder()) as run:
            run.learner()
            run.wait(lambda: os.path.exists(os.path.join(run.out, "config.yaml")), 30)
            workers = run.start(1, ["roslaunch", "threelink_tasks", "workers.launch",
                                    "workers:=%d" % self.options.workers, "step_cost:=100.0",
                                    "lan:=true"])
            run.wait(lambda: len(run.rows()) >= self.options.episodes / 100, 60)
            hosts.cut()
            time.sleep(self.options.cut)
            before = len(run.rows())
            hosts.mend()
            mended = time.monotonic()
            run.wait(lambda: len(run.rows()) > before, 60)
            after = time.monotonic() - mended
            run.finish()
            workers.kill(2)
        table(["cable cut for", "first update after", "same policy"],
              [["%g s" % self.options.cut, "%.1f s" % after, self.same(run)]])


def main():
    options = parse()
    if why_not():
        sys.exit(why_not())
    with tempfile.TemporaryDirectory() as folder:
        benchmark = Benchmark(options, folder)
        for part in (benchmark.rates, benchmark.delays, benchmark.cut):
            if options.only in (None, part.__name__):
                part()
                print()


if __name__ == "__main__":
    main()
