#!/usr/bin/python3
"""A learner with many light workers, whose steps cost some sleep each: leases a second, and the
learner's memory, which must not grow.

  source devel/setup.bash && tests/benchmark/load_benchmark.py --seconds 600
"""
import argparse
import os
import tempfile
import time

from training_runs import Here, Run, table
from training_processes import write_config


def resident(pid):
    """[MB]"""
    with open("/proc/%d/statm" % pid) as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


def cpu(pid):
    """[s] of user and system time."""
    with open("/proc/%d/stat" % pid) as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--workers", type=int, default=200, help="(200)")
    parser.add_argument("--seconds", type=float, default=600, help="to be looked at (600)")
    parser.add_argument("--warm-up", type=float, default=30, help="[s] before that (30)")
    parser.add_argument("--step-cost", type=float, default=50, help="[us] of sleep a step (50)")
    parser.add_argument("--episodes", type=int, default=640, help="of an update (640)")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, Here() as here:
        config = write_config(os.path.join(folder, "train.yaml"),
                              episodes=options.episodes * 100000, evaluate_every=1000000,
                              hidden=[8], update__episodes=options.episodes,
                              update__minibatch=4000, update__epochs=1)
        with Run(here, config, os.path.join(folder, "run")) as run:
            learner = run.learner(worker_timeout=120.0)
            for i in range(options.workers):
                run.worker("worker_%d" % i, options.step_cost)
            os.environ.update(ROS_MASTER_URI=here.uri, ROS_IP="127.0.0.1")
            heard = Heard(run)
            run.wait(lambda: heard.workers == options.workers, 120)
            time.sleep(options.warm_up)
            heard.leases = 0
            first = len(run.rows())
            pids = {"learner": learner.process.pid, "master": run.master.process.pid}
            used = {name: -cpu(pid) for name, pid in pids.items()}
            begin = time.monotonic()
            memory = []
            while time.monotonic() < begin + options.seconds and learner.running():
                memory.append(resident(learner.process.pid))
                time.sleep(1)
            seconds = time.monotonic() - begin
            if not learner.running():
                raise SystemExit(learner.text())
            used = {name: (cpu(pid) + used[name]) / seconds for name, pid in pids.items()}
            updates = len(run.rows()) - first
            leases, lost, workers = heard.leases, heard.lost, heard.workers
    tenth = max(1, len(memory) // 10)
    table(["%d workers, %g us a step, %.0f s" % (options.workers, options.step_cost, seconds), ""],
          [["leases/s", "%.0f" % (leases / seconds)],
           ["updates/s", "%.2f" % (updates / seconds)],
           ["episodes/s", "%.0f" % (updates * options.episodes / seconds)],
           ["learner, ROS master", "%(learner).2f, %(master).2f of a core" % used],
           ["workers at the end", workers],
           ["leases lost", lost],
           ["memory, by tenths of the time, at most", " ".join(
               "%.1f" % max(memory[i:i + tenth]) for i in range(0, len(memory), tenth)) + " MB"],
           ["memory grew by", "%.1f MB" % (max(memory[-tenth:]) - memory[0])]])


class Heard:
    """What the learner says on its topics."""

    def __init__(self, run):
        import rospy  # it reads the environment
        from threelink_msgs.msg import Leases, TrainingStatus
        run.wait(lambda: run.rows(), 60)
        rospy.init_node("load_benchmark", disable_signals=True)
        self.leases = self.workers = self.lost = 0
        self.topics = [rospy.Subscriber("/threelink/leases", Leases, self.on_leases),
                       rospy.Subscriber("/threelink/training_status", TrainingStatus,
                                        self.on_status)]

    def on_leases(self, message):
        self.leases += len(message.leases)

    def on_status(self, status):
        self.workers = status.workers
        self.lost = sum(worker.leases_lost for worker in status.worker_reports)


if __name__ == "__main__":
    main()
