#!/usr/bin/python3
"""The count of tests at the end of `./threelink test`: what failed, what was skipped and why."""
import os
import subprocess
import sys
import tempfile
import unittest

import rosunit

FOLDER = os.path.dirname(os.path.realpath(__file__))
ROOT = os.path.join(FOLDER, "..", "..")

GTEST = """<?xml version="1.0" encoding="UTF-8"?>
<testsuites><testsuite name="Update">
  <testcase name="Passes" status="run" result="completed" classname="Update" />
  <testcase name="Narrow" status="run" result="skipped" classname="Update">
    <skipped message="/some/where/update_test.cpp:193&#x0A;this processor has none of them&#x0A;"/>
  </testcase>
  <testcase name="DISABLED_Slow" status="notrun" result="suppressed" classname="Update" />
</testsuite></testsuites>
"""
PYTHON = """
import sys, unittest
sys.path.insert(0, %r)
import rosunit
import skips

class Cases(unittest.TestCase):
    def test_passes(self):
        pass

    def test_skips(self):
        self.skipTest("there is no sshd")

@unittest.skipIf(True, "no network namespaces")
class Skipped(unittest.TestCase):
    def test_one(self):
        raise AssertionError

    def test_two(self):
        raise AssertionError

class Machine(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        raise unittest.SkipTest("no machine")

    def test_one(self):
        raise AssertionError

suite = unittest.TestSuite(unittest.defaultTestLoader.loadTestsFromTestCase(case)
                           for case in (Cases, Skipped, Machine))
with open(sys.argv[1], "w") as file:
    rosunit.xmlrunner.XMLTestRunner(file).run(suite)
""" % os.path.join(FOLDER, "..", "node")


class TestResultsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="threelink_")
        self.addCleanup(folder.cleanup)
        self.build = folder.name
        os.makedirs(os.path.join(self.build, "test_results", "a"))

    def add(self, name, text):
        with open(os.path.join(self.build, "test_results", "a", name), "w") as file:
            file.write(text)

    def count(self, ctest_status=0):
        """Status and lines."""
        result = subprocess.run([sys.executable, os.path.join(ROOT, "scripts", "test_results.py"),
                                 self.build, str(ctest_status)], stdout=subprocess.PIPE,
                                universal_newlines=True)
        return result.returncode, result.stdout.splitlines()

    def test_skips_are_told_with_their_reasons(self):
        self.add("gtest.xml", GTEST)
        subprocess.run([sys.executable, "-c", PYTHON,
                        os.path.join(self.build, "test_results", "a", "python.xml")], check=True,
                       stdout=subprocess.DEVNULL)
        status, lines = self.count()
        self.assertEqual(status, 0)
        self.assertEqual(lines, [
            "skipped Update.Narrow: this processor has none of them",
            "skipped Update.DISABLED_Slow: no reason given",
            "skipped __main__.Cases.test_skips: there is no sshd",
            "skipped __main__.Skipped.test_one, __main__.Skipped.test_two: no network namespaces",
            "skipped __main__.Machine.setUpClass: no machine",
            "2 passed, 0 failed, 6 skipped"])

    def test_what_failed_is_named(self):
        self.add("gtest.xml", GTEST.replace("result=\"completed\" classname=\"Update\" />",
                                            "classname=\"Update\"><failure/></testcase>"))
        self.add("crashed.xml", "<testsuites>")
        status, lines = self.count()
        self.assertEqual(status, 1)
        self.assertEqual([line.partition(" (")[0] for line in lines if line.startswith("FAILED")],
                         ["FAILED %s/test_results/a/crashed.xml holds no test results" % self.build,
                          "FAILED Update.Passes"])
        self.assertEqual(lines[-1], "0 passed, 2 failed, 2 skipped")

    def test_nothing_passed_is_no_success(self):
        self.assertEqual(self.count(), (1, ["0 passed, 0 failed"]))
        self.add("gtest.xml", GTEST)
        self.assertEqual(self.count(ctest_status=8)[0], 1)


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "test_results", TestResultsTest)
