"""What the commands of this package have in common."""
import argparse
import sys
import time


def parser(name, description):
    return argparse.ArgumentParser(prog=name, description=description,
                                   formatter_class=argparse.RawDescriptionHelpFormatter,
                                   epilog="exit status: 0 done; 2 wrong arguments or files")


def run(name, main):
    """The exit status of main(): 0, or 2 after a line that says what is wrong with a file."""
    try:
        main()
    except KeyboardInterrupt:  # end quietly, also with the node that started it
        return 130
    except OSError as error:
        complaint = f"{error.filename}: {error.strerror}" if error.filename else error
    except ValueError as error:
        complaint = error
    else:
        return 0
    print(f"{name}: {complaint}", file=sys.stderr)
    return 2


class Progress:
    """A bar with the time left, on a terminal; elsewhere nothing."""

    WIDTH = 40

    def __init__(self):
        self.shown = sys.stderr.isatty()
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
