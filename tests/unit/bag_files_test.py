#!/usr/bin/python3
"""Bag files against everything that reads them: old ones, damaged ones, and ones of somebody else."""
import contextlib
import io
import os
import random
import re
import resource
import runpy
import shutil
import subprocess
import sys
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor

import rosbag
import roslib.packages
import rosunit
from std_msgs.msg import String

from threelink_report import bag as reader
from threelink_report.episode import EpisodeError, read_episode

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "benchmark"))
import bag_mutations  # noqa: E402

SCRIPTS = os.path.join(HERE, "../../src/threelink_tasks/scripts/")
BAGS = bag_mutations.originals()
FLIPS = int(os.environ.get("THREELINK_FLIPS", 100))
MUTANTS = int(os.environ.get("THREELINK_MUTANTS", 20))
PROVEN, NOT_PROVEN, UNREADABLE = 0, 1, 2


def run(name, *arguments, **options):
    """(exit status, standard output, standard error) of a command of threelink_tasks."""
    program = roslib.packages.find_node("threelink_tasks", name)[0]
    if name != "verify_bag" and not options:
        return run_here(program, *arguments)
    options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options}
    done = subprocess.run([program, *arguments], universal_newlines=True, timeout=60, **options)
    return done.returncode, done.stdout, done.stderr


def run_here(program, *arguments):
    """The same for a Python command, which need not be started anew."""
    output, error = io.StringIO(), io.StringIO()
    argv, sys.argv = sys.argv, [program, *arguments]
    try:
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(error):
            runpy.run_path(SCRIPTS + os.path.basename(program), run_name="__main__")
    except SystemExit as end:
        return end.code, output.getvalue(), error.getvalue()
    finally:
        sys.argv = argv


class BagFilesTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()

    def tearDown(self):
        shutil.rmtree(self.folder)

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, data):
        with open(self.path(name), "wb") as file:
            file.write(data)
        return self.path(name)

    def copy(self):
        return shutil.copy(BAGS[0], self.path("some.bag"))

    def refused(self, path, complaint, commands=("verify_bag", "bag_to_html", "plot_episode")):
        for name in commands:
            status, output, error = run(name, path)
            self.assertEqual((status, output), (2, ""), (name, error))
            self.assertRegex(error, "^%s: .*%s" % (name, complaint))
            self.assertIn(path, error)
            self.assertEqual(error.count("\n"), 1, error)
            self.assertNotIn("Traceback", error)
        self.assertEqual([n for n in os.listdir(self.folder) if n.endswith((".html", ".png", ".part"))], [])

    def test_bags_of_the_first_version_are_proven_and_shown(self):
        self.assertEqual(len(BAGS), 2)
        for path in BAGS:
            status, output, error = run("verify_bag", path)
            self.assertEqual(status, PROVEN, output + error)
            self.assertIn("recomputed: 20 of 20 actions", output)
            page = self.path("page.html")
            self.assertEqual(run("bag_to_html", path, "--out", page), (0, page + "\n", ""))
            picture = self.path("all.png")
            self.assertEqual(run("plot_episode", path, "--out", picture), (0, "", ""))
            for made, start in ((page, b"<!DOCTYPE html>"), (picture, b"\x89PNG")):
                with open(made, "rb") as file:
                    self.assertEqual(file.read(len(start)).lower(), start.lower())

    def test_the_reader_gives_what_rosbag_gives(self):
        for path in BAGS:
            with rosbag.Bag(path) as bag:
                wanted = [(topic, raw[0], raw[2], (stamp.secs, stamp.nsecs), raw[1])
                          for topic, raw, stamp in bag.read_messages(raw=True)]
            self.assertEqual(sorted(map(tuple, reader.read_messages(path))), sorted(wanted))

    def test_bags_that_rosbag_wrote_or_mended_are_read(self):
        with rosbag.Bag(BAGS[0]) as old, rosbag.Bag(self.path("copy.bag"), "w") as new:
            for topic, raw, stamp in old.read_messages(raw=True):
                new.write(topic, raw, stamp, raw=True)
        self.assertEqual(run("verify_bag", self.path("copy.bag"))[0], PROVEN)
        with open(BAGS[0], "rb") as file:
            data = bag_mutations.leave_open(bytearray(file.read()), random.Random(1))
        cut = self.write("cut.bag", data)
        self.refused(cut, "cut off, or was not closed .*: `rosbag reindex` may mend it")
        with rosbag.Bag(cut, "a", allow_unindexed=True) as bag:
            for _ in bag.reindex():
                pass
        self.assertGreater(len(reader.read_messages(cut)), 20)
        self.assertEqual(run("verify_bag", cut)[0], NOT_PROVEN)
        self.assertEqual(run("bag_to_html", cut)[0], 0)

    def test_no_flipped_bit_goes_unnoticed(self):
        with open(BAGS[0], "rb") as file:
            data = file.read()

        def flipped(number):
            path = self.write("flip_%d.bag" % number,
                              bag_mutations.flip(bytearray(data), random.Random(number)))
            status, output, error = run("verify_bag", path)
            os.remove(path)
            return status, output + error
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            results = list(pool.map(flipped, range(FLIPS)))
        wrong = [(n, *result) for n, result in enumerate(results) if result[0] not in (1, 2)]
        print("%d of %d flipped bits found" % (FLIPS - len(wrong), FLIPS), file=sys.stderr)
        self.assertEqual(wrong, [])

    def test_a_time_that_index_and_message_tell_differently_is_found(self):
        with open(BAGS[0], "rb") as file:
            data = bytearray(file.read())
        for place in bag_mutations.places(data, b"time=")[5:8]:
            changed = bytearray(data)
            changed[place + 6] ^= 1
            self.refused(self.write("time.bag", changed), "damaged at byte",
                         ("verify_bag", "bag_to_html"))

    def test_mutants_are_read_or_refused(self):
        counts, wrong = bag_mutations.survey(MUTANTS, seed=7)
        self.assertEqual(wrong, [])
        self.assertEqual(sum(counts.values()), MUTANTS)

    def test_both_readers_refuse_the_same(self):
        differ = []
        for number in range(20):
            name, data = bag_mutations.mutant(BAGS[number % 2], "both %d" % number)
            path = self.write("mutant.bag", data)
            error = run("verify_bag", path)[2]
            try:
                reader.read_messages(path)
                reason = ""
            except reader.BagError as refusal:
                reason = str(refusal)
            if reason and reason not in error:
                differ.append((number, name, reason, error))
        self.assertEqual(differ, [])

    def test_a_length_that_lies_does_not_end_the_program(self):
        with rosbag.Bag(self.path("tiny.bag"), "w") as bag:
            bag.write("/threelink/episode", String("x"))
        with open(self.path("tiny.bag"), "rb") as file:
            data = bytearray(file.read())
        for at in (data.find(b"topic=") - 4, data.rfind(b"topic=") - 4, data.find(b"op=\x05") - 8):
            for length in (900000, 2 ** 31, 2 ** 32 - 1):
                lying = bytearray(data)
                lying[at:at + 4] = length.to_bytes(4, "little")
                self.refused(self.write("lying.bag", lying), "damaged|cut off")

    def test_what_is_no_bag_of_ours_is_refused(self):
        with rosbag.Bag(self.path("foreign.bag"), "w") as bag:
            bag.write("/chatter", String("x"))
        with rosbag.Bag(self.path("nothing.bag"), "w"):
            pass
        with rosbag.Bag(self.path("types.bag"), "w") as bag:
            for name in ("state", "episode", "target"):
                bag.write("/threelink/" + name, String("x"))
        with rosbag.Bag(BAGS[0]) as old, rosbag.Bag(self.path("bz2.bag"), "w", "bz2") as new:
            for topic, raw, stamp in old.read_messages(raw=True):
                new.write(topic, raw, stamp, raw=True)
        os.mkfifo(self.path("pipe.bag"))
        with open(BAGS[0], "rb") as file:
            whole = file.read()
        for path, complaint in (
                (self.path("foreign.bag"), "no bag of the recorder|holds no episode"),
                (self.path("nothing.bag"), "no bag of the recorder|holds no episode"),
                (self.path("types.bag"), r"is of another type, std_msgs/String"),
                (self.path("bz2.bag"), r"compressed \(bz2\): `rosbag decompress` first"),
                (self.write("zero.bag", b""), "it is empty"),
                (self.write("text.bag", b"no bag at all\n"), "no bag of format 2.0"),
                (self.write("cut.bag", whole[:20000]), "cut off.*rosbag reindex"),
                (self.write("cut_index.bag", whole[:-100]), "cut off.*rosbag reindex"),
                (self.path("pipe.bag"), "not a file"), (self.folder, "not a file|s a directory"),
                ("/dev/zero", "not a file"), (self.path("none.bag"), "No such file")):
            self.refused(path, complaint)

    def test_definitions_that_tell_other_fields_are_found(self):
        with open(BAGS[0], "rb") as file:
            data = file.read()
        for old, new in ((b"float64 power", b"float64 qower"), (b"/threelink/state", b"/threelink/stade"),
                         (b"/threelink/recording", b"/threelonk/recording")):
            path = self.write("lie.bag", data.replace(old, new))
            self.assertIn(run("verify_bag", path)[0], (NOT_PROVEN, UNREADABLE), old)

    def test_a_message_that_is_there_twice_is_found(self):
        with rosbag.Bag(BAGS[0]) as bag:
            messages = list(bag.read_messages(raw=True))
        for topic in {message[0] for message in messages}:
            with rosbag.Bag(self.path("twice.bag"), "w") as bag:
                for message in messages + [m for m in messages if m[0] == topic][-1:]:
                    bag.write(*message, raw=True)
            self.assertIn(run("verify_bag", self.path("twice.bag"))[0], (NOT_PROVEN, UNREADABLE), topic)

    def test_an_episode_that_is_none_is_refused(self):
        def nested(episode):
            episode.config = "simulator: " + "[" * 20000
        def bomb(episode):
            episode.config = "a: &a [1]\nb: &b [*a, *a]\nsimulator: *b\ntask: {}\n"
        def formula(episode):
            episode.task = r"$\frac{$ \x07 \x1b[31m"
        def unset(key, value):
            def change(episode):
                episode.config = re.sub(r"(?m)^(\s+%s):.*$" % key, r"\1: " + value, episode.config)
            return change
        cases = [(nested, 2), (bomb, 2), (formula, 0), (unset("dt", ".nan"), 2), (unset("dt", "[]"), 2),
                 (unset("gamma", "-1"), 2), (unset("links", "three"), 2), (unset("links", "4"), 2),
                 (unset("length_scale", "{}"), 2), (unset("joint_limit", "1e999"), 2)]
        for change, wanted in cases:
            path = self.changed("episode", change)
            for name in ("bag_to_html", "plot_episode"):
                status, _, error = run(name, path)
                self.assertEqual(status, wanted, error)
                self.assertNotIn("Traceback", error)

        def infinite(state):
            state.centroid = (float("inf"), 0)
        def far(state):
            state.step += 2 ** 63
        def short(state):
            state.theta = state.theta[:1]
        for change in (infinite, far, short):
            with self.assertRaisesRegex(EpisodeError, "state"):
                read_episode(self.changed("state", change))

    def changed(self, name, change):
        """Path of a bag of which every message of a topic is as change(message) leaves it."""
        with rosbag.Bag(BAGS[0]) as old, rosbag.Bag(self.path("changed.bag"), "w") as new:
            for topic, message, stamp in old.read_messages():
                if topic.rpartition("/")[2] == name:
                    change(message)
                new.write(topic, message, stamp)
        return self.path("changed.bag")

    def test_outputs_are_whole_or_not_there_and_never_over_the_input(self):
        bag = self.copy()
        before = os.stat(bag)
        os.link(bag, self.path("other_name.bag"))
        os.symlink(bag, self.path("link.html"))
        os.mkdir(self.path("folder.html"))
        for out in (bag, self.path("other_name.bag"), self.path("link.html"), self.path("folder.html"),
                    "/dev/full", self.path("none/page.html")):
            status, output, error = run("bag_to_html", bag, "--out", out)
            self.assertEqual((status, output), (2, ""), error)
            self.assertIn("--out " + out, error)
        self.assertEqual(os.stat(bag).st_size, before.st_size)
        # A disk that is full.
        def small_files():
            resource.setrlimit(resource.RLIMIT_FSIZE, (10000, 10000))
        old = self.write("page.html", b"the old page")
        for name, out in (("bag_to_html", old), ("plot_episode", self.path("all.png"))):
            status, output, error = run(name, bag, "--out", out, preexec_fn=small_files)
            self.assertEqual((status, output), (1, ""), error)
            self.assertEqual(error, "%s: %s cannot be written: File too large\n" % (name, out))
        with open(old, "rb") as file:
            self.assertEqual(file.read(), b"the old page")
        self.assertEqual(sorted(os.listdir(self.folder)),
                         ["folder.html", "link.html", "other_name.bag", "page.html", "some.bag"])

    def test_a_temporary_file_follows_no_link(self):
        bag, victim = self.copy(), self.write("victim", b"untouched")
        os.symlink(victim, self.path("page.html.part"))
        self.assertEqual(run("bag_to_html", bag, "--out", self.path("page.html"))[0], 0)
        with open(victim, "rb") as file:
            self.assertEqual(file.read(), b"untouched")

    def test_a_closed_or_full_standard_output_is_told(self):
        bag = self.copy()
        with open("/dev/full", "w") as full:
            for arguments in ((bag,), ("--help",)):
                status, _, error = run("bag_to_html", *arguments, stdout=full)
                self.assertEqual((status, error),
                                 (1, "bag_to_html: standard output cannot be written: No space left on device\n"))
        reading, writing = os.pipe()
        os.close(reading)
        status, _, error = run("bag_to_html", bag, stdout=writing)
        os.close(writing)
        self.assertEqual((status, error), (1, "bag_to_html: standard output cannot be written: Broken pipe\n"))
        program = roslib.packages.find_node("threelink_tasks", "bag_to_html")[0]
        done = subprocess.run(["bash", "-c", '"$0" "$1" >&-', program, bag], stderr=subprocess.PIPE,
                              universal_newlines=True)
        self.assertEqual((done.returncode, done.stderr),
                         (1, "bag_to_html: standard output cannot be written: Bad file descriptor\n"))


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "bag_files", BagFilesTest)
