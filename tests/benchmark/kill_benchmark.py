#!/usr/bin/python3
"""Four workers whose steps cost 50 us of sleep each; one of them is killed with -9, and started anew
three seconds later; again and again. How fast the throughput is back at that of three, and of four.

  source devel/setup.bash && tests/benchmark/kill_benchmark.py
"""
import argparse
import os
import statistics
import tempfile
import time

from training_runs import Here, Run, table
from training_processes import write_config

STEPS, EPISODES = 200, 80  # of an episode; of an update: 0.2 s


class Watch:
    """When each update was seen to be done."""

    def __init__(self, run):
        self.run = run
        self.seen = []  # [s]

    def look(self):
        rows = len(self.run.rows())
        self.seen += [time.monotonic()] * (rows - len(self.seen))

    def wait(self, condition, seconds):
        def looked():
            self.look()
            return condition()
        self.run.wait(looked, seconds)

    def speeds(self, since):
        """[(when it was done, steps/s)] of the updates that ended after `since`."""
        return [(b, STEPS * EPISODES / (b - a)) for a, b in zip(self.seen, self.seen[1:])
                if b > since and b > a]

    def speed(self, updates=10):
        """Waits for so many updates; the median of their [steps/s]."""
        begin = time.monotonic()
        self.wait(lambda: len(self.speeds(begin)) > updates, 60)
        return statistics.median(speed for _, speed in self.speeds(begin)[1:])

    def back(self, since, speed):
        """[s] from `since` to the end of the first update that is at least so fast."""
        fast = lambda: [end for end, got in self.speeds(since) if got >= speed]
        self.wait(fast, 30)
        return fast()[0] - since


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=10, help="(10)")
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder, Here() as here:
        config = write_config(os.path.join(folder, "train.yaml"), episodes=8000000,
                              evaluate_every=1000000, hidden=[8], update__episodes=EPISODES,
                              update__minibatch=4000, update__epochs=1)
        with Run(here, config, os.path.join(folder, "run")) as run:
            names = ["worker_%d" % i for i in range(4)]
            workers = {name: run.worker(name, 50) for name in names[:3]}
            run.learner()
            watch = Watch(run)
            run.wait(lambda: len(run.rows()) > 10, 30)
            three = watch.speed()
            workers[names[3]] = run.worker(names[3], 50)
            watch.back(time.monotonic(), 1.2 * three)
            four = watch.speed()
            for kill in range(options.kills):
                name = names[kill % 4]
                workers[name].kill()
                killed = time.monotonic()
                to_three = watch.back(killed, 0.9 * three)
                while time.monotonic() < killed + 3:
                    watch.look()
                    time.sleep(0.01)
                started = time.monotonic()
                workers[name] = run.worker(name, 50)
                to_four = watch.back(started, 0.9 * four)
                rows.append([kill + 1, "%.2f s" % to_three, "%.2f s" % to_four])
                watch.speed(25)  # more than five starts of a name within 60 s are too many
    print("%.1f k steps/s by three workers, %.1f k by four\n" % (three / 1e3, four / 1e3))
    table(["kill", ">= 90 % of three after", ">= 90 % of four, from the new start on, after"], rows)


if __name__ == "__main__":
    main()
