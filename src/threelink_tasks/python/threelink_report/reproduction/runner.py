"""Runs stages: in the order of their inputs, some at a time, each one only if it is not done."""
import contextlib
import fcntl
import itertools
import os
import signal
import socket
import subprocess
import sys
import time

from .stage import DESCRIPTION, UNFINISHED, Ledger, StageError, argv

TICK = 0.1  # [s] between two looks at what runs
PATIENCE = 8.0  # [s] for a stage to end after SIGTERM, before SIGKILL
TAIL = 15  # lines of a failed stage's log that are shown


class Interrupted(Exception):
    def __init__(self, number):
        super().__init__(signal.Signals(number).name)
        self.number = number


@contextlib.contextmanager
def sole_user(folder):
    """Holds the run's folder; a second run on it is refused."""
    os.makedirs(os.path.join(folder, UNFINISHED), exist_ok=True)
    with open(os.path.join(folder, UNFINISHED, "lock"), "w", encoding="utf-8") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise StageError(f"another reproduction works in {folder}")
        yield


# For ROS masters; below the ports that the kernel gives to outgoing connections. Each process begins
# elsewhere, so that two reproductions do not want the same one.
PORTS = itertools.cycle(range(12000 + os.getpid() % 4000, 16000 + os.getpid() % 4000))


def free_port():
    for port in PORTS:
        with socket.socket() as probe, contextlib.suppress(OSError):
            probe.bind(("127.0.0.1", port))
            return port


class Progress:
    """A line that is rewritten on a terminal, a line for each finished stage elsewhere."""

    def __init__(self, total, stream=sys.stderr):
        self.total, self.stream = total, stream
        self.terminal = stream.isatty()

    def say(self, text):
        self.stream.write(("\r\x1b[K" if self.terminal else "") + text + "\n")
        self.stream.flush()

    def show(self, done, titles, left):
        if self.terminal:
            text = f"  {done}/{self.total}  {duration(left)} left  " + ", ".join(titles)
            columns = os.get_terminal_size(self.stream.fileno()).columns
            self.stream.write("\r\x1b[K" + text[:max(columns - 1, 20)])
            self.stream.flush()

    def finished(self, done, stage, seconds, left):
        self.say(f"  {done:3}/{self.total}  {stage.title}: {seconds:.1f} s"
                 + ("" if self.terminal else f"; about {duration(left)} left"))


def duration(seconds):
    return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"


class Running:
    """A stage's command at work, in a process group of its own."""

    def __init__(self, stage, ledger, launcher):
        ledger.prepare(stage)
        self.stage, self.started = stage, time.monotonic()
        work = os.path.abspath(ledger.work(stage))
        environment = dict(os.environ, MPLBACKEND="Agg",
                           ROS_MASTER_URI=f"http://127.0.0.1:{free_port()}", ROS_IP="127.0.0.1",
                           ROS_LOG_DIR=os.path.join(work, "ros_log"))
        environment.pop("ROS_HOSTNAME", None)
        with open(ledger.log(stage), "wb") as log, contextlib.ExitStack() as files:
            output = log
            if stage.stdout:
                output = files.enter_context(open(os.path.join(work, stage.stdout), "wb"))
            self.process = subprocess.Popen(
                argv(stage.command, work, launcher), cwd=ledger.folder, env=environment,
                stdin=subprocess.DEVNULL, stdout=output, stderr=log, start_new_session=True)

    def seconds(self):
        return time.monotonic() - self.started

    def signal(self, number):
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.process.pid, number)


def check_order(stages):
    """Every stage has its own name, and what it needs is made before it."""
    names, made = set(), {DESCRIPTION}
    for stage in stages:
        late = [name for name in stage.inputs if not os.path.isabs(name) and name not in made]
        if stage.name in names or late or made & set(stage.outputs):
            raise ValueError(f"stage {stage.name}: twice, or before {late}")
        names.add(stage.name)
        made |= set(stage.outputs)


class Runner:
    """Runs stages, each one only if it is not done; `jobs` at a time."""

    def __init__(self, stages, folder, jobs, launcher, stream=sys.stderr):
        check_order(stages)
        self.stages, self.jobs, self.launcher = stages, jobs, launcher
        self.ledger = Ledger(folder)
        self.progress = Progress(len(stages), stream)
        self.signalled = 0
        self.running = []
        self.known = 0.0  # [s] what the stages that ran took by the plan,
        self.taken = 0.0  # and in truth

    def run(self):
        """Raises StageError or Interrupted; what runs then is ended first."""
        handlers = {number: signal.signal(number, self._note) for number in
                    (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
        try:
            self._run()
        finally:
            self._stop()
            for number, handler in handlers.items():
                signal.signal(number, handler)

    def _note(self, number, _frame):
        self.signalled = self.signalled or number

    def _run(self):
        waiting = list(self.stages)
        while waiting or self.running:
            if self.signalled:
                raise Interrupted(self.signalled)
            for running in [one for one in self.running if one.process.poll() is not None]:
                self._end(running, waiting)
            for stage in [one for one in waiting if self._is_ready(one, waiting)]:
                if len(self.running) == self.jobs:
                    break
                if self.ledger.is_done(stage):
                    waiting.remove(stage)
                else:
                    waiting.remove(stage)
                    self.running.append(Running(stage, self.ledger, self.launcher))
            done = len(self.stages) - len(waiting) - len(self.running)
            self.progress.show(done, [one.stage.title for one in self.running], self._left(waiting))
            if self.running:
                time.sleep(TICK)

    def _is_ready(self, stage, waiting):
        """Whether no stage that is still to end makes one of its inputs."""
        open_ones = waiting + [running.stage for running in self.running]
        return not any(name in other.outputs for other in open_ones for name in stage.inputs)

    def _end(self, running, waiting):
        self.running.remove(running)
        stage, seconds, status = running.stage, running.seconds(), running.process.returncode
        if status:
            log = self.ledger.log(stage)
            with open(log, errors="replace", encoding="utf-8") as file:
                tail = "".join("    " + line for line in file.readlines()[-TAIL:])
            end = f"status {status}" if status > 0 else signal.Signals(-status).name
            raise StageError(f"stage {stage.name} ({stage.title}) failed with {end}\n"
                             f"  command: {stage.shown()}\n  log: {log}\n{tail}".rstrip())
        self.ledger.finish(stage, seconds)
        self.known += stage.seconds
        self.taken += seconds
        done = len(self.stages) - len(waiting) - len(self.running)
        self.progress.finished(done, stage, seconds, self._left(waiting))

    def _left(self, waiting):
        """[s] by the plan's times, corrected by how true they were so far."""
        pace = (self.taken + 10) / (self.known + 10)
        left = [pace * stage.seconds for stage in waiting]
        left += [max(pace * one.stage.seconds - one.seconds(), 0) for one in self.running]
        return max(sum(left) / self.jobs, max(left, default=0))

    def _stop(self):
        for running in self.running:
            running.signal(signal.SIGTERM)
        deadline = time.monotonic() + PATIENCE
        for running in self.running:
            try:
                running.process.wait(max(deadline - time.monotonic(), 0))
            except subprocess.TimeoutExpired:
                running.signal(signal.SIGKILL)
                running.process.wait()
        self.running = []
