#!/usr/bin/python3
"""A training with two workers, and a pursuit, each alone and among strangers who say --messages
things on every topic: whatever the types let them say, what was said before, claims of gigabytes.

  source devel/setup.bash && tests/benchmark/strangers_benchmark.py
"""
import argparse
import os
import re
import sys
import tempfile
import time

from training_runs import Here, Run, in_process, median_speed, sha256_of, table
from training_processes import write_config
from strangers import GROUPS, said

HERE = os.path.dirname(os.path.realpath(__file__))
STRANGER = os.path.join(HERE, "..", "node", "strangers.py")
LAUNCH = os.path.join(HERE, "..", "..", "scripts", "launch.py")
EPISODES, STEP_COST = 40, 50  # of an update; [us]


def strangers(run, group, messages):
    return run.start(0, ["/usr/bin/python3", STRANGER, "--count", str(messages), group])


def training(here, folder, messages):
    """Rows of the table: alone, and among strangers, who have said all before it ends."""
    updates = 200 if messages <= 1000 else 600
    config = write_config(os.path.join(folder, "train.yaml"), episodes=updates * EPISODES,
                          evaluate_every=1000000, hidden=[16, 16], update__episodes=EPISODES,
                          update__minibatch=2000, update__epochs=2)
    expected, _ = in_process(config, os.path.join(folder, "in_process"))
    rows = []
    for count in (0, messages):
        out = os.path.join(folder, "training_%d" % count)
        with Run(here, config, out) as run:
            for name in ("worker_1", "worker_2"):
                run.worker(name, STEP_COST)
            learner = run.learner()
            run.wait(lambda: len(run.rows()) > 2, 60)
            stranger = strangers(run, "training", count) if count else None
            begin = time.monotonic()
            run.finish(1200)
            seconds = time.monotonic() - begin
            number = said(stranger) if stranger else 0
            rows.append(["training", number, "%.1f k steps/s" % (median_speed(run.rows()) / 1e3),
                         "%.1f s" % seconds,
                         "the same sha256" if sha256_of(out) == expected else "ANOTHER sha256",
                         learner.process.returncode])
    return rows


def pursuit(here, folder, messages):
    rows = []
    for count in (0, messages):
        bags = os.path.join(folder, "bags_%d" % count)
        with Run(here, None, os.path.join(folder, "pursuit_%d" % count)) as run:
            time.sleep(1)
            stranger = strangers(run, "loop", count) if count else None
            begin = time.monotonic()
            run.started = run.start(0, [
                "/usr/bin/python3", LAUNCH, "threelink_tasks", "pursuit.launch", "rviz:=false",
                "realtime_factor:=0", "episodes:=5", "seed:=1", "v_ratio:=0.5", "bag_dir:=" + bags])
            while run.started.running():
                if time.monotonic() - begin > 600:
                    sys.exit("the pursuit hangs:\n" + run.started.text())
                time.sleep(0.05)
            seconds = time.monotonic() - begin
            lines = re.findall(r"^episode \d+: (captured after \d+ steps|not captured|aborted \([^)]*\))",
                               run.started.text(), re.MULTILINE)
            rows.append(["pursuit", said(stranger) if stranger else 0, "", "%.1f s" % seconds,
                         "; ".join(lines), run.started.process.returncode])
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--messages", type=int, default=10000, help="on each topic (10000)")
    options = parser.parse_args()
    print("%d topics of a training, %d of a loop" % tuple(len(GROUPS[g]) for g in ("training", "loop")))
    with tempfile.TemporaryDirectory() as folder, Here() as here:
        rows = training(here, folder, options.messages) + pursuit(here, folder, options.messages)
    table(["", "messages of strangers", "speed", "time", "end", "status"], rows)


if __name__ == "__main__":
    main()
