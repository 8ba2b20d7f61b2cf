"""Bytes of a text -> blocks of whole lines and which of these are rows: a long file is never held as lines."""

from __future__ import annotations

import re
from array import array
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from lostmotion.arrays import IntArray

BLOCK = 1 << 23  # bytes: some 100,000 rows, parsed at a time
_LINE_END = re.compile(rb"\r\n?|\n")
_DOUBTFUL = np.isin(np.arange(256), list(b" \t#/\n"))  # first bytes of lines that may be blank or a comment
_LF = ord("\n")
_NOTHING = b' ,;\t"'


@dataclass(frozen=True, eq=False)
class Block:
    """Place of some lines: bytes, number of the first line (from 1), and which of the lines are rows; None: all."""

    start: int
    stop: int
    line: int
    count: int
    kept: IntArray | None = None

    @property
    def rows(self) -> int:
        """How many rows it holds."""
        return self.count if self.kept is None else len(self.kept)

    @property
    def numbers(self) -> IntArray:
        """Line in the file of each row."""
        return self.line + (np.arange(self.count) if self.kept is None else self.kept)


@dataclass(frozen=True, eq=False)
class Content:
    """Bytes of a text and how they are encoded: "utf-8" or "latin-1"; line ends LF, CR LF or CR."""

    raw: bytes
    encoding: str = "utf-8"

    def text(self, start: int, stop: int) -> bytes:
        """UTF-8 with LF between the lines, and none at the end."""
        ended = stop > start and self.raw[stop - 1] == _LF and self.raw[stop - 2 : stop - 1] != b"\r"
        piece = self.raw[start : stop - ended]  # a second copy would take its time
        if self.encoding != "utf-8":
            piece = piece.decode(self.encoding).encode()
        if b"\r" in piece:
            piece = piece.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
        return piece if ended else piece.removesuffix(b"\n")

    def rows(self, block: Block) -> bytes:
        """Rows of a block, without what is none."""
        text = self.text(block.start, block.stop)
        if block.kept is None:
            return text
        lines = text.split(b"\n")
        return b"\n".join([lines[place] for place in block.kept.tolist()])


def cuts(raw: bytes, size: int = BLOCK) -> Iterator[tuple[int, int]]:
    r"""Beginnings and ends of blocks of at least `size` bytes: at line ends, and never within a quoted cell.

    Examples
    --------
    >>> list(cuts(b'a,b\r\n1,"x\r\ny"\r\n3,4', 3)), list(cuts(b"a\rb\rc", 1))
    ([(0, 5), (5, 15), (15, 18)], [(0, 2), (2, 4), (4, 5)])
    """
    start = 0
    while start < len(raw):
        stop = _line_end(raw, start + size)
        while stop < len(raw) and raw.count(b'"', start, stop) % 2:
            stop = _line_end(raw, stop + size)
        yield start, stop
        start = stop


def _line_end(raw: bytes, place: int) -> int:
    found = _LINE_END.search(raw, place - 1)
    return len(raw) if found is None else found.end()


def find_blocks(
    content: Content, spans: Sequence[tuple[int, int]], begin: int, header: str, is_row: Callable[[str], bool]
) -> tuple[list[Block], int]:
    """Blocks with the rows of a text, and how often the header stands again in it.

    Parameters
    ----------
    content : Content
    spans : sequence of (int, int)
        From :func:`cuts`.
    begin : int
        Lines before the first row.
    header : str
        A line that is no row.
    is_row : callable
        Tells a row from a blank line or a comment.
    """
    blocks, line, again = [], 1, 0
    for start, stop in spans:
        text = content.text(start, stop)
        lines = text.count(b"\n") + 1
        kept, headers = _kept(text, header, is_row)
        if line == 1:
            places = np.arange(lines) if kept is None else kept
            kept = places[places >= begin]
            headers = text.decode().split("\n")[begin:].count(header)
        blocks.append(Block(start, stop, line, lines, kept))
        line, again = line + lines, again + headers
    while blocks:
        blocks[-1] = _without_tail(content, blocks[-1])
        if blocks[-1].rows:
            break
        blocks.pop()
    return [block for block in blocks if block.rows], again


def _kept(text: bytes, header: str, is_row: Callable[[str], bool]) -> tuple[IntArray | None, int]:
    """Lines that are rows, None for all; and how many are the header again. Most blocks need no look at each line."""
    codes = np.frombuffer(text, dtype=np.uint8)
    starts = np.r_[0, np.flatnonzero(codes == 0x0A) + 1]
    first = codes[np.minimum(starts, len(codes) - 1)] if len(codes) else np.array([0x0A])
    if len(codes) and codes[-1] != 0x0A and not _DOUBTFUL[first].any() and header.encode() not in text:
        return None, 0
    lines = text.decode().split("\n")
    kept = np.array([place for place, line in enumerate(lines) if is_row(line) and line != header], dtype=np.int64)
    return (None if len(kept) == len(lines) else kept), lines.count(header)


def _without_tail(content: Content, block: Block) -> Block:
    """Block without rows of empty cells at its end."""
    lines = content.text(block.start, block.stop).split(b"\n")
    kept = np.arange(len(lines)) if block.kept is None else block.kept
    stop = len(kept)
    while stop and not lines[kept[stop - 1]].strip(_NOTHING):
        stop -= 1
    return block if stop == block.rows else replace(block, kept=kept[:stop])


def numbers_of(blocks: Sequence[Block]) -> Sequence[int]:
    """Line in the file (from 1) of each row.

    Examples
    --------
    >>> numbers_of([Block(0, 9, 1, 3, np.array([1, 2])), Block(9, 12, 4, 1)])
    range(2, 5)
    """
    found = np.concatenate([block.numbers for block in blocks])
    first, last = int(found[0]), int(found[-1])
    return range(first, last + 1) if last - first + 1 == len(found) else array("q", found.astype(np.int64).tobytes())
