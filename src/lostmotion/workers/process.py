"""Process: an isolated child that takes and gives messages, with a limit of time, and ends with its parent.

A message is its length, 8 bytes, and so many bytes more. What the bytes are is up to who sends them: plain values where
the child reads what others wrote, pickled ones between two parts of this program.
"""

from __future__ import annotations

import os
import signal
import struct
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from typing import IO

from lostmotion.workers.isolated import start

SIZE = struct.Struct("<Q")
PIECE = 1 << 20  # bytes that are read at once
LONGEST = 1 << 40  # bytes of a message: more is no message of ours
END = 1.0  # s in which the exit code of a child must be there whose pipe has ended


class Process:
    """A child of this process.

    Parameters
    ----------
    words : sequence of str
        As in :func:`lostmotion.workers.isolated.start`.
    environment : mapping, optional
        The same.
    quiet : bool
        The same.
    longest : int
        Bytes of a message of the child; a longer one ends it.

    Raises
    ------
    OSError
        It cannot be started.
    """

    def __init__(
        self,
        words: Sequence[str],
        environment: Mapping[str, str] | None = None,
        *,
        quiet: bool = False,
        longest: int = LONGEST,
    ) -> None:
        self._process: subprocess.Popen[bytes] = start(words, environment, quiet=quiet)
        self._longest = longest
        self._kills = threading.Lock()
        assert self._process.stdin is not None  # noqa: S101  pipes
        assert self._process.stdout is not None  # noqa: S101
        self._to: IO[bytes] = self._process.stdin
        self._from: IO[bytes] = self._process.stdout

    @property
    def pid(self) -> int:
        """Number of the process."""
        return self._process.pid

    @property
    def exit_code(self) -> int | None:
        """None: it runs; negative: the signal that has ended it."""
        return self._process.poll()

    def send(self, message: bytes) -> None:
        """Send a message.

        Raises
        ------
        OSError
            Nobody reads it any more.
        """
        self.write(SIZE.pack(len(message)), message)

    def write(self, *parts: bytes) -> None:
        """Write bytes as they are, for a child that takes something else than messages."""
        try:
            for part in parts:
                rest = memoryview(part)
                while rest:
                    rest = rest[self._to.write(rest) :]
        except ValueError as error:  # the pipe was closed
            raise BrokenPipeError from error

    def receive(self) -> bytes:
        """Wait for a message.

        Raises
        ------
        EOFError
            The child has ended, or has been killed, or sends what is no message.
        """
        try:
            (size,) = SIZE.unpack(exactly(self._from, SIZE.size))
            if size > self._longest:
                raise EOFError
            return exactly(self._from, size)
        except (OSError, ValueError) as error:  # the pipe was closed
            raise EOFError from error

    @contextmanager
    def within(self, seconds: float) -> Iterator[threading.Event]:
        """Kill the child if what is done inside takes longer; the event says that it has been."""
        late = threading.Event()

        def end() -> None:
            late.set()
            self.kill()

        timer = threading.Timer(seconds, end)
        timer.daemon = True
        timer.start()
        try:
            yield late
        finally:
            timer.cancel()
            timer.join()

    def kill(self) -> None:
        """End it, and what it has started in its group; any thread may."""
        with self._kills, suppress(OSError):
            if self._process.returncode is not None:
                return
            if sys.platform == "win32":
                self._process.kill()
            else:
                os.killpg(self._process.pid, signal.SIGKILL)

    def end(self) -> int:
        """Kill it where it runs, and return its exit code."""
        self.kill()
        return self._process.wait()

    def ended(self) -> int:
        """Exit code of a child whose messages have ended; it is killed where it goes on."""
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(END)
        return self.end()

    def forget(self) -> None:
        """Close its pipes, which ends it; all that a fork of this process may do."""
        if self._process.returncode is None:
            self._process.returncode = 0  # only its parent can wait for it
        for pipe in (self._to, self._from):
            with suppress(OSError):
                pipe.close()


def exactly(stream: IO[bytes], size: int) -> bytes:
    """So many bytes.

    Raises
    ------
    EOFError
        There are fewer.
    """
    pieces = []
    while size:
        piece = stream.read(min(size, PIECE))
        if not piece:
            raise EOFError
        pieces.append(piece)
        size -= len(piece)
    return pieces[0] if len(pieces) == 1 else b"".join(pieces)


def death(code: int) -> str:
    """How a child has ended, in words.

    Examples
    --------
    >>> death(-9), death(3)
    ('was killed by SIGKILL', 'ended with code 3')
    """
    return f"was killed by {signal_name(code)}" if code < 0 else f"ended with code {code}"


def signal_name(code: int) -> str:
    """Name of the signal of a negative exit code."""
    try:
        return signal.Signals(-code).name
    except ValueError:
        return f"signal {-code}"
