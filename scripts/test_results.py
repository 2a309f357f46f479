#!/usr/bin/python3
"""Ends a test run: test_results.py BUILD_FOLDER STATUS_OF_CTEST

Lists what failed, what was skipped and why, and prints `N passed, N failed[, N skipped]`, from the
JUnit files that the tests wrote. A test that wrote none (a hang, or a crash of all of it) is counted
as failed by its name in ctest's list. The exit status is 0 only if something passed and nothing failed.
"""
import pathlib
import re
import sys
from xml.etree import ElementTree


def outcome(case):
    """passed, failed or skipped, for a <testcase> element."""
    if case.find("failure") is not None or case.find("error") is not None:
        return "failed"
    if case.find("skipped") is not None or case.get("status") == "notrun":
        return "skipped"
    return "passed"


def reason(case):
    """Why a test was skipped; without the line of the source, with which gtest begins."""
    skipped = case.find("skipped")
    told = "" if skipped is None else skipped.get("message") or skipped.text or ""
    lines = [line.strip() for line in told.strip().splitlines()]
    if len(lines) > 1 and re.fullmatch(r"\S+:\d+", lines[0]):
        del lines[0]
    return " ".join(lines) or "no reason given"


def main(build, ctest_status):
    skipped = {}  # the tests of each reason
    counts = {"passed": 0, "failed": 0, "skipped": 0}
    for path in sorted((build / "test_results").rglob("*.xml")):
        try:
            cases = list(ElementTree.parse(path).iter("testcase"))
        except ElementTree.ParseError:
            cases = []
        for case in cases:
            result = outcome(case)
            if path.name.startswith("rostest-") and result != "failed":
                continue  # the launch around tests that rosunit-*.xml counts one by one
            counts[result] += 1
            name = f"{case.get('classname')}.{case.get('name')}"
            if result == "failed":
                print(f"FAILED {name} ({path})")
            elif result == "skipped":
                skipped.setdefault(reason(case), []).append(name)
        if not cases:
            counts["failed"] += 1
            print(f"FAILED {path} holds no test results")

    listed = build / "Testing" / "Temporary" / "LastTestsFailed.log"
    failed_programs = listed.read_text(encoding="utf-8").split() if listed.exists() else []
    counts["failed"] = max(counts["failed"], len(failed_programs), int(ctest_status != 0))

    for why, names in skipped.items():
        print(f"skipped {', '.join(names)}: {why}")
    line = f"{counts['passed']} passed, {counts['failed']} failed"
    print(line + (f", {counts['skipped']} skipped" if counts["skipped"] else ""))
    return 0 if counts["passed"] and not counts["failed"] else 1


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]), int(sys.argv[2])))
