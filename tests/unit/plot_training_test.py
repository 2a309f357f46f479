#!/usr/bin/python3
"""The tool plot_training: a picture that is whole, and tables that are none."""
import os
import subprocess
import tempfile
import unittest

import rosunit

TABLE = ("update,episodes,mean_return,speed,std\n"
         "1,20,0.1,0.001,0.6\n"
         "2,40,0.2,,0.5\n"
         "3,60")  # a row that is being written


class PlotTrainingTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.run_folder = folder.name
        self.metrics = os.path.join(self.run_folder, "metrics.csv")

    def plot(self, table, *arguments):
        with open(self.metrics, "w") as file:
            file.write(table)
        return subprocess.run(
            ["rosrun", "threelink_agent", "plot_training", self.run_folder, *arguments],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)

    def refused(self, text, table, *arguments):
        before = sorted(set(os.listdir(self.run_folder)) | {"metrics.csv"})
        result = self.plot(table, *arguments)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn(text, result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assertEqual(sorted(os.listdir(self.run_folder)), before)

    def test_draws_also_while_the_table_grows(self):
        result = self.plot(TABLE)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(sorted(os.listdir(self.run_folder)), ["learning_curve.png", "metrics.csv"])
        with open(os.path.join(self.run_folder, "learning_curve.png"), "rb") as file:
            self.assertEqual(file.read(4), b"\x89PNG")
        self.assertEqual(self.plot(TABLE).returncode, 0)  # over the old one

    def test_refusals_leave_everything_as_it_was(self):
        self.refused("no update yet", "update,episodes,mean_return,speed,std\n")
        self.refused('no column "speed"', "episodes,mean_return,std\n1,2,3\n")
        self.refused("is no table", "update,episodes\0\n1,2\n")
        self.refused("could not convert", TABLE.replace("0.001", "fast"))
        self.refused("zzz", TABLE, "--out", os.path.join(self.run_folder, "curve.zzz"))
        self.refused("is the table itself", TABLE, "--out", self.metrics)
        self.refused("is a folder", TABLE, "--out", self.run_folder)
        self.refused("No such file", TABLE, "--out", os.path.join(self.run_folder, "no", "x.png"))
        os.remove(self.metrics)
        os.mkdir(self.metrics)
        result = subprocess.run(["rosrun", "threelink_agent", "plot_training", self.run_folder],
                                stderr=subprocess.PIPE, universal_newlines=True)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("Is a directory", result.stderr)


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "plot_training", PlotTrainingTest)
