"""What the commands of this package have in common."""
import argparse
import contextlib
import errno
import os
import sys
import time

from threelink_report.files import OutputError

DONE, FAILED, MISUSE, INTERRUPTED = 0, 1, 2, 130


class Parser(argparse.ArgumentParser):
    def print_help(self, file=None):
        say(self.format_help().rstrip("\n"))


def parser(name, description):
    return Parser(prog=name, description=description,
                  formatter_class=argparse.RawDescriptionHelpFormatter,
                  epilog="exit status: 0 done; 1 the output cannot be written; "
                         "2 wrong arguments or files")


def output(path, source):
    """The path of a file to write, made from the file `source`. Raises ValueError if that is wrong."""
    if os.path.exists(path):
        if os.path.samefile(path, source):
            raise ValueError(f"--out {path}: it is the input; nothing is written over that")
        if not os.path.isfile(path):
            raise ValueError(f"--out {path}: it is there, and is not a file")
    folder = os.path.dirname(path) or "."
    if not os.path.isdir(folder):
        raise ValueError(f"--out {path}: there is no folder {folder}")
    return path


def run(name, main):
    """The exit status of main(); what is wrong is said in one line."""
    try:
        main()
        status = DONE
    except SystemExit as end:  # of argparse
        status = end.code
    except KeyboardInterrupt:  # end quietly, also with the node that started it
        return INTERRUPTED
    except OutputError as error:
        status = complain(name, f"{error.filename} cannot be written: {error.strerror}", FAILED)
    except MemoryError:
        status = complain(name, "there is not enough memory", FAILED)
    except OSError as error:
        status = complain(name, f"{error.filename}: {error.strerror}" if error.filename else error,
                          MISUSE)
    except ValueError as error:
        status = complain(name, error, MISUSE)
    try:
        if sys.stdout:
            sys.stdout.flush()
    except OSError as error:
        leave_stdout()
        status = status or complain(name, f"standard output cannot be written: {error.strerror}", FAILED)
    return status


def complain(name, text, status):
    with contextlib.suppress(OSError):
        print(f"{name}: {text}", file=sys.stderr, flush=True)
    return status


def say(text):
    """A line on standard output, or an OutputError."""
    try:
        if not sys.stdout:  # it was closed from the start
            raise OSError(errno.EBADF, os.strerror(errno.EBADF))
        print(text, flush=True)
    except OSError as error:
        leave_stdout()
        raise OutputError(error.errno, error.strerror, "standard output") from error


def leave_stdout():
    """So that the end of the program does not try again to write what is left."""
    if sys.stdout:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)


class Progress:
    """A bar with the time left, on a terminal; elsewhere nothing."""

    WIDTH = 40

    def __init__(self):
        self.shown = bool(sys.stderr) and sys.stderr.isatty()
        self.start = time.monotonic()

    def __call__(self, share):
        if not self.shown:
            return
        full = int(self.WIDTH * share)
        left = (time.monotonic() - self.start) * (1 - share) / share
        end = "\n" if share == 1 else ""
        bar = "#" * full + "." * (self.WIDTH - full)
        print(f"\r[{bar}] {100 * share:3.0f} %, {left:.0f} s left ", end=end, file=sys.stderr,
              flush=True)
