"""The process of the readers: started when a file needs it, kept for those that follow, and gone with this one."""

from __future__ import annotations

import atexit
import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from threading import Lock, Timer
from typing import IO, cast

from lostmotion.files.child import CODE, MANY, ONE, REQUEST, SIZE, exactly
from lostmotion.files.limits import MOST_GIB, MOST_SECONDS

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
        self._process: subprocess.Popen[bytes] | None = None
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
        process = self._ready()
        patience = _Patience(process, seconds)
        ended = False
        try:
            code, found = _exchanged(process, REQUEST.pack(kind.encode(), memory, int(seconds) + 1, len(raw)), raw)
        except (OSError, EOFError):
            code, found, ended = _code_of(process), b"", True
            self.end()
        except BaseException:
            self.end()  # half an answer is still to come
            raise
        finally:
            patience.stop()
        if patience.over or self._files >= _MOST_FILES or _HOW == ONE:
            self.end()
        if patience.over and not found:
            raise ReaderDiedError(f"not read within {seconds:g} s; {MOST_SECONDS} allows more")
        if ended or code:
            raise (_EndedError if ended else ReaderDiedError)(_reason(code))
        return found

    def _ready(self) -> subprocess.Popen[bytes]:
        """A process that waits for a request: the one that is there, or another where it has ended."""
        if self._process is not None and self._process.poll() is not None:
            self.end()
        if self._process is None:
            self._process, self._files = _started(), 0
        self._files += 1
        return self._process

    def end(self) -> None:
        """End the process and what it has begun; nothing is lost with it."""
        process, self._process = self._process, None
        if process is not None:
            _kill(process)
            process.wait()
            _close(process)

    def forget(self) -> None:
        """In a process that was forked from this one: the readers are not its own."""
        process, self._process, self._lock = self._process, None, Lock()
        if process is not None:
            process.returncode = 0  # it cannot be waited for here
            _close(process)


class _Patience:
    """Ends a process that is not done in time."""

    def __init__(self, process: subprocess.Popen[bytes], seconds: float) -> None:
        self.over = False
        self._process = process
        self._timer = Timer(seconds, self._end)
        self._timer.daemon = True
        self._timer.start()

    def stop(self) -> None:
        self._timer.cancel()
        self._timer.join()

    def _end(self) -> None:
        self.over = True
        _kill(self._process)


def _started() -> subprocess.Popen[bytes]:
    command = [sys.executable, "-s", "-P", "-B", _CHILD, _HOW]
    try:
        return subprocess.Popen(  # noqa: S603  this Python and a script of ours
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            bufsize=0,
            env=_environment(),
            process_group=0 if _HOW == MANY else None,
        )
    except (OSError, ValueError) as error:
        raise ReaderDiedError(f"no process for its reader: {error}") from error


def _environment() -> dict[str, str]:
    """Packages from where this process has them, but not from the working folder; no other setting of Python."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    paths = os.pathsep.join(path for path in sys.path if path and Path(path).is_absolute())
    return {**kept, **_ONE_THREAD, **_NO_PLUGINS, "PYTHONPATH": paths}


def _exchanged(process: subprocess.Popen[bytes], head: bytes, raw: bytes) -> tuple[int, bytes]:
    """Exit code of the reader, and its answer."""
    asking, answering = _pipes(process)
    for data in (head, raw):
        rest = memoryview(data)
        while rest:
            rest = rest[asking.write(rest) :]
    (_, most, _, _) = REQUEST.unpack(head)
    pieces, taken = [], 0
    while size := SIZE.unpack(exactly(answering, SIZE.size))[0]:
        taken += size
        if taken > most:
            raise ReaderDiedError(TOO_MUCH)
        pieces.append(exactly(answering, size))
    return CODE.unpack(exactly(answering, CODE.size))[0], b"".join(pieces)


def _pipes(process: subprocess.Popen[bytes]) -> tuple[IO[bytes], IO[bytes]]:
    return cast("IO[bytes]", process.stdin), cast("IO[bytes]", process.stdout)


def _code_of(process: subprocess.Popen[bytes]) -> int:
    """Of a process that ends by itself, or has closed its pipes."""
    with suppress(subprocess.TimeoutExpired):
        return process.wait(1.0)
    return -signal.SIGKILL


def _kill(process: subprocess.Popen[bytes]) -> None:
    """With the reader that it has forked."""
    if _HOW != MANY:
        process.kill()
        return
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, signal.SIGKILL)


def _close(process: subprocess.Popen[bytes]) -> None:
    for pipe in _pipes(process):
        pipe.close()


def _reason(code: int) -> str:
    if code >= 0:
        return f"its reader ended with {code}" if code else "no answer of its reader"
    try:
        return f"it stops its reader by {signal.Signals(-code).name}"
    except ValueError:
        return f"it stops its reader by signal {-code}"


KEPT = ReaderProcess()
atexit.register(KEPT.end)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=KEPT.forget)
