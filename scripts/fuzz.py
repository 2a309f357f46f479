#!/usr/bin/python3
"""Runs the fuzz harnesses: fuzz.py FOLDER JOBS SECONDS SEED [NAME...]

Each gets SECONDS and starts its random numbers from SEED (0: another one each time), from the inputs in tests/fuzz/corpus/NAME and those that earlier runs left in
build/fuzz/NAME. The input of a finding stays in build/fuzz. The last line counts the harnesses.
"""
import concurrent.futures
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
LIMITS = ["-timeout=1", "-malloc_limit_mb=64", "-rss_limit_mb=2048"]


def statistic(log, name):
    found = re.search(rf"stat::{name}:\s*(\d+)", log)
    return int(found.group(1)) if found else 0


def fuzz(program, name, seconds, seed):
    """Whether nothing was found."""
    grown = ROOT / "build" / "fuzz" / name
    grown.mkdir(parents=True, exist_ok=True)
    command = [str(program), f"-max_total_time={seconds}", f"-seed={seed}", *LIMITS, "-print_final_stats=1",
               f"-artifact_prefix={grown.parent}/{name}-", str(grown),
               str(ROOT / "tests" / "fuzz" / "corpus" / name)]
    log_file = grown.parent / f"{name}.log"
    with open(log_file, "w", encoding="utf-8") as file:
        status = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=file,
                                stderr=subprocess.STDOUT, check=False).returncode
    log = log_file.read_text(encoding="utf-8", errors="replace")
    inputs = statistic(log, "number_of_executed_units")
    print(f"{name}: {inputs} inputs, the slowest {statistic(log, 'slowest_unit_time_sec')} s, "
          f"{statistic(log, 'peak_rss_mb')} MB", flush=True)
    if status == 0 and inputs > 0:
        return True
    print("\n".join(log.splitlines()[-60:]))
    print(f"FAILED fuzz {name}: status {status}, all of its output is in {log_file}", flush=True)
    for artifact in re.findall(r"Test unit written to (\S+)", log):
        print(f"again: {program} {artifact}", flush=True)
    return False


def main(folder, jobs, seconds, seed, names):
    programs = {path.name[:-len("_fuzz")]: path for path in sorted(folder.glob("*_fuzz"))}
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        results = list(pool.map(lambda name: fuzz(programs[name], name, seconds, seed),
                                names or programs))
    print(f"{results.count(True)} passed, {results.count(False)} failed")
    return 0 if results and all(results) else 1


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4]), sys.argv[5:]))
