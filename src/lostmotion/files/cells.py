"""Lines -> numbers by a known layout; a cell that cannot be read is missing, never a reason to stop."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import polars as pl

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.files.dates import dates_in_order
from lostmotion.files.layout import Layout
from lostmotion.files.number_cells import BAD_WORDS, DECIMAL_COMMA, DECIMAL_DOT
from lostmotion.files.text import BLANKS, has_cells, split_line, with_tabs
from lostmotion.records.modes import holds
from lostmotion.records.record import LARGEST
from lostmotion.records.sampling import Bools


@dataclass(frozen=True, eq=False)
class Cells:
    """Numbers of the rows in a few lines.

    Attributes
    ----------
    stamps, op, pv : ndarray, shape (n,)
        NaN where a cell is empty, bad or unreadable; stamps in seconds, all NaN without a time column.
    automatic : ndarray of bool, shape (n,), or None
        The controller moves the valve; None without a mode column.
    garbled : ndarray of bool, shape (n,)
        Rows with something that is neither a number nor a word for a missing value.
    lines : ndarray of int, shape (n,)
        Place of each row among the lines, from 0.
    moved : (int, float) or None
        Row from which on the dates are read in another order, and the seconds by which that moves the row before.
    """

    stamps: FloatArray
    op: FloatArray
    pv: FloatArray
    automatic: Bools | None
    garbled: Bools
    lines: IntArray
    moved: tuple[int, float] | None = None

    def __len__(self) -> int:
        return self.op.size

    def part(self, first: int, stop: int) -> Cells:
        """Rows from `first` up to `stop`."""
        if stop - first == len(self):
            return self
        rows = slice(first, stop)
        automatic = None if self.automatic is None else self.automatic[rows]
        signals = (self.stamps[rows], self.op[rows], self.pv[rows])
        return Cells(*signals, automatic, self.garbled[rows], self.lines[rows])


def read_cells(lines: Sequence[bytes], layout: Layout) -> tuple[Cells, Layout]:
    r"""Read complete lines below the header.

    Parameters
    ----------
    lines : sequence of bytes
        Without line ends. Blank lines, comments and repeated headers are passed over.
    layout : Layout
        What is known so far.

    Returns
    -------
    (Cells, Layout)
        The numbers, and what is known now: a decimal mark or an order of dates may have been settled.

    Examples
    --------
    >>> layout = Layout("OP;PV", ("OP", "PV"), ";", "OP", "PV", None, None, None, dt=1.0)
    >>> cells, layout = read_cells([b"1;2", b"", b"1,5;Bad", b"1.5;?!"], layout)
    >>> cells.op, cells.pv, cells.garbled.tolist(), layout.decimal
    (array([1. , 1.5, nan]), array([ 2., nan, nan]), [False, False, True], ',')
    """
    text = _decoded(lines)
    kept = [place for place, line in enumerate(text) if line and line != layout.header]
    whole = b"\n".join([b"", *lines])
    if b"#" in whole or b"//" in whole or b"\n " in whole:  # perhaps a comment or a blank line
        kept = [place for place in kept if has_cells(text[place])]
    frame, broken = _frame([text[place] for place in kept], layout)
    layout = _settle_decimal(frame, layout)
    numbers = [_numbers(frame[name], layout.decimal) for name in (layout.op, layout.pv)]
    garbled = broken | numbers[0][1] | numbers[1][1]
    stamps, moved = np.full(len(kept), np.nan), None
    if layout.time is not None:
        stamps, wrong, moved, layout = _stamps(_moments(frame, layout), layout)
        garbled |= wrong
    automatic = None if layout.mode is None else _is_automatic(frame[layout.mode], layout.automatic)
    places = np.array(kept, dtype=np.int64)
    return Cells(stamps, numbers[0][0], numbers[1][0], automatic, garbled, places, moved), layout


def _decoded(lines: Sequence[bytes]) -> list[str]:
    """Text of each line: UTF-8, or else Latin-1; what looks like a line end in it is a blank."""
    try:
        text = b"\n".join(lines).decode().split("\n")
        if len(text) == len(lines):
            return text
    except UnicodeDecodeError:
        pass
    return [decoded(line).replace("\n", " ") for line in lines]


def decoded(line: bytes) -> str:
    """Text of one line: UTF-8, or else Latin-1."""
    try:
        return line.decode()
    except UnicodeDecodeError:
        return line.decode("latin-1")


def _frame(rows: list[str], layout: Layout) -> tuple[pl.DataFrame, Bools]:
    """Cells as stripped text, and rows that do not fit the header: all their cells are missing."""
    broken = np.zeros(len(rows), dtype=bool)
    quoted = [place for place, row in enumerate(rows) if '"' in row and row.count('"') % 2]
    for place in quoted:  # would swallow the next line
        rows[place] = ""
    broken[quoted] = True
    width = len(layout.names)
    places = [f"c{place}" for place in range(width + 1)]  # one field more than the header: lines that end with it
    delimiter = layout.delimiter
    if delimiter == BLANKS:
        rows, delimiter = with_tabs(rows), "\t"
    body = "\n".join([delimiter.join(places), *(row or delimiter for row in rows), ""])
    try:
        frame = pl.read_csv(io.StringIO(body), separator=delimiter, infer_schema=False, truncate_ragged_lines=True)
    except pl.exceptions.PolarsError:
        frame = _by_hand(rows, places, delimiter)
    used = dict.fromkeys(name for name in (layout.op, layout.pv, layout.date, layout.time, layout.mode) if name)
    columns = {name: frame[places[layout.names.index(name)]].str.strip_chars() for name in used}
    spare = frame[places[-1]].fill_null("").str.strip_chars()
    long = (spare != "").to_numpy()
    return pl.DataFrame(
        {name: column.set((column == "") | pl.Series(long), None) for name, column in columns.items()}
    ), broken | long


def _by_hand(rows: list[str], places: list[str], delimiter: str) -> pl.DataFrame:
    fields = [split_line(row, delimiter) for row in rows]
    columns = [[row[place] if place < len(row) else None for row in fields] for place in range(len(places))]
    return pl.DataFrame(dict(zip(places, columns, strict=True)), schema=dict.fromkeys(places, pl.String))


def _settle_decimal(frame: pl.DataFrame, layout: Layout) -> Layout:
    """Take the mark of the first number that has one."""
    if layout.decimal is not None:
        return layout
    names = [layout.op, layout.pv, *([layout.time] if layout.time is not None and not layout.orders else [])]
    comma, dot = (_first([frame[name].str.contains(mark) for name in names]) for mark in (DECIMAL_COMMA, DECIMAL_DOT))
    if comma == dot == len(frame):
        return layout
    return replace(layout, decimal="," if comma < dot else ".")


def _first(found: list[pl.Series]) -> int:
    rows = np.flatnonzero(np.any([column.fill_null(value=False).to_numpy() for column in found], axis=0))
    return int(rows[0]) if rows.size else len(found[0])


def _numbers(cells: pl.Series, decimal: str | None) -> tuple[FloatArray, Bools]:
    """Floats with NaN, and where the text is no number and no word for a missing one."""
    plain = cells
    if decimal == ",":
        plain = cells.set(cells.str.contains(".", literal=True), None).str.replace(",", ".", literal=True)
    values = np.array(plain.cast(pl.Float64, strict=False).fill_null(np.nan).to_numpy(), dtype=np.float64)
    values[~(np.abs(values) <= LARGEST)] = np.nan
    odd = np.isnan(values)
    if not odd.any():
        return values, odd
    return values, odd & (cells.is_not_null() & ~_bad(cells)).to_numpy()


def _moments(frame: pl.DataFrame, layout: Layout) -> pl.Series:
    """Times as they stand; dates and times of day beside them as one."""
    clock = frame[str(layout.time)]
    if layout.date is None:
        return clock
    parts = [cells.set(_bad(cells), None) for cells in (frame[layout.date], clock)]
    return parts[0] + " " + parts[1]


def _bad(cells: pl.Series) -> pl.Series:
    """Cells that hold a word for a missing value."""
    return cells.str.to_lowercase().is_in(list(BAD_WORDS)).fill_null(value=False)


def _stamps(cells: pl.Series, layout: Layout) -> tuple[FloatArray, Bools, tuple[int, float] | None, Layout]:
    if not layout.orders:
        values, wrong = _numbers(cells, layout.decimal)
        return values * layout.scale, wrong, None, layout
    moved = None
    if len(layout.orders) > 1:
        times, moved, layout = _settle_order(cells, layout)
    else:
        times = dates_in_order(cells, layout.orders[0])
    return times, np.isnan(times) & (cells.is_not_null() & ~_bad(cells)).to_numpy(), moved, layout


def _settle_order(cells: pl.Series, layout: Layout) -> tuple[FloatArray, tuple[int, float] | None, Layout]:
    """At the first date that tells the orders apart, keep the one that follows the row before most closely."""
    before = pl.Series(cells.name, [layout.last_date or None], dtype=pl.String)
    readings = np.array([dates_in_order(pl.concat([before, cells]), order) for order in layout.orders])
    known = np.flatnonzero(~np.isnan(readings).all(axis=0))
    steps = np.diff(readings[:, known], axis=1)
    apart = np.flatnonzero(~(np.abs(steps - steps[0]) < 1e-3).all(axis=0) & ~np.isnan(steps).all(axis=0))
    if not apart.size:
        last = str(cells[int(known[-1]) - 1]) if known.size and known[-1] > 0 else layout.last_date
        return readings[0, 1:], None, replace(layout, last_date=last)
    row, previous = int(known[apart[0] + 1]), int(known[apart[0]])
    best = int(np.nanargmin(np.abs(steps[:, apart[0]])))
    times = np.where(np.arange(readings.shape[1]) < row, readings[0], readings[best])[1:]
    move = float(readings[best, previous] - readings[0, previous])
    return times, (row - 1, move), replace(layout, orders=(layout.orders[best],), last_date="")


def _is_automatic(cells: pl.Series, automatic: tuple[str, ...]) -> Bools:
    """A missing mode is not automatic: nobody knows."""
    words = [word for word in cells.drop_nulls().unique().to_list() if holds(word, automatic)]
    return np.asarray(cells.is_in(words).fill_null(value=False).to_numpy(), dtype=bool)
