"""What the commands of this package have in common."""
import argparse
import signal
import sys


def parser(name, description):
    return argparse.ArgumentParser(prog=name, description=description,
                                   formatter_class=argparse.RawDescriptionHelpFormatter,
                                   epilog="exit status: 0 done; 2 wrong arguments or files")


def run(name, main):
    """The exit status of main(): 0, or 2 after a line that says what is wrong with a file."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # end quietly, also with the node that started it
    try:
        main()
    except OSError as error:
        complaint = f"{error.filename}: {error.strerror}" if error.filename else error
    except ValueError as error:
        complaint = error
    else:
        return 0
    print(f"{name}: {complaint}", file=sys.stderr)
    return 2
