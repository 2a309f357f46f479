#!/usr/bin/python3
"""Where the user's language writes 0,5 for 0.5, threelink still reads and writes 0.5."""
import os
import re
import subprocess
import sys
import tempfile
import unittest

import roslib.packages
import rosunit

FOLDER = os.path.dirname(os.path.realpath(__file__))
ROOT = os.path.realpath(os.path.join(FOLDER, "..", ".."))
sys.path.insert(0, os.path.join(FOLDER, "..", "node"))
import skips  # noqa: F401, E402, rosunit's results

COMMA = 'LC_NUMERIC\ndecimal_point ","\nthousands_sep "."\ngrouping 3;3\nEND LC_NUMERIC\n'
ASCII = ("<code_set_name> ASCII\n<comment_char> %\n<escape_char> /\nCHARMAP\n" +
         "".join("<U%04X> /x%02x character\n" % (code, code) for code in range(128)) +
         "END CHARMAP\n")


def run(command, **environment):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          stdin=subprocess.DEVNULL, universal_newlines=True,
                          env={**os.environ, **environment})


class LocaleTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        """The locale is made here, since hardly a machine has it."""
        cls.folder = tempfile.TemporaryDirectory(prefix="threelink_")
        cls.addClassCleanup(cls.folder.cleanup)
        paths = {}
        for name, text in (("comma.source", COMMA), ("ascii.charmap", ASCII)):
            paths[name] = os.path.join(cls.folder.name, name)
            with open(paths[name], "w") as file:
                file.write(text)
        made = run(["localedef", "-c", "-i", paths["comma.source"], "-f", paths["ascii.charmap"],
                    os.path.join(cls.folder.name, "comma")])
        cls.comma = {"LOCPATH": cls.folder.name, "LC_ALL": "comma", "LANGUAGE": ""}
        if run(["awk", 'BEGIN { printf "%.1f", 1.5 }'], **cls.comma).stdout != "1,5":
            raise unittest.SkipTest("a locale with decimal commas cannot be made here: " +
                                    (made.stdout.strip().splitlines() or ["awk has no locales"])[-1])

    def test_doctor_judges_as_ever(self):
        doctor = [os.path.join(ROOT, "threelink"), "doctor"]
        plain, comma = run(doctor), run(doctor, **self.comma)
        self.assertRegex(comma.stdout, r"(?m)^\w+ +memory +\d+\.\d GB available")

        def lines(result):  # memory and disk change in between
            return re.sub(r"[\d.]+ GB", "? GB", result.stdout)
        self.assertEqual(lines(comma), lines(plain))
        self.assertEqual(comma.returncode, plain.returncode)

    def test_tools_read_and_write_points(self):
        policy = os.path.join(ROOT, "config", "policies", "vfs.safetensors")
        for package, name, *arguments in (
                ("threelink_sim", "optimal_stroke", "--help"),
                ("threelink_sim", "make_urdf", "--links", "3"),
                ("threelink_agent", "evaluate", "--policy", policy, "--trials", "2"),
                ("threelink_agent", "describe_policy", policy),
                ("threelink_tasks", "trials", "--task", "pursuit", "--policy", policy, "--trials",
                 "1", "--seed", "4", "--parameters", "{v_ratio: 0.5, threshold: 0.01}")):
            command = roslib.packages.find_node(package, name)[:1] + arguments
            plain, comma = run(command, LC_ALL="C"), run(command, **self.comma)
            self.assertEqual(plain.returncode, 0, plain.stdout)
            self.assertEqual(re.sub(r"[\d.]+ s\b", "? s", comma.stdout),
                             re.sub(r"[\d.]+ s\b", "? s", plain.stdout))


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "locale", LocaleTest)
