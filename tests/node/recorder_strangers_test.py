#!/usr/bin/python3
"""The recorder among strangers: no message makes it deaf, lose what is played, or leave its folder."""
import csv
import io
import os
import subprocess
import sys

import rosbag
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PointStamped

from threelink_msgs.msg import Episode, EpisodeAbort, Recording, SwimmerState

from recorder_peers import PROGRAM, RecorderCase
from waiting import wait

HERE = os.path.dirname(os.path.realpath(__file__))
FAR = 4000000000  # [s] as a stamp


class Stranger:
    """Another node, that publishes what it is told."""

    def __init__(self):
        self.process = subprocess.Popen([sys.executable, os.path.join(HERE, "stranger.py")],
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        universal_newlines=True)

    def publish(self, topic, message):
        data = io.BytesIO()
        message.serialize(data)
        kind = type(message)
        self.process.stdin.write("/threelink/%s %s.msg %s %s\n" % (
            topic, kind._type.split("/")[0], kind._type.split("/")[1], data.getvalue().hex()))
        self.process.stdin.flush()
        assert self.process.stdout.readline() == "sent\n"

    def end(self):
        self.process.communicate()


def stamped(message, stamp):
    message.header.stamp = rospy.Time(stamp)
    return message


class RecorderStrangersTest(RecorderCase):
    def steps(self, episode):
        """Steps of the states in the bag of an episode, and the status that was announced."""
        self.assertTrue(wait(lambda: self.peers.said(Recording.WRITTEN, episode)))
        recording = self.peers.said(Recording.WRITTEN, episode)
        with rosbag.Bag(recording.bag) as bag:
            return [m.step for _, m, _ in bag.read_messages("/threelink/state")], recording.status

    def whole(self, episode, last):
        steps, status = self.steps(episode)
        self.assertEqual(steps, list(range(last + 1)))
        self.assertTrue(status.startswith("no state is missing"), status)
        self.assertEqual([row["missing"] for row in self.rows() if row["episode"] == str(episode)],
                         ["0"])

    def warned(self, text):
        return wait(lambda: any(level == DiagnosticStatus.WARN and text in summary
                                for level, summary in self.peers.summaries))

    def test_a_name_that_leaves_the_folder_or_its_cell_is_refused(self):
        self.start_and_wait()
        names = ["../outside", "/tmp/outside", "a,b", "x\n7,something.bag,pursuit,0,captured", "", "a b",
                 "\"quoted\"", "x" * 65, "\x1b[31m"]
        outside = sorted(os.listdir(os.path.dirname(self.folder)))
        for episode, name in enumerate(names, 1):
            self.peers.send_state(episode, 0)
            self.peers.episode.publish(stamped(Episode(episode=episode, task=name), self.peers.stamp))
            self.assertTrue(wait(lambda: self.peers.said(Recording.FAILED, episode)), name)
            self.assertRegex(self.peers.said(Recording.FAILED, episode).status,
                             "^episode %d is not recorded: its task has no name of" % episode)
        self.assertTrue(self.warned("episodes refused"))
        self.peers.send_state(50, 0)
        self.peers.episode.publish(stamped(Episode(episode=50, task="a", policy_sha256="a,b"),
                                           self.peers.stamp))
        self.assertTrue(wait(lambda: self.peers.said(Recording.FAILED, 50)))
        self.assertEqual(self.files(), [])
        self.assertEqual([name for name in sorted(os.listdir(os.path.dirname(self.folder)))
                          if "outside" in name and name not in outside], [])
        self.play_to_the_end(51, [0, 1])
        self.assertEqual([row["task"] for row in self.rows()], ["pursuit"])

    def test_only_own_files_in_the_folder_are_deleted_whatever_the_rows_say(self):
        own = "pursuit_2020-01-01-00-00-0%d_ep0001.bag"
        outside = os.path.join(self.folder, "outside")
        folder = os.path.join(self.folder, "bags")
        os.mkdir(outside)
        os.mkdir(folder)
        kept = [os.path.join(outside, own % 0), os.path.join(folder, "mine.bag"),
                os.path.join(folder, own % 5)]
        for path in kept:
            open(path, "w").close()
        os.symlink(kept[0], os.path.join(folder, own % 1))
        rows = ["../outside/" + own % 0, kept[0], "mine.bag", own % 1, "\"%s\"" % (own % 5),
                own % 5 + ",one,too,many"]
        with open(os.path.join(folder, "episodes.csv"), "w") as file:
            file.write("episode,bag,task,seed,status,steps,time,distance,mean_speed,policy_sha256,"
                       "messages,recovered\n")
            for row in rows:
                file.write("1,%s,pursuit,0,captured,1,,,,,1,no\n" % row)
        self.start_and_wait(folder=folder, keep=1)
        for episode in (1, 2, 3):
            self.play_to_the_end(episode, [0, 1])
        bags = lambda: [name for name in os.listdir(folder) if "ep000" in name and "2020" not in name]
        self.assertTrue(wait(lambda: len(bags()) == 1))
        for path in kept:
            self.assertTrue(os.path.exists(path), path)
        self.assertTrue(os.path.islink(os.path.join(folder, own % 1)))

    def test_rows_of_an_older_version_get_the_column_that_they_lack(self):
        path = os.path.join(self.folder, "episodes.csv")
        header = ("episode,bag,task,seed,status,steps,time,distance,mean_speed,policy_sha256,messages,"
                  "recovered\n")
        with open(path, "w") as file:
            file.write(header + "9,old.bag,point,4,captured,7,0.7,0.1,0.2,abc,33,no\n8,half of a r")
        self.start_and_wait()
        self.play_to_the_end(1, [0, 1, 3, 4])
        self.play_to_the_end(2, [0, 1])
        with open(path) as file:
            text = file.read()
        self.assertTrue(text.startswith(header[:-1] + ",missing\n"))
        rows = list(csv.DictReader(io.StringIO(text)))
        self.assertEqual([(row["episode"], row["bag"], row["missing"]) for row in rows],
                         [("9", "old.bag", ""), ("1", rows[1]["bag"], "1"), ("2", rows[2]["bag"], "0")])
        self.assertTrue(all(None not in row and None not in row.values() for row in rows))

    def test_a_start_far_ahead_makes_nothing_deaf(self):
        stranger = Stranger()
        self.start_and_wait()
        start = Episode(episode=1, task="pursuit")
        stranger.publish("episode", stamped(start, FAR))
        self.play(1, [0, 1, 2], status=None)
        for publish in (lambda m: stranger.publish("episode", m), self.peers.episode.publish):
            publish(stamped(Episode(episode=1, task="other"), FAR))
            publish(stamped(Episode(episode=77, task="other"), self.peers.stamp))
        self.peers.send_state(1, 3)
        self.peers.send_episode(1, 3, Episode.CAPTURED)
        self.whole(1, 3)
        self.play(2, list(range(6)))
        self.whole(2, 5)
        self.assertEqual(len(self.rows()), 2)
        stranger.end()

    def test_a_state_far_ahead_makes_nothing_deaf(self):
        stranger = Stranger()
        self.start_and_wait()
        far = [SwimmerState(episode=1, step=2 ** 63, theta=[0, 0, 0], alpha=[0, 0]),
               SwimmerState(episode=1, step=2 ** 64 - 1), SwimmerState(episode=1, step=500, alpha=[0, 0])]
        self.play(1, [0, 1, 2], status=None)
        steps = iter(range(3, 9))
        for state in far:
            stranger.publish("state", stamped(state, self.peers.stamp))
            self.peers.send_state(1, next(steps))
            self.peers.state.publish(stamped(state, self.peers.stamp))
            self.peers.send_state(1, next(steps))
        stranger.publish("state", stamped(SwimmerState(episode=1, step=9, alpha=[0, 0]), FAR))
        stranger.publish("target", stamped(PointStamped(), FAR))
        self.peers.send_state(1, 9)
        self.peers.send_episode(1, 9, Episode.CAPTURED)
        self.whole(1, 9)
        self.assertTrue(self.warned("messages refused"))
        with rosbag.Bag(self.peers.said(Recording.WRITTEN, 1).bag) as bag:
            self.assertLess(bag.get_end_time(), self.peers.stamp + 1)
        stranger.end()

    def test_an_end_of_a_stranger_ends_nothing(self):
        stranger = Stranger()
        self.start_and_wait()
        self.play(1, [0, 1, 2], status=None)
        end = Episode(episode=1, step=2, status=Episode.CAPTURED, task="pursuit", seed=9,
                      policy_sha256="ab" * 32)
        stranger.publish("episode", stamped(end, self.peers.stamp))
        stranger.publish("abort", stamped(EpisodeAbort(episode=1, step=2), self.peers.stamp))
        self.assertTrue(self.warned("messages refused"))
        for step in (3, 4):
            self.peers.send_state(1, step)
        # Nor does one of its own task, if the episode goes on.
        self.peers.send_episode(1, 4, Episode.CAPTURED)
        self.peers.send_state(1, 5)
        self.peers.send_state(1, 6)
        self.peers.send_episode(1, 6, Episode.TIMED_OUT)
        self.whole(1, 6)
        with rosbag.Bag(self.peers.said(Recording.WRITTEN, 1).bag) as bag:
            said = [m.status for _, m, _ in bag.read_messages("/threelink/episode")]
            topics = bag.get_type_and_topic_info().topics
        self.assertEqual(said, [Episode.STARTED, Episode.TIMED_OUT])
        self.assertNotIn("/threelink/abort", topics)
        self.assertEqual([row["status"] for row in self.rows()], ["timed_out"])
        stranger.end()

    def test_what_a_stranger_lets_be_lost_is_told(self):
        self.start_and_wait()
        self.play(1, [0, 1, 5, 6, 7], status=None)
        self.peers.send_episode(1, 9, Episode.CAPTURED)
        steps, status = self.steps(1)
        self.assertEqual((steps, status), ([0, 1, 5, 6, 7], "5 states are missing"))
        self.assertEqual([row["missing"] for row in self.rows()], ["5"])

    def test_two_recorders_share_a_folder(self):
        for number in range(2):
            rospy.set_param("/threelink/recorder_%d" % number, {"bag_dir": self.folder, "picture": False})
        ready = len(self.peers.recordings)
        names = ["recorder_0", "recorder_1"]
        self.processes += [subprocess.Popen([PROGRAM, "__name:=" + name, "__ns:=threelink"],
                                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
                           for name in names]
        self.assertTrue(wait(lambda: len(self.peers.recordings) >= ready + 2))
        for episode in (1, 2, 3, 4):
            self.play(episode, list(range(20)))
            self.assertTrue(wait(lambda: len(
                [r for r in self.peers.recordings if (r.state, r.episode) == (Recording.WRITTEN, episode)])
                == 2))
        rows = self.rows()
        self.assertEqual(sorted(row["episode"] for row in rows), list("11223344"))
        self.assertEqual(len({row["bag"] for row in rows}), 8)
        for row in rows:
            with rosbag.Bag(os.path.join(self.folder, row["bag"])) as bag:
                self.assertEqual(str(bag.get_message_count()), row["messages"])
            self.assertEqual((row["missing"], row["recovered"]), ("0", "no"))
        self.assertEqual(self.active(), [])


if __name__ == "__main__":
    rospy.init_node("recorder_strangers_test", disable_signals=True)
    rostest.rosrun("threelink_tests", "recorder_strangers", RecorderStrangersTest)
