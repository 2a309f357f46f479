#!/usr/bin/python3
"""The runner of stages: what is done is kept, what is not is never half there."""
import io
import os
import signal
import tempfile
import threading
import time
import unittest

import rosunit

from threelink_report.reproduction.runner import Interrupted, Runner, check_order, sole_user
from threelink_report.reproduction.stage import FINISHED, OUT, Stage, StageError


def shell(name, script, outputs, inputs=(), **options):
    return Stage(name, "the stage " + name, ("sh", "-c", script.replace("OUT", OUT)),
                 {one: os.path.basename(one) for one in outputs}, inputs, **options)


class StagesTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.given = os.path.join(self.folder, "given")
        self.write(self.given, "1")

    def write(self, path, text):
        with open(path, "w") as file:
            file.write(text)

    def read(self, name):
        with open(os.path.join(self.folder, name)) as file:
            return file.read()

    def exists(self, name):
        return os.path.exists(os.path.join(self.folder, name))

    def run_stages(self, *stages, jobs=2):
        stream = io.StringIO()
        with sole_user(self.folder):
            Runner(stages, self.folder, jobs, (), stream).run()
        return stream.getvalue()

    def chain(self):
        """Each command adds a line to the file `count`."""
        return (shell("first", f"echo first >> count; cat {self.given} > OUT/a", ["data/a"],
                      (self.given,)),
                shell("second", "echo second >> count; tr 1 x < data/a > OUT/b", ["b"], ("data/a",)))

    def test_what_is_done_is_not_done_again(self):
        self.run_stages(*self.chain())
        self.assertEqual((self.read("data/a"), self.read("b")), ("1", "x"))
        self.run_stages(*self.chain())
        self.assertEqual(self.read("count"), "first\nsecond\n")

    def test_what_is_out_of_date_is_done_again(self):
        self.run_stages(*self.chain())
        self.write(self.given, "11")
        self.run_stages(*self.chain())
        self.assertEqual(self.read("b"), "xx")
        self.assertEqual(self.read("count").count("\n"), 4)
        os.remove(os.path.join(self.folder, "b"))  # lost
        self.run_stages(*self.chain())
        self.write(os.path.join(self.folder, "b"), "y")  # changed by somebody
        self.run_stages(*self.chain())
        self.assertEqual(self.read("b"), "xx")
        self.assertEqual(self.read("count").count("second"), 4)
        self.assertEqual(self.read("count").count("first"), 2)

    def test_a_changed_command_is_run(self):
        self.run_stages(shell("one", "echo 1 > OUT/a", ["a"]))
        self.run_stages(shell("one", "echo 2 > OUT/a", ["a"]))
        self.assertEqual(self.read("a"), "2\n")

    def test_failures_name_stage_command_and_log(self):
        before = shell("before", "echo 1 > OUT/a", ["a"])
        broken = shell("broken", "echo half > OUT/b; echo no ink >&2; exit 3", ["b"], ("a",))
        after = shell("after", "cp b OUT/c", ["c"], ("b",))
        with self.assertRaises(StageError) as caught:
            self.run_stages(before, broken, after)
        for word in ("stage broken", "status 3", "echo half > OUT/b", "logs/broken.log", "no ink"):
            self.assertIn(word, str(caught.exception))
        self.assertEqual(self.read("a"), "1\n")
        self.assertFalse(self.exists("b") or self.exists("c"))
        self.run_stages(before, shell("broken", "echo whole > OUT/b", ["b"], ("a",)), after)
        self.assertEqual(self.read("c"), "whole\n")

    def test_missing_and_empty_outputs_are_failures(self):
        for script in ("true", ": > OUT/a"):
            with self.assertRaisesRegex(StageError, "did not write a"):
                self.run_stages(shell("idle", script, ["a"]))
            self.assertFalse(self.exists("a"))

    def test_standard_output_may_be_the_result(self):
        self.run_stages(shell("print", "echo 7", ["a"], stdout="a"))
        self.assertEqual(self.read("a"), "7\n")

    def interrupted(self, number, *stages):
        """Runs until the file `at_work` is there, then sends this process a signal."""
        def send():
            deadline = time.monotonic() + 30
            while not self.exists("at_work") and time.monotonic() < deadline:
                time.sleep(0.02)
            os.kill(os.getpid(), number)
        sender = threading.Thread(target=send)
        sender.start()
        with self.assertRaises(Interrupted) as caught:
            self.run_stages(*stages)
        sender.join()
        self.assertEqual(caught.exception.number, number)

    def test_signals_leave_no_process_and_nothing_half_done(self):
        script = "echo half > OUT/a; sleep 1000 & echo $! > at_work; wait"
        for number in (signal.SIGINT, signal.SIGTERM):
            self.interrupted(number, shell("long", script, ["a"]))
            self.assertFalse(self.exists("a"))
            sleeper = int(self.read("at_work"))
            with self.assertRaises(ProcessLookupError):
                for _ in range(100):  # until init has taken it away
                    os.kill(sleeper, 0)
                    if open(f"/proc/{sleeper}/stat").read().split()[2] == "Z":
                        raise ProcessLookupError
                    time.sleep(0.05)
            os.remove(os.path.join(self.folder, "at_work"))

    def test_a_resumable_stage_goes_on(self):
        script = "echo x >> OUT/a; if [ $(wc -l < OUT/a) = 1 ]; then touch at_work; sleep 1000; fi"
        for resumable, lines in ((True, 2), (False, 1)):
            stage = shell(f"long_{resumable}", script, ["a"], resumable=resumable)
            self.interrupted(signal.SIGTERM, stage)
            os.remove(os.path.join(self.folder, "at_work"))
            if resumable:
                self.run_stages(stage)
                self.assertEqual(self.read("a").count("x"), lines)
            else:
                self.interrupted(signal.SIGTERM, stage)  # from the beginning again
        self.assertEqual(sorted(os.listdir(os.path.join(self.folder, FINISHED))),
                         ["long_True.json"])

    def test_stages_run_side_by_side_up_to_the_number_of_jobs(self):
        script = "touch here_NAME; for i in $(seq 100); do [ -e here_OTHER ] && break; sleep 0.05; " \
                 "done; [ -e here_OTHER ] && echo met > OUT/NAME"
        two = [shell(name, script.replace("NAME", name).replace("OTHER", other), [name])
               for name, other in (("a", "b"), ("b", "a"))]
        self.run_stages(*two, jobs=2)
        self.assertEqual(self.read("a"), "met\n")

    def test_one_run_in_a_folder(self):
        with sole_user(self.folder), self.assertRaisesRegex(StageError, "another reproduction"):
            self.run_stages(shell("one", "echo 1 > OUT/a", ["a"]))

    def test_plans_out_of_order_are_refused(self):
        first, second = self.chain()
        for stages in ((second, first), (first, first)):
            with self.assertRaises(ValueError):
                check_order(stages)


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "stages", StagesTest)
