#!/usr/bin/python3
"""Makes the paper's figures and numbers again, beside the optimum: reproduce.py [--quick] [--out DIR]

Trains, measures, plays, draws and writes one page, DIR/report.html. It can be ended at any time and
started again: what is done is not done twice.
"""
import argparse
import json
import os
import subprocess
import sys
import time

from threelink_report.reproduction import plan, table
from threelink_report.reproduction.runner import Interrupted, Runner, duration, sole_user
from threelink_report.reproduction.stage import StageError, write_atomically

ROOT = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))
CONFIG = os.path.join(ROOT, "config")
LAUNCHER = ("/usr/bin/python3", os.path.join(ROOT, "scripts", "launch.py"))
DONE, FAILED = 0, 1


def parse(arguments):
    parser = argparse.ArgumentParser(
        prog="./threelink reproduce", description=__doc__.partition("\n\n")[2],
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="exit status: 0 all is done, also where the table says that a bar is missed; 1 a stage\n"
               "failed: its command and its log are named; 2 wrong arguments; 128 + the signal's\n"
               "number after SIGINT, SIGTERM and SIGHUP")
    parser.add_argument("--quick", action="store_true",
                        help="from the shipped policies, under 3 minutes; without it all is trained "
                             "from nothing, five seeds of each strategy, under 60 minutes on two cores")
    parser.add_argument("--out", metavar="DIR",
                        help="folder of the run (default runs/reproduction, with --quick "
                             "runs/reproduction_quick)")
    parser.add_argument("--jobs", metavar="N", type=int, default=len(os.sched_getaffinity(0)),
                        help="stages at a time, 1 to 64 (default: the cores, %(default)s here)")
    options = parser.parse_args(arguments)
    if not 1 <= options.jobs <= 64:
        parser.error(f"--jobs {options.jobs}: must be in 1 .. 64")
    options.out = os.path.abspath(options.out or os.path.join(
        ROOT, "runs", "reproduction" + ("_quick" if options.quick else "")))
    try:
        os.makedirs(options.out, exist_ok=True)
    except OSError as error:
        parser.error(f"--out {options.out}: {error.strerror}")
    return options


def revision():
    found = subprocess.run(["git", "-C", ROOT, "describe", "--always", "--dirty"],
                           stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, encoding="utf-8")
    return found.stdout.strip() or "unknown"


def describe(stages, scale):
    """run.json: what figures, table and page say of the run."""
    return json.dumps({
        "mode": scale.mode, "revision": revision(), "published": table.published(),
        "stages": [{"name": stage.name, "title": stage.title, "command": stage.shown(),
                    "outputs": list(stage.outputs)} for stage in stages]}, indent=1) + "\n"


def reproduce(options):
    started = time.monotonic()
    scale = plan.QUICK if options.quick else plan.FULL
    stages = plan.stages(scale, CONFIG)
    runner = Runner(stages, options.out, options.jobs, LAUNCHER)
    with sole_user(options.out):
        write_atomically(os.path.join(options.out, plan.DESCRIPTION), describe(stages, scale))
        print(f"{scale.mode} reproduction in {options.out}: {len(stages)} stages", file=sys.stderr)
        runner.run()
    with open(os.path.join(options.out, "table.json"), encoding="utf-8") as file:
        made = json.load(file)
    print(table.as_text(made))
    verdicts = [row["verdict"] for group in made["groups"] for row in group["rows"]]
    print(f"\n{verdicts.count(table.MET)} bars met, {verdicts.count(table.MISSED)} missed; "
          f"{duration(time.monotonic() - started)}")
    print(f"page: {os.path.join(options.out, 'report.html')}")


def main(arguments):
    options = parse(arguments)
    try:
        reproduce(options)
    except StageError as error:
        print(f"reproduce: {error}", file=sys.stderr)
        print("reproduce: the same command goes on from here", file=sys.stderr)
        return FAILED
    except OSError as error:
        print(f"reproduce: {error.filename or options.out}: {error.strerror}", file=sys.stderr)
        return FAILED
    except Interrupted as end:
        print(f"reproduce: ended by {end}; the same command goes on from here", file=sys.stderr)
        return 128 + end.number
    return DONE


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
