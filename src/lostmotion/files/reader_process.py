"""The process of the readers: started when a file needs it, kept for those that follow, and gone with this one."""

from __future__ import annotations

import atexit
import os
import sys
from pathlib import Path
from threading import Lock

from lostmotion.files.child import CODE, MANY, ONE, PIECE, REQUEST
from lostmotion.files.limits import MOST_GIB, MOST_SECONDS
from lostmotion.workers.process import Process, signal_name

_CHILD = str(Path(__file__).with_name("child.py"))
_HOW = MANY if sys.platform == "linux" else ONE  # elsewhere what packages have loaded may not bear a fork
_MOST_FILES = 1000  # of one process: what its memory gathers from large files ends with it
_ONE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "POLARS_MAX_THREADS": "1",
    "_RJEM_MALLOC_CONF": "background_thread:false",  # of the allocator of Polars
}  # threads reserve memory that the limit counts, and are lost in a fork
_NO_PLUGINS = {"HDF5_PLUGIN_PRELOAD": "::"}  # a file names filters; none is loaded for it
TOO_MUCH = f"more memory than a file of its size may take; {MOST_GIB} allows more"


class ReaderDiedError(Exception):
    """The process gave no answer; the text says why."""


class _EndedError(ReaderDiedError):
    """The process itself has ended, not a reader that it had forked: that need not be the fault of the file."""


class ReaderProcess:
    """At most one process of :mod:`lostmotion.files.child`, which all threads share."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._process: Process | None = None
        self._files = 0

    def answer(self, kind: str, raw: bytes, memory: int, seconds: float) -> bytes:
        """Answer to one request.

        Parameters
        ----------
        kind : str
            One of that module.
        raw : bytes
            What it wants.
        memory : int
            Bytes that its reader may take, and that the answer may have.
        seconds : float
            Patience.

        Raises
        ------
        ReaderDiedError
            Killed by a signal, too slow, not started.
        """
        with self._lock:
            kept = self._process is not None and _HOW == MANY
            try:
                return self._asked(kind, raw, memory, seconds)
            except _EndedError:
                if not kept:
                    raise
                return self._asked(kind, raw, memory, seconds)  # perhaps it had ended before it was asked

    def _asked(self, kind: str, raw: bytes, memory: int, seconds: float) -> bytes:
        process, ended = self._ready(), False
        with process.within(seconds) as late:
            try:
                code, found = _exchanged(process, REQUEST.pack(kind.encode(), memory, int(seconds) + 1, len(raw)), raw)
            except (OSError, EOFError):
                code, found, ended = process.ended(), b"", True
                self.end()
            except BaseException:
                self.end()  # half an answer is still to come
                raise
        if late.is_set() or self._files >= _MOST_FILES or _HOW == ONE:
            self.end()
        if late.is_set() and not found:
            raise ReaderDiedError(f"not read within {seconds:g} s; {MOST_SECONDS} allows more")
        if ended or code:
            raise (_EndedError if ended else ReaderDiedError)(_reason(code))
        return found

    def _ready(self) -> Process:
        """A process that waits for a request: the one that is there, or another where it has ended."""
        if self._process is not None and self._process.exit_code is not None:
            self.end()
        if self._process is None:
            self._process, self._files = _started(), 0
        self._files += 1
        return self._process

    def end(self) -> None:
        """End the process and what it has begun; nothing is lost with it."""
        process, self._process = self._process, None
        if process is not None:
            process.end()
            process.forget()

    def forget(self) -> None:
        """In a process that was forked from this one: the readers are not its own."""
        process, self._process, self._lock = self._process, None, Lock()
        if process is not None:
            process.forget()


def _started() -> Process:
    python = {name: "" for name in os.environ if name.startswith("PYTHON")}  # no other setting of Python
    try:
        return Process(["-s", "-B", _CHILD, _HOW], {**python, **_ONE_THREAD, **_NO_PLUGINS}, quiet=True, longest=PIECE)
    except (OSError, ValueError) as error:
        raise ReaderDiedError(f"no process for its reader: {error}") from error


def _exchanged(process: Process, head: bytes, raw: bytes) -> tuple[int, bytes]:
    """Exit code of the reader, and its answer."""
    process.write(head, raw)
    (_, most, _, _) = REQUEST.unpack(head)
    pieces, taken = [], 0
    while piece := process.receive():
        taken += len(piece)
        if taken > most:
            raise ReaderDiedError(TOO_MUCH)
        pieces.append(piece)
    code = process.receive()
    if len(code) != CODE.size:
        raise EOFError
    return CODE.unpack(code)[0], b"".join(pieces)


def _reason(code: int) -> str:
    if code >= 0:
        return f"its reader ended with {code}" if code else "no answer of its reader"
    return f"it stops its reader by {signal_name(code)}"


KEPT = ReaderProcess()
atexit.register(KEPT.end)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=KEPT.forget)
