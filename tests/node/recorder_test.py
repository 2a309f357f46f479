#!/usr/bin/python3
"""The recorder alone: gaps, full disks, and bags that others left or still write."""
import os
import random
import re
import resource
import shutil
import subprocess
import sys
import time

import rosbag
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

from threelink_msgs.msg import Episode, EpisodeAbort, PolicyWeights, Recording

import skips  # noqa: F401, rosunit's results
from recorder_peers import NODE, PROGRAM, RecorderCase
from waiting import wait

KILLS = int(os.environ.get("THREELINK_KILLS", 5))


def limit_file_size():
    """As if the disk were full after 64 KiB. Python ignores SIGXFSZ, and so do its children."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (65536, 65536))


class RecorderTest(RecorderCase):
    def test_states_that_overtake_the_start_are_kept_and_repeated_ones_are_not(self):
        self.start_and_wait()
        self.peers.send_state(1, 99)  # of something before
        self.play(1, [0, 1, 1, 2, 2, 3])
        self.assertTrue(wait(lambda: self.peers.said(Recording.WRITTEN, 1)))
        recording = self.peers.said(Recording.WRITTEN, 1)
        self.assertIn("no state is missing", recording.status)
        with rosbag.Bag(recording.bag) as bag:
            steps = [m.step for _, m, _ in bag.read_messages("/threelink/state")]
            self.assertEqual(steps, [0, 1, 2, 3])
            self.assertEqual(recording.messages, bag.get_message_count())
            (latching,) = {connection.header.get("latching") for connection
                           in bag._get_connections("/threelink/episode")}
            self.assertEqual(latching, b"1")
        (row,) = self.rows()
        self.assertEqual((row["seed"], row["status"], row["steps"]), ("9", "captured", "3"))
        self.assertEqual(self.files(), ["episodes.csv", os.path.basename(recording.bag)])

    def test_missing_states_are_reported(self):
        self.start_and_wait()
        self.play(1, [0, 1, 4, 5, 7])
        self.assertTrue(wait(lambda: self.peers.said(Recording.WRITTEN, 1)))
        self.assertIn("3 states are missing", self.peers.said(Recording.WRITTEN, 1).status)
        self.assertTrue(wait(lambda: any(
            level == DiagnosticStatus.WARN and "states missing: 3 more" in text
            for level, text in self.peers.summaries)))

    def test_an_abort_without_a_task_closes_the_bag(self):
        self.start_and_wait()
        self.play(1, [0, 1, 2], status=None)
        self.assertTrue(wait(self.active))
        abort = EpisodeAbort(episode=1, step=2, peer="target", reason="the task is silent")
        abort.header.stamp = rospy.Time(self.peers.stamp)
        self.peers.abort.publish(abort)
        self.assertTrue(wait(lambda: self.peers.said(Recording.WRITTEN, 1)))
        (row,) = self.rows()
        self.assertEqual((row["status"], row["steps"]), ("aborted", "2"))

    def test_a_new_episode_closes_the_last_one(self):
        self.start_and_wait()
        self.play(1, [0, 1], status=None)
        self.play(2, [0, 1])
        self.assertTrue(wait(lambda: self.peers.said(Recording.WRITTEN, 2)))
        self.assertEqual([(row["episode"], row["status"]) for row in self.rows()],
                         [("1", "aborted"), ("2", "captured")])

    def test_a_full_disk_is_told_and_survived(self):
        process = self.start_and_wait(limit=limit_file_size)
        self.play(1, list(range(1000)))
        self.assertTrue(wait(lambda: self.peers.said(Recording.FAILED, 1)))
        status = self.peers.said(Recording.FAILED, 1).status
        self.assertIn("episode 1 is not recorded", status)
        self.assertIn(self.folder, status)
        self.assertTrue(wait(lambda: any(level == DiagnosticStatus.ERROR and text == status
                                         for level, text in self.peers.summaries)))
        # There is room for a short one.
        self.play(2, [0, 1, 2])
        self.assertTrue(wait(lambda: self.peers.said(Recording.WRITTEN, 2)))
        self.assertIsNone(process.poll())
        # What reached the disk of the first is recovered at the next start.
        process.terminate()
        self.assertEqual(process.wait(10), 0)
        self.assertEqual(len(self.active()), 1)
        self.peers.recordings.clear()
        self.start_and_wait()
        recovered = self.rows()[-1]
        self.assertEqual((recovered["episode"], recovered["recovered"]), ("1", "yes"))
        self.assertGreater(int(recovered["steps"]), 50)

    def test_a_full_file_system_is_told_and_survived(self):
        disk = os.path.join(self.folder, "disk")
        os.mkdir(disk)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", disk],
                          stderr=subprocess.DEVNULL).returncode != 0:
            self.skipTest("mounting a file system is not allowed here")
        try:
            others = os.path.join(disk, "of_others")
            with open(others, "wb") as file:
                file.write(bytes(800 * 1024))
            process = self.start_and_wait(folder=disk)
            self.play(1, list(range(1500)))
            self.assertTrue(wait(lambda: self.peers.said(Recording.FAILED, 1)))
            self.assertRegex(self.peers.said(Recording.FAILED, 1).status,
                             re.escape(disk) + r"/\S+_ep0001\.bag\.active: .*"
                             r"\(\d{6} bytes written, 0 free\)")
            self.assertIsNone(process.poll())
            os.remove(others)
            bag = self.play_to_the_end(2, [0, 1, 2])
            self.assertTrue(bag.startswith(disk))
            process.terminate()
            self.assertEqual(process.wait(10), 0)
        finally:
            for process in self.processes:
                process.kill()
            subprocess.run(["umount", "-l", disk], check=True)

    def test_too_little_room_ends_the_bag_and_nothing_else(self):
        process = self.start_and_wait(min_free_mb=1e9)
        self.play(1, [0, 1, 2])
        self.assertTrue(wait(lambda: self.peers.said(Recording.FAILED, 1)))
        self.assertRegex(self.peers.said(Recording.FAILED, 1).status,
                         r"/\S+_ep0001\.bag\.active: \d+ bytes are left on the disk, fewer than "
                         r"~min_free_mb = 1000000000")
        self.assertIsNone(process.poll())
        self.assertEqual(self.files(), [])

    def test_only_the_oldest_own_bags_are_deleted(self):
        foreign = ["pursuit_2020-01-01-00-00-00_ep0001.bag", "something.bag"]
        for name in foreign:
            shutil.copy(__file__, os.path.join(self.folder, name))
        self.start_and_wait(keep=2)
        bags = [os.path.basename(self.play_to_the_end(episode, [0, 1])) for episode in (1, 2, 3, 4)]
        self.assertTrue(wait(lambda: len(self.files()) == 5))
        self.assertEqual(self.files(), sorted(foreign + bags[2:] + ["episodes.csv"]))
        self.assertEqual([row["bag"] for row in self.rows()], bags)  # the rows are the history

    def test_all_bags_together_are_within_the_quota(self):
        self.start_and_wait(max_total_mb=0.3)
        picture = None
        for episode in range(1, 8):
            bag = self.play_to_the_end(episode, list(range(200)))
            self.assertTrue(os.path.exists(bag))
            picture = picture or bag[:-len("bag")] + "png"
            if episode == 1:
                shutil.copy(__file__, picture)
            sizes = [os.path.getsize(os.path.join(self.folder, name)) for name in self.files()
                     if name != "episodes.csv"]
            self.assertLess(sum(sizes), 300000)
        self.assertGreater(len(sizes), 1)
        self.assertFalse(os.path.exists(picture))

    def test_a_bag_that_is_more_than_the_quota_is_ended_and_kept(self):
        self.start_and_wait(max_total_mb=0.05)
        first = self.play_to_the_end(1, [0, 1])
        self.play(2, list(range(1000)), status=None)
        self.assertTrue(wait(lambda: any(
            level == DiagnosticStatus.ERROR and "more than ~max_total_mb" in text
            for level, text in self.peers.summaries)))
        self.peers.send_episode(2, 999, Episode.CAPTURED)
        self.assertTrue(wait(lambda: self.peers.said(Recording.FAILED, 2)))
        recording = self.peers.said(Recording.FAILED, 2)
        self.assertRegex(recording.status, r"not recorded to its end: .* \d+ bytes are more than "
                                           r"~max_total_mb = 0.05")
        self.assertFalse(os.path.exists(first))
        with rosbag.Bag(recording.bag) as bag:
            self.assertEqual(bag.get_message_count(), recording.messages)
        self.assertEqual((self.rows()[-1]["status"], self.rows()[-1]["steps"]), ("captured", "999"))

    def test_latched_messages_are_in_every_bag(self):
        policy = rospy.Publisher("/threelink/policy", PolicyWeights, queue_size=1, latch=True)
        policy.publish(PolicyWeights(version=7, data=b"weights"))
        static = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
        transform = TransformStamped(child_frame_id="fixed")
        transform.transform.rotation.w = 1
        static.publish(TFMessage([transform]))
        self.start_and_wait()
        self.assertTrue(wait(lambda: policy.get_num_connections() and static.get_num_connections()))
        self.play_to_the_end(1, [0, 1])
        for path in (self.play_to_the_end(2, [0, 1]), self.play_to_the_end(3, [0, 1])):
            with rosbag.Bag(path) as bag:
                messages = {topic: message for topic, message, _ in bag.read_messages()}
            self.assertEqual(messages["/threelink/policy"].version, 7)
            self.assertEqual(messages["/tf_static"].transforms[0].child_frame_id, "fixed")
        policy.unregister()
        static.unregister()

    def test_a_bag_ends_with_what_is_in_it(self):
        self.start_and_wait()
        with rosbag.Bag(self.play_to_the_end(1, [0, 1, 2])) as bag:
            topic, last, _ = list(bag.read_messages())[-1]
            self.assertEqual((topic, last.state), ("/threelink/recording", Recording.WRITTEN))
            self.assertEqual(last.messages, bag.get_message_count())
            self.assertRegex(last.contents, r"^/threelink/episode: 2 [0-9a-f]{16}\n"
                                            r"/threelink/state: 3 [0-9a-f]{16}\n$")

    def test_a_bag_that_only_lacks_its_name_gets_it(self):
        process = self.start_and_wait()
        path = self.play_to_the_end(1, [0, 1, 2])
        process.kill()
        process.wait()
        os.rename(path, path + ".active")  # killed after the row, before the name
        self.peers.recordings.clear()
        self.start_and_wait()
        self.assertEqual(self.files(), ["episodes.csv", os.path.basename(path)])
        self.assertEqual([row["recovered"] for row in self.rows()], ["no"])

    def test_a_killed_recorder_loses_hardly_anything(self):
        chance = random.Random(1)
        process = self.start_and_wait()
        shares = []
        for episode in range(1, KILLS + 1):
            sent = []
            self.play(episode, [0], status=None)
            end = time.monotonic() + 0.7 + 0.5 * chance.random()
            while time.monotonic() < end:  # 1000 states a second, if the machine can
                sent.append(time.monotonic())
                self.peers.send_state(episode, len(sent))
                time.sleep(0.001)
            process.kill()
            killed = time.monotonic()
            process.wait()
            self.peers.send_episode(episode, len(sent), Episode.ABORTED)  # latched: it is over
            self.peers.recordings.clear()
            process = self.start_and_wait()
            row = self.rows()[-1]
            self.assertEqual((len(self.rows()), row["episode"], row["recovered"], row["status"]),
                             (episode, str(episode), "yes", "aborted"))
            with rosbag.Bag(os.path.join(self.folder, row["bag"])) as bag:
                steps = {m.step for _, m, _ in bag.read_messages("/threelink/state")}
                self.assertEqual(int(row["messages"]), bag.get_message_count())
            self.assertEqual(self.active(), [])
            old = {step for step, at in enumerate(sent, 1) if at < killed - 0.5}
            self.assertGreater(len(old), 50)
            shares.append(len(steps & old) / len(old))
        print("%d kills: of what was older than 0.5 s, %.2f %% readable at worst" %
              (len(shares), 100 * min(shares)), file=sys.stderr)
        self.assertGreaterEqual(min(shares), 0.99)

    def test_a_folder_that_cannot_be_is_refused_at_the_start(self):
        path = os.path.join(self.folder, "file")
        open(path, "w").close()
        for folder in (path + "/bags", path, "/proc/bags"):
            self.peers.recordings.clear()
            process = self.start(folder=folder)
            self.assertTrue(wait(lambda: self.peers.said(Recording.FAILED, 0)))
            self.assertIn("~bag_dir = " + folder, self.peers.said(Recording.FAILED, 0).status)
            output = process.communicate(timeout=20)[0]
            self.assertEqual(process.returncode, 2, output)
            self.assertRegex(output, "~bag_dir = %s: (no file|the folder) can" % folder)

    def test_a_folder_that_goes_away_is_told_and_survived(self):
        folder = os.path.join(self.folder, "bags")
        process = self.start_and_wait(folder=folder)
        os.rmdir(folder)
        open(folder, "w").close()
        self.play(1, [0, 1])
        self.assertTrue(wait(lambda: self.peers.said(Recording.FAILED, 1)))
        self.assertIn(folder, self.peers.said(Recording.FAILED, 1).status)
        self.assertIsNone(process.poll())
        os.remove(folder)
        self.play_to_the_end(2, [0, 1])

    def test_a_bag_that_is_written_is_no_leftover(self):
        self.start_and_wait()
        self.play(1, [0, 1, 2], status=None)
        self.assertTrue(wait(self.active))
        rospy.set_param("/threelink/other", {"bag_dir": self.folder, "picture": False})
        other = subprocess.Popen([PROGRAM, "__name:=other", "__ns:=threelink"])
        self.processes.append(other)
        self.assertTrue(wait(lambda: len(self.peers.recordings) > 1))  # the other is ready, too
        self.peers.send_state(1, 3)
        self.assertTrue(wait(lambda: len(self.active()) == 2))  # it records the episode as well
        other.terminate()
        self.assertEqual(other.wait(10), 0)
        self.peers.send_episode(1, 3, Episode.CAPTURED)
        self.assertTrue(wait(lambda: not self.active() and len(self.rows()) == 2))
        self.assertEqual({row["recovered"] for row in self.rows()}, {"no"})

    def test_what_is_no_bag_is_left_alone_and_what_is_empty_goes(self):
        path = os.path.join(self.folder, "pursuit_2020-01-01-00-00-00_ep0001.bag.active")
        with open(path, "w") as file:
            file.write("something else")
        open(os.path.join(self.folder, "pursuit_2020-01-01-00-00-00_ep0002.bag.active"), "w").close()
        self.start_and_wait()
        with open(path) as file:
            self.assertEqual(file.read(), "something else")
        self.assertEqual(self.files(), [os.path.basename(path)])

    def test_a_torn_line_of_the_index_is_written_over(self):
        self.start_and_wait()
        self.play(1, [0, 1])
        self.assertTrue(wait(lambda: self.peers.said(Recording.WRITTEN, 1)))
        with open(os.path.join(self.folder, "episodes.csv"), "a") as file:
            file.write("2,pursuit_2020")
        self.play(2, [0, 1])
        self.assertTrue(wait(lambda: self.peers.said(Recording.WRITTEN, 2)))
        self.assertEqual([row["episode"] for row in self.rows()], ["1", "2"])

    def test_a_bad_parameter_is_refused(self):
        cases = [({}, "bag_dir"), ({"bag_dir": "relative"}, "absolute path"),
                 ({"bag_dir": 5}, "bag_dir = 5"), ({"bag_dir": "/x", "picture": "yes"}, "picture"),
                 ({"bag_dir": "/x", "pictures": True}, "pictures"),
                 ({"bag_dir": "/x", "keep": -1}, "keep"),
                 ({"bag_dir": "/x", "max_total_mb": "1e3"}, "max_total_mb")]
        for parameters, message in cases:
            if rospy.has_param(NODE):
                rospy.delete_param(NODE)
            for name, value in parameters.items():
                rospy.set_param(NODE + "/" + name, value)
            done = subprocess.run([PROGRAM, "__name:=recorder", "__ns:=threelink"], timeout=20,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                  universal_newlines=True)
            self.assertEqual(done.returncode, 2, parameters)
            self.assertIn(message, done.stdout)


if __name__ == "__main__":
    rospy.init_node("recorder_test", disable_signals=True)
    rostest.rosrun("threelink_tests", "recorder", RecorderTest)
