#!/usr/bin/python3
"""Whether trainings reach points: for each seed the time of a training and what its policy does.

  homing_benchmark.py [--config config/train_homing.yaml] [--seeds 5] [--threads 2] [--out DIR]
  homing_benchmark.py --policy FILE ...     the same figures of policies that are there

Needs a sourced workspace. 1000 random stars, 1000 single points, 100 pursuits of each speed, with fresh
seeds; actions as the policy file says. Columns: seconds of the training, cruise speed of the mean action
in % of the optimum; stars and points completed, median ratio of the stars; pursuits at v_ratio 0 and 0.5
with their median steps; median final distance at v_ratio 1.
"""
import argparse
import json
import os
import subprocess
import tempfile
import time

OPTIMUM = 0.0129154  # [L/T0]
CONFIG = os.path.join(os.path.dirname(os.path.realpath(__file__)), "../../config/train_homing.yaml")


def run(package, program, *arguments):
    return subprocess.run(["rosrun", package, program, *map(str, arguments)], check=True,
                          stdout=subprocess.PIPE, universal_newlines=True).stdout


def trials(policy, task, count, *arguments):
    return json.loads(run("threelink_tasks", "trials", "--task", task, "--policy", policy,
                          "--trials", count, "--seed", 1000, "--json", *arguments))


def figures(policy):
    speed = json.loads(run("threelink_agent", "evaluate", "--policy", policy, "--json"))["speed"]
    stars, points = trials(policy, "star", 1000), trials(policy, "point", 1000)
    chases = [trials(policy, "pursuit", 100, "--v-ratio", ratio) for ratio in (0, 0.5, 1)]
    text = "%7.2f%%  %4d of 1000, %.4f  %4d of 1000" % (
        100 * speed / OPTIMUM, stars["completed"], stars["median_ratio"] or float("nan"),
        points["completed"])
    for chase in chases[:2]:
        text += "  %3d, %6.0f" % (chase["completed"], chase["median_steps"] or float("nan"))
    return text + "  %.3f" % chases[2]["final_distance_median"]


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--config", default=CONFIG)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--out", help="folder for the trainings (default: a temporary one)")
    parser.add_argument("--policy", nargs="+", default=[])
    options = parser.parse_args()
    print("training    speed       stars, ratio       points  v_ratio 0  v_ratio 0.5   1")
    for policy in options.policy:
        print("           %s  %s" % (figures(policy), policy), flush=True)
    if options.policy:
        return
    with tempfile.TemporaryDirectory() as temporary:
        for seed in range(options.seeds):
            folder = os.path.join(options.out or temporary, "seed_%d" % seed)
            begin = time.monotonic()
            run("threelink_agent", "train", "--config", options.config, "--seed", seed, "--threads",
                options.threads, "--out", folder)
            seconds = time.monotonic() - begin
            policy = os.path.join(folder, "policy.safetensors")
            print("%6.1f s   %s  seed %d" % (seconds, figures(policy), seed), flush=True)


if __name__ == "__main__":
    main()
