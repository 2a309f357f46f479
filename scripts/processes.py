"""The processes that this one has started, and their end."""
import os
import signal
import time

PATIENCE = 1.0  # [s] of SIGTERM, until SIGKILL


def children():
    """Process numbers of the children of this process that have not ended."""
    found = []
    for name in os.listdir("/proc"):
        if not name.isdigit():
            continue
        try:
            with open(f"/proc/{name}/stat", encoding="utf-8", errors="replace") as file:
                # The second field, in parentheses, may hold anything.
                state, parent = file.read().rpartition(")")[2].split()[:2]
        except (OSError, ValueError):
            continue  # it has ended meanwhile
        if int(parent) == os.getpid() and state not in "ZX":
            found.append(int(name))
    return found


def send(number, process):
    """Sends a signal to a process, and to its group if it leads one."""
    try:
        if os.getpgid(process) == process:
            os.killpg(process, number)
        else:
            os.kill(process, number)
    except OSError:
        pass  # it has ended meanwhile


def end_children():
    """Ends whatever this process has started and not ended, within PATIENCE."""
    for process in children():
        send(signal.SIGTERM, process)
    deadline = time.monotonic() + PATIENCE
    while children() and time.monotonic() < deadline:
        time.sleep(0.02)
    for process in children():
        send(signal.SIGKILL, process)
