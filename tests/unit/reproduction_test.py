#!/usr/bin/python3
"""What a reproduction draws and says: figures, the table against its files, the page, the command."""
import csv
import html.parser
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import rosunit

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
import small_reproduction  # noqa: E402
from threelink_report import style  # noqa: E402
from threelink_report.reproduction import page, plan, runner, table  # noqa: E402
from threelink_report.reproduction.configuration import change  # noqa: E402
from threelink_report.reproduction.figures import FIGURES  # noqa: E402
from threelink_report.reproduction.results import Results, interval  # noqa: E402

ROOT = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..")
CONFIG = os.path.join(ROOT, "config")
COMMAND = ["/usr/bin/python3", os.path.join(ROOT, "scripts", "reproduce.py")]


class Cells(html.parser.HTMLParser):
    """Rows of the table of results, each a list of texts."""

    def __init__(self):
        super().__init__()
        self.rows, self.inside = [], False

    def handle_starttag(self, tag, attributes):
        if tag == "tr":
            self.rows.append([])
        if tag in ("th", "td") and self.rows:
            self.rows[-1].append("")
            self.inside = True

    def handle_endtag(self, tag):
        if tag in ("th", "td"):
            self.inside = False

    def handle_data(self, data):
        if self.inside:
            self.rows[-1][-1] += data


class ReproductionTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.made = small_reproduction.SmallReproduction(cls.folder.name)
        cls.results = Results(cls.folder.name)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def read(self, name):
        with open(os.path.join(self.folder.name, name)) as file:
            return json.load(file)

    def write_page(self):
        """The page of the small run with one figure, whose caption would be harmful unescaped."""
        self.made.json("table.json", table.build(self.results))
        self.made.json("figures/star.json", {"title": "<script>alert(1)</script>", "caption": "a & <b>"})
        with open(self.made.path("figures/star.png"), "wb") as file:
            file.write(b"\x89PNG")
        self.made.write_run()
        return page.build(Results(self.folder.name))

    def test_every_figure_renders(self):
        style.use_style()
        self.results.episode = lambda name: small_reproduction.episode(name.partition("_")[0])
        for name, figure in FIGURES.items():
            with self.subTest(name):
                out = os.path.join(self.folder.name, name + ".png")
                style.save(figure.draw(self.results), out)
                with open(out, "rb") as file:
                    self.assertEqual(file.read(4), b"\x89PNG")
                self.assertGreater(len(figure.caption(self.results)), 100)

    def test_the_interval_is_that_of_student(self):
        mean, half = interval([1, 2, 3, 4, 5])
        self.assertEqual(mean, 3)
        self.assertAlmostEqual(half, 2.776 * np.sqrt(2.5) / np.sqrt(5), delta=1e-9)
        self.assertEqual(interval([7.0]), (7.0, None))

    def test_the_table_of_the_page_equals_the_files(self):
        cells = Cells()
        cells.feed(self.write_page())
        shown = {row[0]: row for row in cells.rows if len(row) == len(table.HEADER)}
        speeds = [self.read(f"data/evaluate/vfs_{seed}.json")["speed"]
                  for seed in range(small_reproduction.SEEDS)]
        half = 4.303 * np.std(speeds, ddof=1) / np.sqrt(3)
        self.assertEqual(shown["VFS: speed"][1:4], [
            "0.01284", f"{np.mean(speeds):.5g} ± {half:.2g}",
            f"{self.read('data/optimum/speed.json')['speed']:.5g}"])
        self.assertTrue(shown["VFS: speed"][5].startswith("met"))
        efficiencies = [self.read(f"data/evaluate/eas_{seed}.json")["efficiency"]
                        for seed in range(small_reproduction.SEEDS)]
        self.assertTrue(shown["EAS: efficiency"][2].startswith(f"{100 * np.mean(efficiencies):.3f} %"))
        with open(os.path.join(self.folder.name, "data/strokes/clockwise.csv")) as file:
            turn = float(list(csv.DictReader(file))[-1]["theta_2"])
        self.assertEqual(shown["basic stroke −π/2 to π/6: rotation a cycle"][2], f"{turn:.5g}")
        # And every row is that of table.json, which names files that are there.
        for group in self.read("table.json")["groups"]:
            for entry in group["rows"]:
                self.assertEqual(tuple(shown[entry["quantity"]]), table.cells(entry))
                for source in entry["sources"]:
                    self.assertTrue(os.path.exists(os.path.join(self.folder.name, source)), source)

    def test_a_missed_bar_is_said(self):
        path = os.path.join(self.folder.name, "data/evaluate/vfs_1.json")
        whole = self.read("data/evaluate/vfs_1.json")
        self.addCleanup(lambda: json.dump(whole, open(path, "w")))
        with open(path, "w") as file:
            json.dump(dict(whole, speed=0.0128), file)
        rows = {entry["quantity"]: entry for group in table.build(self.results)["groups"]
                for entry in group["rows"]}
        self.assertEqual(rows["VFS: speed"]["verdict"], "missed")
        self.assertEqual(rows["EAS: speed"]["verdict"], "met")

    def test_the_page_is_escaped_and_needs_no_network(self):
        text = self.write_page()
        self.assertNotIn("<script>alert", text)
        self.assertIn("&lt;script&gt;alert(1)&lt;/script&gt;", text)
        self.assertIn("a &amp; &lt;b&gt;", text)
        self.assertIn("make &lt;all&gt;", text)
        self.assertIn("r&lt;1&gt;", text)
        self.assertIn("default-src 'none'; img-src data:;", text)
        links = re.findall(r"""<[a-z][^<>]*\s(?:src|href|srcset|action)\s*=\s*["']?([^"' >]+)""", text)
        self.assertGreater(len(links), 5)
        for link in links:
            self.assertTrue(link.startswith(("#", "data:")), link)
        for word in ("http:", "https:", "//www", "@import", "url("):
            self.assertNotIn(word, re.sub(r"data:[^\"]*", "", text))

    def test_plans_are_in_order_and_hold_what_they_should(self):
        for scale in (plan.QUICK, plan.FULL):
            stages = plan.stages(scale, CONFIG)
            runner.check_order(stages)
            made = [name for stage in stages for name in stage.outputs]
            for name in ("vfs", "eas"):
                curve = re.compile(rf"training/(curve_)?{name}_\d+\.csv")
                self.assertGreaterEqual(sum(bool(curve.fullmatch(one)) for one in made), 5)
        for name in ("vfs", "eas_c1", "eas_c2", "eas", "eas_c4", "steps_100"):
            self.assertIn(f"data/evaluate/{name}_4.json", made)  # of the full run: five seeds
        for ending in ("png", "pdf"):
            self.assertEqual(sum(name.endswith(ending) for name in made), len(FIGURES))
        self.assertEqual(sum(name.endswith(".mp4") for name in made), 4)

    def test_configurations_keep_their_comments(self):
        with open(os.path.join(CONFIG, "train_eas.yaml")) as file:
            base = file.read()
        changed = change(base, "environment.c", "4.0")
        differing = [(a, b) for a, b in zip(base.split("\n"), changed.split("\n")) if a != b]
        self.assertEqual(len(differing), 1)
        self.assertEqual(differing[0][1], differing[0][0].replace("c: 3.0", "c: 4.0"))
        for key in ("environment.speed", "nothing.c", "update.std"):
            with self.assertRaises(ValueError):
                change(base, key, "1")

    def test_the_ways_are_those_of_the_evaluation(self):
        out = os.path.join(self.folder.name, "way.csv")
        done = subprocess.run(
            ["rosrun", "threelink_agent", "evaluate", "--trials", "0", "--json", "--policy",
             os.path.join(CONFIG, "policies", "vfs.safetensors"), "--trajectory", out],
            stdout=subprocess.PIPE, check=True, universal_newlines=True)
        rows = np.genfromtxt(out, delimiter=",", names=True)
        self.assertEqual(len(rows), 3 * 1501)
        starts = json.loads(done.stdout)["starts"]
        for index, start in enumerate(starts):
            way = rows[rows["start"] == index]
            self.assertEqual((way["theta_2"][0], way["xc"][0]), (start["theta2"], 0))
            speed = (way["xc"][-1] - way["xc"][-1 - 720]) / 72  # ten strokes
            self.assertAlmostEqual(speed, start["speed"], delta=1e-5)
        refused = subprocess.run(done.args[:-1] + ["/no/such/folder/way.csv"],
                                 stderr=subprocess.PIPE, universal_newlines=True)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("--trajectory /no/such/folder/way.csv: cannot be written", refused.stderr)

    def test_command(self):
        shown = subprocess.run(COMMAND + ["--help"], stdout=subprocess.PIPE, universal_newlines=True)
        self.assertEqual(shown.returncode, 0)
        for word in ("--quick", "--out", "--jobs", "exit status"):
            self.assertIn(word, shown.stdout)
        for arguments, complaint in ((["--jobs", "0"], "--jobs 0"), (["--fast"], "--fast"),
                                     (["--quick", "now"], "now"),
                                     (["--out", "/proc/here"], "/proc/here")):
            refused = subprocess.run(COMMAND + arguments, stderr=subprocess.PIPE,
                                     universal_newlines=True)
            self.assertEqual(refused.returncode, 2, refused.stderr)
            self.assertIn(complaint, refused.stderr)


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "reproduction", ReproductionTest)
