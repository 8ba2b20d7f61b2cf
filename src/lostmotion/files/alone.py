"""Locks on files and folders, which the system takes away with the process that holds them."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

LOCKS = fcntl is not None
PATIENCE = 5.0  # s for others to give their names, which takes microseconds


def locked(number: int, patience: float = 0.0) -> bool:
    """Lock an open file or folder until it is closed; False where somebody else keeps it, or the drive has no locks."""
    until = time.monotonic() + patience
    while True:
        try:
            fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            if time.monotonic() >= until:
                return False
            time.sleep(0.001)
        except OSError:
            return False
        else:
            return True


@contextmanager
def alone(folder: Path) -> Iterator[bool]:
    """Whether other processes that give names in the folder wait for us; no file is left by it."""
    number = -1
    if LOCKS:
        with suppress(OSError):  # a folder that we may write and not read
            number = os.open(folder, os.O_RDONLY)
    try:
        yield number >= 0 and locked(number, PATIENCE)
    finally:
        if number >= 0:
            os.close(number)
