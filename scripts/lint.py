#!/usr/bin/python3
"""Runs the linters: lint.py BUILD_FOLDER JOBS [--brief]

With --brief, clang-tidy is left out, but for what clang itself says of locks in the nodes: whether each
member that is marked GUARDED_BY is touched with its mutex held only (threelink_sim/mutex.hpp). The build folder holds compile_commands.json and the generated headers. Each linter says what it
finds; the last line counts the linters.
"""
import concurrent.futures
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def tracked(*patterns):
    """Paths of the repository's files but for links."""
    listed = subprocess.run(["git", "ls-files", "-z", *patterns], cwd=ROOT, check=True,
                            stdout=subprocess.PIPE).stdout
    paths = [ROOT / name for name in listed.decode().split("\0") if name]
    return [str(path) for path in paths if path.is_file() and not path.is_symlink()]


def scripts_of(*interpreters):
    """Files whose first line names one of these, whatever their suffix."""
    found = []
    for path in tracked():
        with open(path, "rb") as file:
            first = file.readline(100)
        if first.startswith(b"#!") and first.split()[0].endswith(interpreters):
            found.append(path)
    return found


def run(name, command, groups, jobs, passed_over=None):
    """Whether the linter is content with each group of files, but for lines that are passed over."""

    def content(files):
        process = subprocess.run([*command, *files], cwd=ROOT, stdin=subprocess.DEVNULL,
                                 stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        lines = process.stdout.decode(errors="replace").splitlines()
        if passed_over:
            lines = [line for line in lines if not line.endswith(passed_over)]
        if process.returncode == 0 or (passed_over and not lines):
            return True
        print("\n".join(lines), flush=True)
        return False

    print(f"{name}: {sum(map(len, groups))} files", flush=True)
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        if all(list(pool.map(content, groups))):
            return True
    print(f"FAILED lint: {name}", flush=True)
    return False


def main(build, jobs, brief):
    cpp = tracked("*.cpp", "*.hpp", "*.inc")
    # A file of kernels is the same text for each instruction set.
    units = [path for path in cpp if "/src/threelink_" in path and path.endswith(".cpp")
             and not path.endswith(("_avx2.cpp", "_avx512.cpp"))]
    tidy = ["clang-tidy", "-quiet", "-p", build, "--extra-arg=-Wthread-safety"]
    if brief:
        # It does not run without a check of its own.
        tidy.append("--checks=-*,clang-diagnostic-thread-safety*,modernize-use-override")
        units = [path for path in units if "/src/node/" in path]
    # Those that are sourced are checked with those that source them.
    bash = scripts_of(b"/bash", b"/sh")
    results = [
        run("clang-format", ["clang-format", "--dry-run", "-Werror"], [cpp], 1),
        run("pyflakes", ["/usr/bin/python3", "-m", "pyflakes"], [scripts_of(b"/python3")], 1,
            passed_over="'skips' imported but unused"),  # imported for what it does
        run("shellcheck", ["shellcheck", "--external-sources", "--check-sourced"], [bash], 1),
        run("locks in the nodes" if brief else "clang-tidy", tidy, [[unit] for unit in units], jobs),
    ]
    print(f"{results.count(True)} passed, {results.count(False)} failed")
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], int(sys.argv[2]), sys.argv[3:] == ["--brief"]))
