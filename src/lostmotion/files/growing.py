"""Where rows come from: a file that grows, or a stream such as standard input."""

from __future__ import annotations

import hashlib
import os
import select
from pathlib import Path
from threading import Event
from typing import Any, BinaryIO, Protocol

from lostmotion.errors import DataError, FileAccessError

HEAD = 4096  # bytes at the start that make a file known again
TAIL = 256  # bytes before the place reached


class Source(Protocol):
    """What a follower needs of a source."""

    name: str
    ended: bool

    def read(self, size: int) -> bytes:
        """Up to `size` further bytes, none where there are none now."""

    def wait(self, seconds: float, stop: Event) -> None:
        """Wait until there may be more, `seconds` have passed, or `stop` is set."""

    def mark(self, offset: int) -> dict[str, Any]:
        """What makes the first `offset` bytes known again, JSON-ready."""

    def close(self) -> None:
        """Let go of the file."""


class GrowingFile:
    """File that another program appends to.

    Parameters
    ----------
    path : Path
        A regular file.
    offset : int
        Bytes that were taken before.
    mark : dict, optional
        From :meth:`mark` at that time; the file must still begin with those bytes.

    Raises
    ------
    FileAccessError
        No such file, or not a regular one.
    DataError
        The file is not the one that `mark` describes: replaced, rewritten or cut.
    """

    def __init__(self, path: Path, offset: int = 0, mark: dict[str, Any] | None = None) -> None:
        self.name, self.ended = path.name, False
        self._path, self._offset = path, offset
        try:
            if path.exists() and not path.is_file():
                raise FileAccessError(f"expected a regular file, got {str(path)!r}; pipe anything else into '-'")
            self._file = path.open("rb", buffering=0)
        except FileNotFoundError as error:
            raise FileAccessError(f"expected a file, got no such file {str(path)!r}; check the path") from error
        except OSError as error:
            reason = error.strerror or str(error)
            raise FileAccessError(f"expected a readable file, got {reason!r} for {str(path)!r}; check it") from error
        self._idle = False
        self._mark = mark or self.mark(offset)
        try:
            self._check()
        except DataError:
            self.close()
            raise
        self._file.seek(offset)

    def read(self, size: int) -> bytes:
        """Up to `size` further bytes, none where there are none now.

        Raises
        ------
        DataError
            The file was replaced, rewritten or cut in the meantime.
        """
        block = self._file.read(size)
        if self._idle or not block:
            self._check()
        if not block:
            self._check_name()
        self._idle = not block
        self._offset += len(block)
        return block

    def wait(self, seconds: float, stop: Event) -> None:
        """Sleep; whether rows have come is seen by reading."""
        stop.wait(seconds)

    def mark(self, offset: int) -> dict[str, Any]:
        """Sizes and hashes of the first bytes and of those before `offset`."""
        head, tail = min(HEAD, offset), min(TAIL, offset)
        return {"offset": offset, "head": self._hash(0, head), "tail": self._hash(offset - tail, offset)}

    def close(self) -> None:
        """Let go of the file."""
        self._file.close()

    def _hash(self, start: int, stop: int) -> str:
        here = self._file.tell()
        self._file.seek(start)
        found = hashlib.sha256(self._file.read(stop - start)).hexdigest()
        self._file.seek(here)
        return found

    def _check(self) -> None:
        """Refuse a file that is shorter than what was read, or differs in it."""
        size = os.fstat(self._file.fileno()).st_size
        if size < max(self._offset, self._mark["offset"]):
            raise self._other(f"one of {size} bytes, of which {self._offset} were read before")
        if self.mark(self._mark["offset"]) != self._mark:
            raise self._other("other bytes in the part that was read before")
        if self._offset > self._mark["offset"]:
            self._mark = self.mark(self._offset)

    def _check_name(self) -> None:
        """Refuse another file that took the place of ours, once ours is read to its end."""
        try:
            now = self._path.stat()
        except FileNotFoundError:
            return  # a writer may be about to put it back
        here = os.fstat(self._file.fileno())
        if (now.st_ino, now.st_dev) != (here.st_ino, here.st_dev):
            raise self._other("another file of that name (rotated?)")

    def _other(self, got: str) -> DataError:
        return DataError.expected(
            f"{self.name!r} to be the file that was read before, only longer",
            got,
            "give the old file, or start anew with another state file; rotated logs can be piped in (tail -F | .. -)",
        )


class GrowingStream:
    """Standard input or another stream of bytes.

    Where the platform cannot tell whether bytes wait (pipes on Windows, streams in memory) reading blocks.
    """

    def __init__(self, stream: BinaryIO, name: str = "standard input") -> None:
        self.name, self.ended = name, False
        self._stream = stream
        try:
            self._descriptor: int | None = stream.fileno()
            select.select([self._descriptor], [], [], 0.0)
        except (OSError, ValueError):
            self._descriptor = None

    def read(self, size: int) -> bytes:
        """Up to `size` further bytes, none where there are none now."""
        if self._descriptor is None:
            block = self._stream.read(size)
        elif not self._ready(0.0):
            return b""
        else:
            block = os.read(self._descriptor, size)
        self.ended = not block
        return block

    def wait(self, seconds: float, stop: Event) -> None:
        """Wait for bytes."""
        if self._descriptor is not None and not stop.is_set():
            self._ready(seconds)

    def mark(self, offset: int) -> dict[str, Any]:
        """Nothing: what has passed cannot be read again."""
        return {"offset": offset}

    def close(self) -> None:
        """Leave the stream open: it is not ours."""

    def _ready(self, seconds: float) -> bool:
        return self._descriptor is None or bool(select.select([self._descriptor], [], [], seconds)[0])
