#!/usr/bin/python3
"""Pages and movies of bags: what they show is what was recorded, for every task."""
import base64
import html.parser
import json
import os
import re
import shutil
import subprocess
import tempfile
import threading
import unittest

import actionlib
import numpy as np
import rosbag
import roslib.packages
import rospy
import rostest

from threelink_msgs.msg import RunEpisodeAction, RunEpisodeGoal
from threelink_report import player
from threelink_report.episode import EpisodeError, Motion, read_episode

from pursuit_test import LAUNCH, NAMESPACE, interrupt, read
from waiting import wait

HERE = os.path.dirname(os.path.realpath(__file__))
STEPS = 150
SMOOTHING = 71
# Every task, with the number of waypoints that a page shows of it.
TASKS = {"pursuit": 0, "waypoints": 10, "clicked_point": 0, "path": 0, "direction": 0, "point": 1}
PARAMETERS = {"pursuit": "v_ratio: 0.5, ", "point": "min_distance: 0.4, "}


def command(name, *arguments, **options):
    """(exit status, standard output, standard error) of a command of threelink_tasks."""
    program = roslib.packages.find_node("threelink_tasks", name)[0]
    done = subprocess.run([program, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True, timeout=60, **options)
    return done.returncode, done.stdout, done.stderr


def embedded(page):
    """What the page plays: {name: value}, the arrays among them."""
    data = json.loads(re.search(r'class="data">(.*?)</script>', page, re.DOTALL).group(1))
    arrays = {name: np.frombuffer(base64.b64decode(text), "<f4")
              for name, text in data.pop("arrays").items()}
    return {**data, **arrays}


def page(bag):
    return player.page(read_episode(bag))


class Elements(html.parser.HTMLParser):
    """Tags and attributes of a page; whether they are closed in order."""

    VOID = {"meta", "input", "link", "img", "br"}

    def __init__(self, page):
        super().__init__()
        self.tags, self.attributes, self.open = set(), [], []
        self.feed(page)
        self.close()
        assert not self.open, self.open

    def handle_starttag(self, tag, attributes):
        self.tags.add(tag)
        self.attributes += attributes
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, tag


class PagesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        process = subprocess.Popen(
            ["/usr/bin/python3", LAUNCH, os.path.join(HERE, "any_task.launch"),
             "bag_dir:=" + cls.folder],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        client = actionlib.SimpleActionClient(NAMESPACE + "run_episode", RunEpisodeAction)
        # Its own time-outs go by /clock, which stands still.
        waiting = threading.Thread(target=client.wait_for_server, daemon=True)
        waiting.start()
        waiting.join(30)
        cls.bags = {}
        if not waiting.is_alive() and wait(rospy.get_time):
            for task in TASKS:
                parameters = "{%smax_steps: %d}" % (PARAMETERS.get(task, ""), STEPS)
                client.send_goal(RunEpisodeGoal(task=task, parameters=parameters))
                if wait(lambda: client.simple_state == actionlib.SimpleGoalState.DONE):
                    cls.bags[task] = client.get_result().bag
        cls.output = interrupt(process)[1]

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def setUp(self):
        self.assertEqual(set(self.bags), set(TASKS), self.output)
        self.assertTrue(all(self.bags.values()), self.output)

    def path(self, name):
        return os.path.join(self.folder, name)

    def changed(self, name, change):
        """Path of the pursuit's bag with its messages as change(topic, message) leaves them."""
        with rosbag.Bag(self.bags["pursuit"]) as old, rosbag.Bag(self.path(name), "w") as new:
            for topic, message, stamp in old.read_messages():
                if change(topic.rpartition("/")[2], message) is not False:
                    new.write(topic, message, stamp)
        return self.path(name)

    def test_a_page_holds_the_numbers_of_its_bag(self):
        for task, waypoints in TASKS.items():
            bag = read(self.bags[task])
            shown = embedded(page(self.bags[task]))
            states = [message for _, message in bag["state"]]
            targets = [(m.point.x, m.point.y) for _, m in bag["target"]]

            def equal(name, values):
                np.testing.assert_array_equal(shown[name], np.float32(values).ravel(),
                                              "%s of %s" % (name, task))
            self.assertEqual(len(states), STEPS + 1)
            equal("steps", range(STEPS + 1))
            equal("centroid", [state.centroid for state in states])
            equal("heading", [state.theta[1] for state in states])
            equal("alpha", [state.alpha for state in states])
            equal("target", targets + targets[-1:])
            self.assertEqual(shown["distance"][-1], np.float32(bag["episode"][-1][1].distance))
            self.assertEqual((shown["dt"], shown["links"], shown["captured"]), (0.1, 3, False))
            self.assertEqual(len(shown["waypoints"]), waypoints, task)
            if task == "waypoints":
                self.assertEqual(tuple(shown["waypoints"][0]), targets[0])
            # The curves, from the definitions.
            centroids = np.array([state.centroid for state in states])
            for j in (0, 40, STEPS - SMOOTHING):
                way = [centroids[k:k + SMOOTHING].mean(axis=0) for k in (j, j + 1)]
                speed = np.linalg.norm(way[1] - way[0]) / 0.1
                power = np.mean([state.work for state in states[j + 1:j + 1 + SMOOTHING]]) / 0.1
                np.testing.assert_allclose(
                    [shown["speed"][j], shown["power"][j], shown["efficiency"][j]],
                    [speed, power, 0.5 * speed ** 2 / power], rtol=1e-5, err_msg=task)
            self.assertEqual(len(shown["theta_s"]), STEPS + 1 - SMOOTHING)

    def test_a_page_needs_nothing_else(self):
        status, output, error = command("bag_to_html", self.bags["pursuit"], "--out",
                                        self.path("page.html"))
        self.assertEqual((status, output, error), (0, self.path("page.html") + "\n", ""))
        with open(self.path("page.html"), encoding="utf-8") as file:
            text = file.read()
        elements = Elements(text)
        loading = {"link", "img", "iframe", "object", "embed", "base"}
        self.assertEqual(elements.tags & loading, set())
        self.assertEqual([name for name, _ in elements.attributes if name in ("src", "href")], [])
        self.assertIn("default-src 'none'", text)
        self.assertNotRegex(text, r"https?:|url\(|@import|\bimport\b|fetch\(|XMLHttpRequest")
        episode = read_episode(self.bags["pursuit"])
        for what, fact in episode.facts():
            self.assertIn(f"<th scope=\"row\">{what}</th><td>{fact}</td>", text)
        facts = dict(episode.facts())
        self.assertEqual(facts["seed, episode"], "0, 1")
        self.assertEqual(facts["outcome"], "not captured (time-out) after 150 steps")
        self.assertRegex(facts["sha256 of the policy"], "^[0-9a-f]{64}$")
        both = player.player(episode, "first") + player.player(episode, "second")
        names = [value for name, value in Elements(both).attributes if name == "id"]
        self.assertEqual(names, ["first", "second"])

    def test_no_text_of_a_bag_becomes_markup(self):
        evil = '</script><script>alert("&1")</script><img src=x>'
        def change(topic, message):
            if topic == "episode":
                message.task = message.reason = message.revision = message.policy_file = evil
        text = page(self.changed("evil.bag", change))
        self.assertNotIn("<script>alert", text)
        self.assertNotIn("img", Elements(text).tags)
        self.assertIn("&lt;script&gt;alert(&quot;&amp;1&quot;)", text)

    def test_a_short_or_broken_episode_is_shown_as_far_as_it_goes(self):
        short = self.changed("short.bag", lambda topic, m: topic != "state" or m.step <= 60)
        self.assertEqual(len(Motion(read_episode(short)).speed), 0)
        shown = embedded(page(short))
        self.assertEqual((len(shown["steps"]), len(shown["speed"])), (61, 0))
        rest = self.changed("rest.bag", lambda topic, m: topic not in ("state", "target")
                            or m.header.stamp.to_sec() > 9)
        self.assertGreater(embedded(page(rest))["steps"][0], 80)
        no_target = self.changed("no_target.bag", lambda topic, m: topic != "target")
        self.assertTrue(np.isnan(embedded(page(no_target))["target"]).all())
        self.assertEqual(command("plot_episode", no_target)[0], 0)

    def test_a_movie_shows_every_step_and_the_end(self):
        status, output, error = command("bag_to_movie", self.bags["waypoints"], "--out",
                                        self.path("movie.mp4"))
        self.assertEqual((status, output, error), (0, self.path("movie.mp4") + "\n", ""))
        probe = subprocess.run(
            ["ffprobe", "-loglevel", "error", "-count_frames", "-show_entries",
             "stream=codec_name,width,height,pix_fmt,nb_read_frames", "-of", "csv=p=0",
             self.path("movie.mp4")], stdout=subprocess.PIPE, universal_newlines=True, check=True)
        self.assertEqual(probe.stdout.strip(), "h264,1280,720,yuv420p,%d" % (STEPS + 30))

    def test_bags_without_an_episode_are_refused(self):
        with open(self.path("text.bag"), "w") as file:
            file.write("no bag")
        with open(self.bags["pursuit"], "rb") as old, open(self.path("cut.bag"), "wb") as new:
            new.write(old.read()[:20000])

        def without_simulator(topic, message):
            if topic == "episode":
                message.config = "{no: simulator}"
        cases = [(self.path("text.bag"), "no bag of format 2.0"),
                 (self.path("cut.bag"), "cut off"),
                 (self.changed("empty.bag", lambda topic, m: topic == "pose"), "no episode"),
                 (self.changed("no_end.bag", lambda topic, m: topic != "episode"), "no episode"),
                 (self.changed("no_config.bag", without_simulator), "of what configuration")]
        for bag, complaint in cases:
            with self.assertRaisesRegex(EpisodeError, "%s: .*%s" % (re.escape(bag), complaint)):
                read_episode(bag)

    def test_refusals(self):
        bag, cut = self.bags["pursuit"], self.path("refused.bag")
        with open(cut, "w") as file:
            file.write("no bag")
        no_path = {**os.environ, "PATH": "/no/such"}
        cases = [("bag_to_html", ("/no/such.bag",), "/no/such.bag: No such file", None),
                 ("bag_to_html", (bag, "--out", "/no/such/page"), "/no/such/page", None),
                 ("bag_to_html", (), "required", None),
                 ("bag_to_movie", (cut,), cut, None),
                 ("bag_to_movie", (bag, "--out", "/no/such/movie.mp4"), "/no/such/movie.mp4", None),
                 ("bag_to_movie", (bag, "--out", "movie.avi"), "does not end in .mp4", None),
                 ("bag_to_movie", (bag, "--seconds", "0"), "1 .. 3600", None),
                 ("bag_to_movie", (bag,), "ffmpeg is missing", no_path)]
        for name, arguments, complaint, environment in cases:
            status, output, error = command(name, *arguments, env=environment)
            self.assertEqual((status, output), (2, ""), error)
            self.assertIn(complaint, error)
            self.assertNotIn("Traceback", error)
        left = [name for name in os.listdir(self.folder) if name.endswith(".part")]
        self.assertEqual((left, os.path.exists(bag[:-4] + ".mp4")), ([], False))


if __name__ == "__main__":
    rospy.init_node("pages_test", disable_signals=True)
    rostest.rosrun("threelink_tests", "pages", PagesTest)
