"""Waiting for conditions, for the node tests."""
import time


def wait(condition, seconds=20.0):
    """True as soon as the condition holds, False if it does not within the deadline."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.005)
    return True
