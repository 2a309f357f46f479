#!/usr/bin/python3
"""Trains a policy by the action `train`, and cancels it on Ctrl-C, which leaves a checkpoint.

  rosrun threelink_agent training_server __ns:=threelink
  rosrun threelink_agent train_client.py --config config/train_vfs.yaml --out runs/a

The exit status is 0 if the training has finished, 1 otherwise, and 2
for wrong arguments.
"""
import argparse
import contextlib
import os
import sys

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus

from threelink_msgs.msg import TrainAction, TrainGoal


def integer(low, high):
    def convert(text):
        try:
            value = int(text)
        except ValueError:
            raise argparse.ArgumentTypeError(f"{text} is no whole number") from None
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"{text} is not within {low} .. {high}")
        return value
    convert.__name__ = "integer"
    return convert


def parse(arguments):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--config", default="", help="YAML file; not needed to resume")
    parser.add_argument("--out", required=True, help="folder of the run")
    parser.add_argument("--seed", type=integer(0, 2**31 - 1),
                        help="instead of the configuration's")
    parser.add_argument("--episodes", type=integer(1, 2**31 - 1), default=0, help="likewise")
    parser.add_argument("--resume", action="store_true", help="go on with the run in --out")
    parser.add_argument("--workers", action="store_true", help="worker nodes play the episodes")
    parser.add_argument("--action", default="/threelink/train", help="name of the action")
    return parser.parse_args(arguments)


def show(feedback):
    """A line of progress; that nobody takes it is told at the end."""
    status = feedback.status
    with contextlib.suppress(OSError):
        print(f"update {status.update}/{status.updates}  return {status.mean_return:.3f}  "
              f"{status.time_left:.0f} s left", flush=True)


def main():
    options = parse(rospy.myargv(sys.argv)[1:])
    rospy.init_node("train_client", anonymous=True, disable_signals=True)
    client = actionlib.SimpleActionClient(options.action, TrainAction)
    print(f"waiting for the action {options.action}", file=sys.stderr)
    client.wait_for_server()
    goal = TrainGoal(config=options.config and os.path.abspath(options.config),
                     out=os.path.abspath(options.out), own_seed=options.seed is not None,
                     seed=options.seed or 0, episodes=options.episodes, resume=options.resume,
                     workers=options.workers)
    client.send_goal(goal, feedback_cb=show)
    try:
        client.wait_for_result()
    except KeyboardInterrupt:
        client.cancel_goal()
        client.wait_for_result()
    result = client.get_result()
    print(result.reason or f"{result.policy} sha256 {result.sha256}")
    return 0 if client.get_state() == GoalStatus.SUCCEEDED else 1


if __name__ == "__main__":
    try:
        ended = main()
        sys.stdout.flush()
    except OSError as failure:
        print(f"train_client: standard output cannot be written: {failure.strerror}",
              file=sys.stderr)
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # for the flush at exit
        ended = 1
    sys.exit(ended)
