"""One step of a reproduction: a command that makes files of files.

A stage works in a folder of its own, out/.unfinished/NAME, and its files are moved to their places
only when the command has ended well, so that no file in the run's folder is ever half there. A record
in out/.finished says what it was made of: command, programs, inputs and outputs, by their hashes. The
stage is done as long as all of that is as recorded.
"""
import dataclasses
import functools
import glob
import hashlib
import json
import os
import re
import shlex
import shutil
import subprocess
import typing

import roslib.packages

from threelink_report.files import replacing

UNFINISHED, FINISHED, LOGS = ".unfinished", ".finished", "logs"
DESCRIPTION = "run.json"  # what the run is made of; there before its first stage
OUT = "{out}"  # in a command: the folder that the stage writes to


class StageError(Exception):
    """Text for people: which stage, what went wrong, where to look."""


@dataclasses.dataclass(frozen=True)
class Stage:
    name: str                            # unique; part of file names
    title: str                           # what it does, for people
    command: typing.Tuple[str, ...]      # as typed in the run's folder, with {out}
    outputs: typing.Dict[str, str]       # file in the run's folder -> pattern of it in {out}
    inputs: typing.Tuple[str, ...] = ()  # files in the run's folder, or absolute ones
    stdout: str = ""                     # file in {out} for the standard output; "": the log
    seconds: float = 1.0                 # about, on one core; for the time left
    resumable: bool = False              # the command goes on with what it left in {out}

    def shown(self):
        """The command as people may repeat it, in the run's folder."""
        text = " ".join(shlex.quote(word.replace(OUT, "OUT")) for word in self.command)
        return text + (f" > OUT/{self.stdout}" if self.stdout else "")


def sha256(path):
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        for block in iter(lambda: file.read(1 << 20), b""):
            digest.update(block)
    return digest.hexdigest()


def write_atomically(path, text):
    with replacing(path) as part, open(part, "w", encoding="utf-8") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())


# --- Programs -------------------------------------------------------------------------------------


@functools.lru_cache(maxsize=None)
def find_program(package, name):
    found = roslib.packages.find_node(package, name)
    if not found:
        raise StageError(f"{package}/{name} is not built; `./threelink build` builds it")
    return found[0]


@functools.lru_cache(maxsize=None)
def fingerprint(program):
    """Hash of a program and of this product's libraries that it loads."""
    parts = [program]
    if open(program, "rb").read(4) == b"\x7fELF":
        listing = subprocess.run(["ldd", program], stdout=subprocess.PIPE,
                                 encoding="utf-8", errors="surrogateescape")
        parts += sorted(re.findall(r"=> (\S*/libthreelink_\S+)", listing.stdout))
    return hashlib.sha256("".join(sha256(part) for part in parts).encode()).hexdigest()


def programs(command):
    """The programs of this product that the command runs."""
    if command[0] == "rosrun":
        return [find_program(command[1], command[2])]
    if command[0] == "roslaunch":
        return [find_program(*node) for node in (
            ("threelink_sim", "simulator_node"), ("threelink_agent", "agent_node"),
            ("threelink_tasks", "task_node"), ("threelink_tasks", "recorder_node"))]
    return []


def argv(command, out, launcher):
    """What is executed: rosrun's own start, of a second, is saved."""
    words = [word.replace(OUT, out) for word in command]
    if words[0] == "rosrun":
        return [find_program(words[1], words[2])] + words[3:]
    if words[0] == "roslaunch":
        return list(launcher) + words[1:]
    return words


# --- What is finished -----------------------------------------------------------------------------


class Ledger:
    """Which stages are done in the run's folder."""

    def __init__(self, folder):
        self.folder = folder
        self._hashes = {}

    def path(self, name):
        return os.path.join(self.folder, name)

    def work(self, stage):
        return self.path(os.path.join(UNFINISHED, stage.name))

    def log(self, stage):
        return self.path(os.path.join(LOGS, stage.name + ".log"))

    def record(self, stage):
        """What was written when the stage ended last, or {}."""
        try:
            with open(self.path(os.path.join(FINISHED, stage.name + ".json")),
                      encoding="utf-8") as file:
                return json.load(file)
        except (OSError, ValueError):
            return {}

    def hash(self, path):
        """Of a file; None where it is missing."""
        path = self.path(path)
        try:
            state = os.stat(path)
        except OSError:
            return None
        known = self._hashes.get(path)
        if known is None or known[0] != (state.st_mtime_ns, state.st_size):
            known = self._hashes[path] = ((state.st_mtime_ns, state.st_size), sha256(path))
        return known[1]

    def key(self, stage):
        """Hash of all that decides on the outputs; raises StageError if an input is missing."""
        inputs = {name: self.hash(name) for name in stage.inputs}
        for name, value in inputs.items():
            if value is None:
                raise StageError(f"stage {stage.name}: its input {name} is missing")
        text = json.dumps([stage.command, stage.outputs, stage.stdout, inputs,
                           [fingerprint(program) for program in programs(stage.command)]],
                          sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()

    def is_done(self, stage):
        record = self.record(stage)
        return (record.get("key") == self.key(stage)
                and set(record["outputs"]) == set(stage.outputs)
                and all(self.hash(name) == value for name, value in record["outputs"].items()))

    def prepare(self, stage):
        """An empty folder to work in, or what the same stage left there, if it can use that."""
        work, key = self.work(stage), self.key(stage)
        marker = work + ".key"
        if not (stage.resumable and os.path.exists(marker) and
                open(marker, encoding="utf-8").read() == key):
            shutil.rmtree(work, ignore_errors=True)
        os.makedirs(work, exist_ok=True)
        write_atomically(marker, key)
        os.makedirs(self.path(LOGS), exist_ok=True)

    def finish(self, stage, seconds):
        """Moves what the command wrote to its places; raises StageError if something is missing."""
        work, sources = self.work(stage), {}
        for name, pattern in stage.outputs.items():
            found = glob.glob(os.path.join(glob.escape(work), pattern))
            if len(found) != 1 or not os.path.getsize(found[0]):
                raise StageError(f"stage {stage.name} ended well but did not write {pattern} "
                                 f"({len(found)} such files); its log is {self.log(stage)}")
            sources[name] = found[0]
        for name, source in sources.items():
            os.makedirs(os.path.dirname(self.path(name)) or ".", exist_ok=True)
            os.replace(source, self.path(name))
        os.makedirs(self.path(FINISHED), exist_ok=True)
        with open(work + ".key", encoding="utf-8") as file:
            key = file.read()  # of the inputs as they were at the start
        record = {"key": key, "command": stage.shown(), "seconds": round(seconds, 2),
                  "outputs": {name: self.hash(name) for name in stage.outputs}}
        write_atomically(self.path(os.path.join(FINISHED, stage.name + ".json")),
                         json.dumps(record, indent=1) + "\n")
        shutil.rmtree(work, ignore_errors=True)
        os.remove(work + ".key")
