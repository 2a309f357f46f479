#!/usr/bin/python3
"""./threelink and its checks as commands: what they refuse, and how they count."""
import os
import pathlib
import stat
import subprocess
import tempfile
import unittest

import rosunit

ROOT = pathlib.Path(os.path.realpath(__file__)).parent.parent.parent


def run(*command):
    return subprocess.run([str(word) for word in command], stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60,
                          universal_newlines=True, check=False)


class Arguments(unittest.TestCase):
    def test_wrong_ones_end_with_2_and_a_sentence(self):
        for arguments, sentence in (
                (["nosuch"], "unknown command `nosuch`"),
                (["build", "x"], "`build` takes no arguments"),
                (["doctor", "x"], "`doctor` takes no arguments"),
                (["docs", "x"], "`docs` takes no arguments"),
                (["lint", "x"], "`lint` takes nothing, or --brief"),
                (["check", "x"], "`check` takes nothing, or --brief"),
                (["setup", "x"], "`setup` takes nothing, or rviz"),
                (["test", "x"], "`test` takes nothing, --cores, --sanitize"),
                (["test", "--sanitize=memory"], "`test` takes nothing, --cores, --sanitize"),
                (["fuzz", "0"], "fuzz 0: the seconds for each reader must be a whole number"),
                (["fuzz", "policy"], "fuzz policy: the seconds for each reader must be"),
                (["fuzz", "--seed=x"], "fuzz --seed=x: the seed must be a whole number"),
                (["fuzz", "1", "nosuch"], "fuzz: there is no reader `nosuch`")):
            with self.subTest(" ".join(arguments)):
                ended = run(ROOT / "threelink", *arguments)
                self.assertEqual(ended.returncode, 2, ended.stderr)
                self.assertIn(sentence, ended.stderr)
                self.assertEqual(ended.stdout, "")

    def test_help_names_every_command(self):
        manual = run(ROOT / "threelink", "help").stdout
        for command in ("pursuit", "train", "test", "test --cores", "test --sanitize", "fuzz", "lint", "docs",
                        "check"):
            self.assertIn(f"\n  {command}", manual)


class Fuzzers(unittest.TestCase):
    """scripts/fuzz.py with programs that pretend to be harnesses."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "scripts").mkdir()
        (self.folder / "programs").mkdir()
        source = ROOT / "scripts" / "fuzz.py"
        (self.folder / "scripts" / "fuzz.py").write_text(source.read_text(encoding="utf-8"),
                                                         encoding="utf-8")

    def harness(self, name, script):
        path = self.folder / "programs" / f"{name}_fuzz"
        path.write_text("#!/bin/sh\n" + script, encoding="utf-8")
        path.chmod(path.stat().st_mode | stat.S_IXUSR)

    def fuzz(self):
        return run("/usr/bin/python3", self.folder / "scripts" / "fuzz.py",
                   self.folder / "programs", 2, 1, 3)

    def test_what_finds_nothing_passes_with_the_limits_set(self):
        self.harness("calm", 'echo "stat::number_of_executed_units: 7"; echo "$@" >"$0.arguments"')
        ended = self.fuzz()
        self.assertEqual(ended.returncode, 0, ended.stdout)
        self.assertIn("calm: 7 inputs", ended.stdout)
        self.assertEqual(ended.stdout.splitlines()[-1], "1 passed, 0 failed")
        arguments = (self.folder / "programs" / "calm_fuzz.arguments").read_text(encoding="utf-8")
        for limit in ("-max_total_time=1", "-seed=3", "-timeout=1", "-malloc_limit_mb=64"):
            self.assertIn(limit, arguments)

    def test_a_finding_fails_and_says_how_to_see_it_again(self):
        self.harness("calm", 'echo "stat::number_of_executed_units: 7"')
        self.harness("wild", 'echo "Test unit written to /there/wild-crash-1"; exit 77')
        ended = self.fuzz()
        self.assertEqual(ended.returncode, 1)
        self.assertIn(f"again: {self.folder}/programs/wild_fuzz /there/wild-crash-1", ended.stdout)
        self.assertEqual(ended.stdout.splitlines()[-1], "1 passed, 1 failed")

    def test_what_ran_nothing_fails(self):
        self.harness("idle", "exit 0")
        ended = self.fuzz()
        self.assertEqual(ended.returncode, 1)
        self.assertEqual(ended.stdout.splitlines()[-1], "0 passed, 1 failed")

    def test_no_harness_at_all_fails(self):
        self.assertEqual(self.fuzz().returncode, 1)


class ApiPages(unittest.TestCase):
    """scripts/docs.py with a program that pretends to be Doxygen, and its filter."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name).resolve()
        self.header = self.root / "src" / "package" / "include" / "package" / "a.hpp"
        self.header.parent.mkdir(parents=True)
        self.header.write_text("/// @file\n/// A header.\n", encoding="utf-8")

    def docs(self, *warnings, status=0):
        """warnings: (file, text)."""
        doxygen = self.root / "bin" / "doxygen"
        doxygen.parent.mkdir(exist_ok=True)
        log = "".join(f"{file}:7: warning: {text}\n" for file, text in warnings)
        doxygen.write_text(f"#!/bin/sh\ncat >build/docs/warnings.log <<'END'\n{log}END\nexit {status}\n",
                           encoding="utf-8")
        doxygen.chmod(0o755)
        return run("env", f"PATH={doxygen.parent}:/usr/bin:/bin", "/usr/bin/python3", ROOT / "scripts" / "docs.py",
                   self.root)

    def test_without_a_warning_all_headers_pass(self):
        ended = self.docs()
        self.assertEqual(ended.returncode, 0, ended.stderr)
        self.assertEqual(ended.stdout.splitlines()[-1], "1 passed, 0 failed")

    def test_a_warning_fails_and_is_shown(self):
        for text in ("Compound package::A is not documented.",
                     "Member f(int x) (function) of namespace package is not documented.",
                     "unexpected command endcode"):
            with self.subTest(text):
                ended = self.docs((self.header, text))
                self.assertEqual(ended.returncode, 1)
                self.assertIn(f"{self.header}:7: warning: {text}", ended.stdout)
                self.assertEqual(ended.stdout.splitlines()[-1], "0 passed, 1 failed")

    def test_a_member_of_a_class_needs_no_comment(self):
        ended = self.docs((self.header, "Member size() const (function) of class package::A is not documented."))
        self.assertEqual(ended.returncode, 0, ended.stdout)

    def test_a_header_without_a_file_comment_is_skipped_and_named(self):
        other = self.header.with_name("b.hpp")
        other.write_text("// B header.\n", encoding="utf-8")
        ended = self.docs((other, "Compound package::B is not documented."))
        self.assertEqual(ended.returncode, 0, ended.stdout)
        self.assertIn("skipped src/package/include/package/b.hpp", ended.stdout)
        self.assertEqual(ended.stdout.splitlines()[-1], "1 passed, 0 failed, 1 skipped")

    def test_a_doxygen_that_fails_is_a_failure(self):
        ended = self.docs(status=3)
        self.assertEqual(ended.returncode, 1)
        self.assertIn("doxygen ended with status 3", ended.stdout)

    def test_the_filter_keeps_the_layout_of_equations_and_escapes_markup(self):
        self.header.write_text("/// @file\n/// For a < b, with c:\n///\n///   a = <b> @c\n///     + 1\n///\n"
                               "/// The end.\nint x;  ///< in `<u>` <v>\n", encoding="utf-8")
        ended = run(ROOT / "scripts" / "doxygen_filter.py", self.header)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        self.assertEqual(ended.stdout.splitlines(), [
            "/// @file", "/// For a \\< b, with c:", "///", "/// @code{.unparsed}", "///   a = <b> @c",
            "///     + 1", "/// @endcode", "///", "/// The end.", "int x;  ///< in `<u>` \\<v\\>"])


class Sum(unittest.TestCase):
    """The last line of `check`: the sum of its parts."""

    def check(self, test, lint, *arguments):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            parts = root / "threelink"
            parts.write_text(f"#!/bin/bash\ncase $1 in test) {test} ;; lint) {lint} ;; "
                             "fuzz | docs) echo 3 passed, 0 failed ;; esac\n", encoding="utf-8")
            parts.chmod(0o755)
            return run("bash", "-c", "attend() { \"$@\"; }; root=$1; ros_prefix=; "
                       f"set -euo pipefail; source {ROOT}/scripts/checks.bash; check \"${{@:2}}\"", "bash", root,
                       *arguments)

    def test_adds_up(self):
        ended = self.check("echo 10 passed, 0 failed, 2 skipped", "echo 4 passed, 0 failed")
        self.assertEqual(ended.returncode, 0, ended.stderr)
        self.assertEqual(ended.stdout.splitlines()[-1], "40 passed, 0 failed, 6 skipped")

    def test_the_brief_one_leaves_out_fuzzers(self):
        ended = self.check("echo 10 passed, 0 failed, 2 skipped", "echo 4 passed, 0 failed", "--brief")
        self.assertEqual(ended.returncode, 0, ended.stderr)
        self.assertEqual(ended.stdout.splitlines()[-1], "34 passed, 0 failed, 6 skipped")

    def test_a_part_that_fails_fails_all_and_the_others_run(self):
        ended = self.check("echo 9 passed, 1 failed; exit 1", "echo 4 passed, 0 failed")
        self.assertEqual(ended.returncode, 1)
        self.assertEqual(ended.stdout.splitlines()[-1], "37 passed, 3 failed")

    def test_a_part_that_ends_without_its_line_has_failed(self):
        ended = self.check("echo 10 passed, 0 failed", "echo nothing to install from; exit 1")
        self.assertEqual(ended.returncode, 1)
        self.assertEqual(ended.stdout.splitlines()[-1], "36 passed, 1 failed")
        self.assertIn("FAILED threelink lint: status 1", ended.stdout)

    def test_a_status_counts_even_if_the_line_says_that_all_passed(self):
        ended = self.check("echo 10 passed, 0 failed", "echo 4 passed, 0 failed; exit 1")
        self.assertEqual(ended.returncode, 1)


if __name__ == "__main__":
    rosunit.unitrun("threelink_tests", "commands", "commands_test")  # all classes of this file
