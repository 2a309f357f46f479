#!/usr/bin/python3
"""Asks for ten episodes, one after the other, and prints a table of what came of them.

Needs a task node that serves the action run_episode:

  roslaunch threelink_tasks task.launch task:=pursuit episodes:=0 realtime_factor:=0
  rosrun threelink_tasks run_episodes.py --task waypoints --parameters "{threshold: 0.05}"
"""
import argparse
import os
import sys
import time

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus

from threelink_msgs.msg import RunEpisodeAction, RunEpisodeGoal, RunEpisodeResult

OUTCOMES = {RunEpisodeResult.CAPTURED: "captured", RunEpisodeResult.TIMED_OUT: "timed out",
            RunEpisodeResult.ABORTED: "aborted"}


def parse(arguments):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--task", default="pursuit", help="name of a task (pursuit)")
    parser.add_argument("--parameters", default="", help="its parameters, YAML")
    parser.add_argument("--policy", default="", help="a policy file (that of the task node)")
    parser.add_argument("--seed", type=int, default=0, help="of the first; the others count on (0)")
    parser.add_argument("--episodes", type=int, default=10, help="how many (10)")
    parser.add_argument("--action", default="/threelink/run_episode", help="name of the action")
    return parser.parse_args(arguments)


def main():
    options = parse(rospy.myargv(sys.argv)[1:])
    rospy.init_node("run_episodes", anonymous=True)
    client = actionlib.SimpleActionClient(options.action, RunEpisodeAction)
    print(f"waiting for the action {options.action}", file=sys.stderr)
    if not client.wait_for_server():  # no time-out: it would go by simulation time
        return 1
    # The server drops goals with a stamp before its last one's: /clock has to be heard first.
    while not rospy.get_time() and not rospy.is_shutdown():
        time.sleep(0.01)
    parameters = options.parameters or ("{v_ratio: 0.5}" if options.task == "pursuit" else "")
    print(f"{'seed':>6} {'outcome':>10} {'steps':>7} {'time':>8} {'speed':>9} {'efficiency':>10}  bag")
    failures = 0
    for seed in range(options.seed, options.seed + options.episodes):
        client.send_goal(RunEpisodeGoal(task=options.task, parameters=parameters, seed=seed,
                                        policy=options.policy))
        if not client.wait_for_result():
            return 1
        result = client.get_result()
        succeeded = client.get_state() == GoalStatus.SUCCEEDED
        failures += not succeeded
        print(f"{seed:>6} {OUTCOMES.get(result.outcome, 'not played'):>10} {result.steps:>7} "
              f"{result.time:>8.1f} {result.mean_speed:>9.5f} {100 * result.efficiency:>8.3f} %  "
              f"{result.bag if succeeded else client.get_goal_status_text()}", flush=True)
    return 1 if failures else 0


if __name__ == "__main__":
    try:
        ended = main()
        sys.stdout.flush()
    except OSError as failure:
        print(f"run_episodes: standard output cannot be written: {failure.strerror}",
              file=sys.stderr)
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # for the flush at exit
        ended = 1
    sys.exit(ended)
