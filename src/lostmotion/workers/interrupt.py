"""A limit of time for one loop: first it is interrupted; where that does not help, its worker ends.

Python is interrupted between two of its instructions, in whatever thread it works. What is inside compiled code and
never comes back cannot be: there the process ends, a watch of the interpreter that needs no lock sees to it, and the
engine finds the loop as one that kills its worker.
"""

from __future__ import annotations

import ctypes
import faulthandler
import os
import threading
from collections.abc import Callable
from functools import cache
from typing import IO, TypeVar

from lostmotion.errors import SlowError

AGAIN = 1.0  # s between two tries: a handler of all errors may have swallowed the last one
HARD = 1.5  # times the limit, and a second, after which the worker ends
Result = TypeVar("Result")
_MAY_END = threading.Event()


class _Over(BaseException):
    """No handler of errors takes it for one of the loop."""


def may_end() -> None:
    """Said by a process that is a worker and nothing else: it may be ended."""
    _MAY_END.set()


def within(minutes: float | None, work: Callable[..., Result], *given: object) -> Result:
    """Result of `work(*given)`.

    Parameters
    ----------
    minutes : float, optional
        On the clock; None: as long as it takes.

    Raises
    ------
    SlowError
        It took longer.
    """
    if minutes is None:
        return work(*given)
    watch = _Watch(60.0 * minutes)
    try:
        try:
            return work(*given)
        finally:
            watch.end()
    except _Over:
        watch.end()  # it may have been hit by what it ends
        remedy = "give a loop more minutes, or a shorter window"
        raise SlowError(f"expected a result within {minutes:g} minutes, got none; {remedy}") from None


class _Watch:
    """A thread that interrupts the one by which it was made."""

    def __init__(self, seconds: float) -> None:
        self.seconds, self.thread = seconds, threading.get_ident()
        self.ended, self.lock = threading.Event(), threading.Lock()
        if _MAY_END.is_set():
            faulthandler.dump_traceback_later(HARD * seconds + 1.0, exit=True, file=_nowhere())
        threading.Thread(target=self._wait, daemon=True).start()

    def end(self) -> None:
        """Nothing is interrupted any more.

        What was sent before is raised here at the latest. It is not taken back: Python 3.11 then believes for ever that
        something is left to raise, and a traced thread (a debugger, coverage) never goes on.
        """
        while not self.ended.is_set():
            try:
                with self.lock:
                    self.ended.set()
            except _Over:
                continue
        if _MAY_END.is_set():
            faulthandler.cancel_dump_traceback_later()

    def _wait(self) -> None:
        wait = self.seconds
        while not self.ended.wait(wait):
            with self.lock:
                if not self.ended.is_set():
                    _interrupt(self.thread)
            wait = AGAIN


def _interrupt(thread: int) -> None:
    """Raise `_Over` there, between two instructions."""
    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(_Over))


@cache
def _nowhere() -> IO[str]:
    return open(os.devnull, "w", encoding="utf-8")  # noqa: PTH123  as long as the process lives
