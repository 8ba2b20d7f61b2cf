"""First rows of a text -> what all its rows mean: columns, decimal mark, times, sampling time."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any, Literal, Self

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.errors import ColumnError, DataError
from lostmotion.files.clock import COARSE_SHARE, counts_samples
from lostmotion.files.columns import usual
from lostmotion.files.dates import all_are, date_orders, states_zone
from lostmotion.files.interpret import Meaning, check_dt, interpret
from lostmotion.files.moments import moment_columns
from lostmotion.files.number_cells import BAD_WORDS, is_text, text_cells
from lostmotion.files.rates import between_steps, rounded, uniform
from lostmotion.files.table import Table
from lostmotion.files.text import find_rows, parse_text
from lostmotion.files.times import Stamps
from lostmotion.records.modes import unknown_words, words_of
from lostmotion.records.sampling import Bools

HEAD_ROWS = 60  # rows that the sampling time and the decimal mark are read from
FEWEST_ROWS = 3
DAY = 86400.0  # s


@dataclass(frozen=True)
class Asked:
    """What the user said about the columns; see :func:`lostmotion.files.read_loop`.

    Parameters
    ----------
    op, pv : str
        Columns of controller output and measurement.
    time : str, None or False
        Time column; None: by its usual names; False: ignore it.
    mode : str or None
        Column that says whether the controller moves the valve; None: not used.
    automatic : tuple of str
        What it then holds; empty: the words of :mod:`lostmotion.records.modes`.
    dt : float or None
        Sampling time in seconds; None: from the time column.
    """

    op: str = "OP"
    pv: str = "PV"
    time: str | Literal[False] | None = None
    mode: str | None = None
    automatic: tuple[str, ...] = ()
    dt: float | None = None

    def __post_init__(self) -> None:
        check_dt(self.dt)
        object.__setattr__(self, "automatic", tuple(str(value).strip().lower() for value in self.automatic))


@dataclass(frozen=True)
class Layout:
    """How to read the rows.

    Parameters
    ----------
    header : str
        First line, as it stands.
    names : tuple of str
        Columns; op, pv, time and mode are among them.
    delimiter : str
        Between the columns.
    decimal : "." or "," or None
        Decimal mark; None while no number had one.
    dt : float
        Sampling time in seconds.
    scale : float
        Seconds in one unit of a numeric time column.
    orders : tuple of str
        Orders of day, month and year that are still possible; empty for numeric times, "" for times of day.
    calendar : "", "local" or "UTC"
        Times count from 1970, in the time of the file or in UTC; empty: from anywhere.
    automatic : tuple of str
        Content of the mode column, in lower case, where the controller moves the valve.
    notes : tuple of str
        What was assumed.
    last_date : str
        Last date read, as it stands, while several orders are possible.
    date : str, optional
        Column of dates, where `time` holds times of day beside them.
    """

    header: str
    names: tuple[str, ...]
    delimiter: str
    op: str
    pv: str
    time: str | None
    mode: str | None
    decimal: str | None
    dt: float
    scale: float = 1.0
    orders: tuple[str, ...] = ()
    calendar: str = ""
    automatic: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    last_date: str = ""
    date: str | None = None

    @property
    def settled(self) -> bool:
        """True where no further row can change how rows are read."""
        return self.decimal is not None and len(self.orders) < 2

    @property
    def wrap(self) -> float:
        """Seconds after which the times begin anew; 0 for never."""
        return DAY if self.orders == ("",) else 0.0

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        return asdict(self)

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Self:
        """Layout from :meth:`to_dict`, also after a passage through JSON."""
        values: dict[str, Any] = {
            name: tuple(value) if isinstance(value, list) else value for name, value in data.items()
        }
        return cls(**values)


def find_layout(lines: list[str], source: str, asked: Asked) -> tuple[Layout, int]:
    """Decide how to read the rows: the first ones are interpreted as :func:`lostmotion.files.read_loop` does.

    Parameters
    ----------
    lines : list of str
        Complete lines from the first on.
    source : str
        Name for messages.
    asked : Asked
        What the user said.

    Returns
    -------
    (Layout, int)
        The layout and the number of lines before the first row.

    Raises
    ------
    ColumnError, TimeError, DataError
        As in read_loop, with the same words. Other than there, 3 rows are needed, repeated headers and a few bad
        stamps are passed over, times of day may go on after midnight, set point and position are not read, and what
        the mode column holds has to be known.

    Examples
    --------
    >>> layout, begin = find_layout(["t_s;CO;PV", *(f"{k};{k % 3},5;1" for k in range(0, 8, 2))], "a.csv", Asked())
    >>> layout.dt, layout.op, layout.decimal, begin
    (2.0, 'CO', ',', 1)
    """
    header, before, table = _first_table(lines, source)
    meaning = interpret(
        table, asked.op, asked.pv, None, False, asked.time, asked.mode or False, asked.dt, usable=_usable
    )
    columns = meaning.columns
    date, clock = None, columns.time
    if clock is not None and clock not in table.names:
        date, clock = moment_columns(table) or (None, clock)
    layout = Layout(
        header=header,
        names=tuple(table.names),
        delimiter=table.delimiter,
        op=columns.op,
        pv=columns.pv,
        time=clock,
        mode=columns.mode,
        decimal=meaning.decimal if _proven(meaning) else None,
        dt=meaning.clock.dt,
        automatic=_automatic(table, columns.mode, asked.automatic),
        notes=(*meaning.assumed, *_mode_note(table, asked.mode)),
        date=date,
    )
    layout = _with_times(layout, meaning.stamps)
    return replace(layout, notes=(*layout.notes, *meaning.clock.notes)), before


def _first_table(lines: list[str], source: str) -> tuple[str, int, Table]:
    """Header, number of lines before the first row, and a table of the rows without repeated headers."""
    header, rows, _ = find_rows(lines, source)
    before = rows[0]
    lines = [*lines[:before], *(line for line in lines[before:] if line != header)]
    header, rows, _ = find_rows(lines, source)
    if len(rows) < FEWEST_ROWS:
        raise DataError.expected(f"at least {FEWEST_ROWS} complete rows", f"{len(rows)} in {source!r}", "wait for more")
    return header, before, parse_text("\n".join([*lines, ""]).encode(), source)


def _proven(meaning: Meaning) -> bool:
    """Tell a mark that was seen, or that the delimiter leaves no doubt about, from a default."""
    if meaning.decimal == "," or meaning.table.delimiter == ",":
        return True
    dates = meaning.stamps is not None and meaning.stamps.dates is not None
    numbers = [name for name in meaning.used if not (dates and name == meaning.columns.time)]
    cells = [text_cells(meaning.table.column(name)) for name in numbers if is_text(meaning.table.column(name))]
    return any(series.str.contains(r"\d\.|\.\d").any() for series in cells)


def _mode_note(table: Table, mode: str | None) -> tuple[str, ...]:
    found = usual("mode", table.names)
    if mode is not None or not found:
        return ()
    return (f"Column {found[0]!r} was not used; name it as the mode to leave out manual operation.",)


def _automatic(table: Table, mode: str | None, given: tuple[str, ...]) -> tuple[str, ...]:
    """Content of the mode column that counts as automatic; without the user's word, only what is beyond doubt."""
    if mode is None or given:
        return given
    cells = text_cells(table.column(mode)).drop_nulls().unique().to_list()
    odd = [word for word in unknown_words(np.array(cells, dtype=np.str_)) if word.lower() not in BAD_WORDS]
    if odd:
        raise ColumnError.expected(
            f"AUTO, CAS, MAN.. in column {mode!r}", f"{odd[:3]}", "say which content means automatic, automatic=(..)"
        )
    return words_of("automatic")


def _with_times(layout: Layout, stamps: Stamps | None) -> Layout:
    """Settle unit or order of the dates; times that several rows share cannot tell gaps and are not used."""
    if stamps is None:
        return replace(layout, time=None, date=None)
    if _shared(stamps):
        note = f"The times in {stamps.name!r} are not used; rows count as dt apart, and gaps are not seen."
        return replace(layout, time=None, date=None, notes=(*layout.notes, note))
    if stamps.dates is None:
        counter = counts_samples(stamps, np.diff(stamps.seconds))
        scale = stamps.scale * layout.dt if counter else stamps.scale
        return replace(layout, scale=scale, calendar="UTC" if stamps.epoch else "")
    orders = date_orders(stamps.table, stamps.name, stamps.dates)
    notes = layout.notes
    if len(orders) > 1:
        notes = (*notes, f"Dates in {stamps.name!r} are read {orders[0]} until one proves the other.")
    calendar = "" if orders == ("",) else "UTC" if states_zone(stamps.dates) else "local"
    return replace(layout, orders=orders, calendar=calendar, notes=notes)


def _usable(stamps: Stamps) -> Stamps:
    """Rows of one clock: a few without a time, or not later than all before, are passed over.

    Where the clock was set among them, those of one setting: :class:`lostmotion.files.grid.Grid` sees to the step.
    """
    if stamps.dates is not None and all_are(stamps.dates, dated=False):
        stamps = replace(stamps, seconds=_unwrapped(stamps.seconds, DAY))
    later = _later(stamps)
    steps = np.diff(later.seconds)
    if not len(steps) or ((steps > 0).all() and (uniform(steps) or rounded(later.seconds, steps))):
        return later
    known = ~np.isnan(stamps.seconds)
    keep = known.copy()
    keep[known] = between_steps(stamps.seconds[known])
    return _with_rows(stamps, keep) if keep.sum() < known.sum() else later


def _later(stamps: Stamps) -> Stamps:
    """Rows whose time is known and later than all before, where the others are few."""
    seconds = np.where(np.isnan(stamps.seconds), -np.inf, stamps.seconds)
    before = np.concatenate([[-np.inf], np.maximum.accumulate(seconds)[:-1]])
    keep = seconds > before
    if keep.mean() < 1.0 - COARSE_SHARE or keep.sum() < FEWEST_ROWS:
        return stamps  # not a few: find_clock says what is wrong
    return _with_rows(stamps, keep)


def _with_rows(stamps: Stamps, keep: Bools) -> Stamps:
    frame = stamps.table.frame.filter(keep.tolist())
    lines = stamps.table.lines
    kept = None if lines is None else [line for line, good in zip(lines, keep, strict=True) if good]
    return replace(stamps, seconds=stamps.seconds[keep], table=replace(stamps.table, frame=frame, lines=kept))


def _unwrapped(seconds: FloatArray, wrap: float) -> FloatArray:
    """Times of day that go on after midnight."""
    back = np.diff(seconds, prepend=seconds[:1]) < -0.5 * wrap
    return np.asarray(seconds + wrap * np.cumsum(back))


def _shared(stamps: Stamps) -> bool:
    return bool((np.diff(stamps.seconds) == 0).mean() >= COARSE_SHARE)
