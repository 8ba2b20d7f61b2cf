"""Follow a record while it grows: only new complete rows, from a place that can be kept and taken up again."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from threading import Event
from typing import Any, BinaryIO, Self

import numpy as np

from lostmotion.errors import DataError, ParameterError
from lostmotion.files.cells import Cells, decoded, read_cells
from lostmotion.files.grid import Grid, Rows
from lostmotion.files.growing import GrowingFile, GrowingStream, Source
from lostmotion.files.layout import HEAD_ROWS, Asked, Layout, find_layout
from lostmotion.files.text import has_cells
from lostmotion.files.text_lines import Lines

VERSION = 1
MOST_ROWS = 20_000  # lines given at a time
AHEAD = 20_000  # lines turned into numbers at a time
_EMPTY = Rows(np.zeros(0), np.zeros(0), np.zeros(0))


class Follower:
    r"""Reader of a growing text file, or of lines from a stream.

    The first 60 rows are interpreted as ``read_loop`` interprets a whole file (exceptions: see ``find_layout``; and
    UTF-16, Parquet, MAT files and line ends inside quotes are not read); all further rows by what was found. What the
    rows give does not depend on how the bytes arrive. Later cells that are empty, bad or unreadable are missing; gaps
    in the times become missing samples; rows whose time is not later than that of the row before are left out. The
    last line waits for its line end. Memory does not grow with the source.

    Parameters
    ----------
    source : path or binary stream
        CSV or text file, or a stream of such lines.
    asked : Asked
        What the user says about the columns.
    position : dict, optional
        From :attr:`position`: go on from there. A file must be the same one, only longer. A stream may begin with
        the header again or without; rows that come again are left out by their times.

    Raises
    ------
    FileAccessError
        No such file.
    DataError
        Not text, no header, columns or times that cannot be used (see ``read_loop``), or another file than the one
        of `position`.
    ParameterError
        `asked` differs from what `position` was made with.

    Examples
    --------
    >>> import io
    >>> text = b"t_s,OP,PV\n0,1,5\n2,1,6\n4,Bad,7\n6,3,8\n8,4"
    >>> follower = Follower(io.BytesIO(text))
    >>> rows = follower.finish()
    >>> rows.time, rows.op, follower.layout.dt
    (array([0., 2., 4., 6.]), array([ 1.,  1., nan,  3.]), 2.0)
    """

    def __init__(
        self, source: Path | BinaryIO, asked: Asked | None = None, position: dict[str, Any] | None = None
    ) -> None:
        self.asked = asked or Asked()
        self.layout: Layout | None = None
        self._number = 0  # lines taken
        self._cells: Cells | None = None  # of the lines read ahead
        self._batch = self._parsed = 0  # lines read ahead, and how many of them are not taken yet
        stored = position or {}
        if stored:
            _check_position(stored, self.asked, isinstance(source, Path))
        self.source: Source = (
            GrowingFile(source, stored.get("offset", 0), stored.get("mark"))
            if isinstance(source, Path)
            else GrowingStream(source)
        )
        self._lines = Lines(self.source.read, self.source.name, stored.get("offset", 0))
        self._resumed_stream = bool(stored) and not isinstance(source, Path)
        if stored.get("layout"):
            self._number = stored["lines"]
            self._use(Layout.from_dict(stored["layout"]), stored["grid"])
            self._lines.end = b"" if self._resumed_stream else stored["end"].encode()

    @property
    def position(self) -> dict[str, Any]:
        """Place reached, JSON-ready: what :class:`Follower` needs to go on with the row after the last one given."""
        made = {"version": VERSION, "file": isinstance(self.source, GrowingFile), "asked": asdict(self.asked)}
        if self.layout is None:
            return {**made, "offset": 0, "mark": self.source.mark(0), "layout": None}
        return {
            **made,
            "offset": self._lines.offset,
            "mark": self.source.mark(self._lines.offset),
            "lines": self._number,
            "end": self._lines.end.decode(),
            "layout": self.layout.to_dict(),
            "grid": self._grid.state,
        }

    @property
    def name(self) -> str:
        """Of the source, for messages."""
        return self.source.name

    @property
    def ended(self) -> bool:
        """Nothing will be added any more."""
        return self.source.ended

    @property
    def more(self) -> bool:
        """Lines are there that were not given yet."""
        return self.layout is not None and len(self._lines) > 0

    @property
    def counts(self) -> dict[str, int]:
        """Numbers of rows, inserted missing samples, and rows of each kind of trouble."""
        return {} if self.layout is None else dict(self._grid.counts)

    def read(self, most: int = MOST_ROWS) -> Rows:
        """Give the samples of up to `most` new lines: none for comments, none while there are too few to begin with."""
        if not len(self._lines) or self.layout is None:
            self._lines.fill()
        if self.layout is None and not self._begin(enough=HEAD_ROWS):
            return _EMPTY
        return self._take(most)

    def finish(self, most: int = MOST_ROWS) -> Rows:
        """Like :meth:`read`, at the end of a source that will not grow further: begins with what there is.

        Raises
        ------
        DataError
            Fewer than 3 complete rows, if nothing was read before.
        """
        while self.layout is None and self._lines.fill():
            self._begin(enough=HEAD_ROWS)
        if self.layout is None:
            self._begin(enough=0)
        return self.read(most)

    def wait(self, seconds: float, stop: Event) -> None:
        """Wait until there may be more rows, `seconds` have passed, or `stop` is set."""
        self.source.wait(seconds, stop)

    def close(self) -> None:
        """Let go of the file."""
        self.source.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _begin(self, enough: int) -> bool:
        """Find the layout once there are `enough` rows; pass over the lines up to the header."""
        head: list[str] = []
        rows = -1
        for line in self._lines.peek():
            head.append(_text(line, self.source.name, not head))
            rows += has_cells(head[-1])
            if rows == HEAD_ROWS:
                break
        if enough and rows < enough:
            return False
        layout, before = find_layout(head, self.source.name, self.asked)
        self._lines.take(before)
        self._number = before
        self._use(layout)
        return True

    def _use(self, layout: Layout, state: dict[str, Any] | None = None) -> None:
        self.layout = layout
        self._grid = Grid(layout.dt, layout.time is not None, layout.wrap, layout.calendar, state, self._resumed_stream)

    def _take(self, most: int) -> Rows:
        if not self._parsed:
            self._parse(most)
        begin = self._batch - self._parsed
        taken = self._lines.take(min(most, self._parsed))
        self._parsed -= taken
        self._number += taken
        if not taken or self._cells is None:
            return _EMPTY
        first, stop = np.searchsorted(self._cells.lines, [begin, begin + taken])
        cells = self._cells.part(int(first), int(stop))
        return self._grid.place(cells, self._number + 1 - begin - taken + cells.lines)

    def _parse(self, most: int) -> None:
        """Read many lines ahead; but no further than asked while rows may still change how rows are read."""
        if self.layout is None:
            return
        lines = self._lines.peek(max(most, AHEAD) if self.layout.settled else most)
        if lines and self._resumed_stream:
            _check_header(lines[0], self.layout, self.source.name)
            self._resumed_stream = False
        self._batch = self._parsed = len(lines)
        self._cells, self.layout = read_cells(lines, self.layout) if lines else (None, self.layout)


def _text(line: bytes, source: str, first: bool) -> str:
    if first and line.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise DataError.expected("UTF-8 or Latin-1 text", f"UTF-16 in {source!r}", "write the file as UTF-8")
    text = decoded(line).replace("\n", " ")
    return text.removeprefix("\ufeff") if first else text


def _check_position(stored: dict[str, Any], asked: Asked, is_file: bool) -> None:
    if stored.get("version") != VERSION:
        raise DataError.expected(f"a position of version {VERSION}", stored.get("version"), "start anew")
    if stored["file"] != is_file:
        kinds = {True: "a file", False: "a stream"}
        raise ParameterError.expected(f"{kinds[stored['file']]} as before", kinds[is_file], "start anew, or go back")
    now = asdict(asked) | {"automatic": list(asked.automatic)}
    before = stored["asked"] | {"automatic": list(stored["asked"]["automatic"])}
    changed = [name for name in now if now[name] != before.get(name)]
    if changed:
        name = changed[0]
        raise ParameterError.expected(f"{name}={before.get(name)!r} as before", repr(now[name]), "or start anew")


def _check_header(line: bytes, layout: Layout, source: str) -> None:
    """The first line of a resumed stream: the header again, or a row."""
    text = _text(line, source, first=True)
    cells, _ = read_cells([line], layout)
    if text != layout.header and len(cells) and cells.garbled[0] and np.isnan([cells.op[0], cells.pv[0]]).all():
        raise DataError.expected(f"the header {layout.header!r} again, or rows", repr(text[:80]), "start anew")
