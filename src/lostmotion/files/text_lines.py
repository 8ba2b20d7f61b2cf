"""Blocks of bytes -> complete lines, and how far they were taken; a line that is still being written waits."""

from __future__ import annotations

from collections.abc import Callable

from lostmotion.errors import DataError
from lostmotion.files.text import decode

BLOCK = 1 << 20  # bytes read at a time
LONGEST_LINE = 1 << 20  # bytes: no row of a loop is longer


def line_end(start: bytes) -> bytes:
    r"""Line end of a text by its first one: LF (CR LF included), a bare CR, or empty while none is complete.

    Examples
    --------
    >>> line_end(b"OP,PV\r\n1"), line_end(b"OP,PV\r1"), line_end(b"OP,PV\r")
    (b'\n', b'\r', b'')
    """
    for place, byte in enumerate(start):
        if byte == 0x0A:
            return b"\n"
        if byte == 0x0D and start[place:].lstrip(b"\r"):
            return b"\n" if start[place:].lstrip(b"\r").startswith(b"\n") else b"\r"
    return b""


class Lines:
    r"""Complete lines of a source that grows.

    Parameters
    ----------
    read : callable
        ``read(size)`` gives up to `size` further bytes, none where there are none yet.
    source : str
        Name for messages.
    offset : int
        Bytes of the source that lie before what `read` gives first.
    end : bytes
        Line end, if it is known already.

    Examples
    --------
    >>> import io
    >>> lines = Lines(io.BytesIO(b"OP,PV\r\n1,2\r\n3,").read, "a.csv")
    >>> lines.fill(), lines.peek(), lines.take(5), lines.offset
    (14, [b'OP,PV', b'1,2'], 2, 12)
    """

    def __init__(self, read: Callable[[int], bytes], source: str, offset: int = 0, end: bytes = b"") -> None:
        self.offset = offset
        self.end = end
        self._read, self._source = read, source
        self._rest = b""
        self._lines: list[bytes] = []
        self._taken = 0

    def __len__(self) -> int:
        return len(self._lines) - self._taken

    @property
    def waiting(self) -> bytes:
        """Beginning of a line whose end has not come."""
        return self._rest

    def fill(self) -> int:
        """Read one block; return its size in bytes.

        Raises
        ------
        DataError
            A line of more than 1 MiB: binary data, or something else than rows.
        """
        block = self._read(BLOCK)
        self._rest += block
        if not self.end:
            self.end = line_end(self._rest)
        if self.end:
            *complete, self._rest = self._rest.split(self.end)
            self._lines = self._lines[self._taken :] + complete
            self._taken = 0
        if len(self._rest) > LONGEST_LINE:
            decode(self._rest[:4096], self._source)  # says so where it is binary
            raise DataError.expected(
                "lines of rows", f"one of more than {LONGEST_LINE} bytes in {self._source!r}", "check the export"
            )
        return len(block)

    def peek(self, most: int | None = None) -> list[bytes]:
        """Give complete lines that were not taken yet, without their ends."""
        stop = None if most is None else self._taken + most
        return [line.rstrip(b"\r") for line in self._lines[self._taken : stop]]

    def take(self, most: int) -> int:
        """Pass over up to `most` complete lines; return how many."""
        lines = self._lines[self._taken : self._taken + most]
        self._taken += len(lines)
        self.offset += sum(map(len, lines)) + len(lines) * len(self.end)
        return len(lines)
