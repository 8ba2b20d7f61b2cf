"""Locks on files and folders, which the system takes away with the process that holds them.

The package filelock locks files that it makes itself, so that a folder would keep one; it names the holder no better.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TypeVar

if sys.platform == "win32":
    import msvcrt

    def _lock(number: int) -> None:
        msvcrt.locking(number, msvcrt.LK_NBLCK, 1)
else:
    import fcntl

    def _lock(number: int) -> None:
        fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)


TIMEOUT = 5.0  # s for others to give their names, which takes microseconds, or to close a file (a search for viruses)
Result = TypeVar("Result")


def retried(work: Callable[[], Result], timeout: float = TIMEOUT) -> Result:
    """Result of `work`, which is tried again while others are in its way.

    Raises
    ------
    BlockingIOError, PermissionError
        They still are: of locks on POSIX, of locks and of open files on Windows.
    """
    until = time.monotonic() + timeout
    while True:
        try:
            return work()
        except (BlockingIOError, PermissionError):
            if time.monotonic() >= until:
                raise
            time.sleep(0.001)


def locked(number: int, timeout: float = 0.0) -> bool:
    """Lock an open file or folder until it is closed; False where somebody else keeps it, or the drive has no locks."""
    try:
        retried(lambda: _lock(number), timeout)
    except OSError:
        return False
    return True


@contextmanager
def alone(folder: Path) -> Iterator[bool]:
    """Whether other processes that give names in the folder wait for us; no file is left by it."""
    number = -1
    with suppress(OSError):  # a folder that we may write and not read
        number = _opened(folder)
    try:
        yield number >= 0 and locked(number, TIMEOUT)
    finally:
        if number >= 0:
            os.close(number)
            if sys.platform == "win32":
                with suppress(OSError):  # the one who waits has it open, and removes it
                    _beside(folder).unlink()


def _opened(folder: Path) -> int:
    """Number of the folder; Windows opens none, and locks a file in it."""
    if sys.platform == "win32":
        return retried(lambda: os.open(_beside(folder), os.O_RDWR | os.O_CREAT))
    return os.open(folder, os.O_RDONLY)


def _beside(folder: Path) -> Path:
    return folder / ".lostmotion.lock"
