"""Waiting for what a busy machine may be late with, and never for ever."""

import threading
import time
from contextlib import contextmanager

LONG = 120.0  # s; only what will never come takes so long


def until(there, seconds=LONG):
    """What `there` says at last."""
    end = time.monotonic() + seconds
    while not (found := there()):
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.01)
    return found


@contextmanager
def in_time(process, seconds=LONG):
    """Lines of a process are read; it is killed where they do not come, so that nobody waits for them."""
    timer = threading.Timer(seconds, process.kill)
    timer.start()
    try:
        yield process
    finally:
        timer.cancel()
