"""``python -P -m lostmotion.workers MEMORY NICER``: a worker; calls in, results out, until its parent ends.

Calls and results are pickled: both ends are this program, and the parent has decided what is called.
"""

from __future__ import annotations

import os
import pickle
import queue
import signal
import sys
import threading
from contextlib import suppress
from typing import Any

from lostmotion.errors import SetupError
from lostmotion.workers import interrupt, isolated
from lostmotion.workers.limits import limit
from lostmotion.workers.process import SIZE, exactly
from lostmotion.workers.script import Script, import_script

READY, SCRIPT, COMMON, CALL = "ready", "script", "common", "call"
RESULT, ERROR, UNABLE = "result", "error", "unable"


class Channel:
    """Messages from and to the process that has started this one; what is printed goes to standard error."""

    def __init__(self) -> None:
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent, which then ends this process
        isolated.in_empty_folder()
        self._out = os.fdopen(os.dup(1), "wb")
        self._in = os.fdopen(os.dup(0), "rb")
        nowhere = os.open(os.devnull, os.O_RDWR)
        os.dup2(nowhere, 0)
        try:
            os.dup2(2, 1)
        except OSError:  # there is no standard error
            os.dup2(nowhere, 1)
        os.close(nowhere)
        self._waiting: queue.SimpleQueue[bytes] = queue.SimpleQueue()
        threading.Thread(target=self._listen, daemon=True).start()

    def receive(self) -> bytes:
        """Wait for a message."""
        return self._waiting.get()

    def send(self, message: bytes) -> None:
        """Send a message; this process ends where nobody waits for it."""
        try:
            self._out.write(SIZE.pack(len(message)) + message)
            self._out.flush()
        except OSError:
            os._exit(0)

    def _listen(self) -> None:
        """Read at once, so that the parent never waits, until it is gone: then nobody wants the result."""
        with suppress(EOFError, OSError):
            while True:
                (size,) = SIZE.unpack(exactly(self._in, SIZE.size))
                self._waiting.put(exactly(self._in, size))
        os._exit(0)


def main() -> None:
    """Do one call after another."""
    memory, nicer = map(int, sys.argv[1:])
    limit(memory, nicer)
    interrupt.may_end()
    channel = Channel()
    channel.send(pickle.dumps((READY, None)))
    common: tuple[Any, ...] = ()
    origin: Script | None = None
    while True:
        message = channel.receive()
        try:
            kind, function, given = _loaded(message, origin)
        except BaseException as error:  # noqa: BLE001  what it sent is not on this machine
            said = f"expected work that can be sent to a worker, got {one_line(error)}; check the source"
            channel.send(_answer(UNABLE, SetupError(said)))
            continue
        if kind == SCRIPT:
            (origin,) = given
        elif kind == COMMON:
            common = given
        else:
            channel.send(_done(function, (*common, *given)))


def _loaded(message: bytes, origin: Script | None) -> Any:
    try:
        return pickle.loads(message)  # noqa: S301  of the parent
    except (ImportError, AttributeError):
        if origin is None:
            raise
        import_script(origin)
        return pickle.loads(message)  # noqa: S301


def _done(function: Any, given: tuple[Any, ...]) -> bytes:
    try:
        return _answer(RESULT, function(*given))
    except SetupError as error:
        return _answer(UNABLE, error)
    except Exception as error:  # noqa: BLE001  it is raised, or told, where it was called
        return _answer(ERROR, error)


def _answer(kind: str, value: Any) -> bytes:
    """Message; of an error that cannot be sent its words."""
    try:
        message = pickle.dumps((kind, value))
        if isinstance(value, Exception):
            pickle.loads(message)  # noqa: S301  our own bytes: an error with arguments of its own may be no value again
    except Exception as error:  # noqa: BLE001  many kinds
        said = value if isinstance(value, Exception) else error
        return pickle.dumps((ERROR if kind == RESULT else kind, RuntimeError(one_line(said))))
    return message


def one_line(error: BaseException) -> str:
    """Error in one line."""
    said = " ".join(str(error).split())
    return f"{type(error).__name__}: {said}"[:500] if said else type(error).__name__
