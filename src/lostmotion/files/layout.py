"""First rows of a text -> what all its rows mean: columns, decimal mark, times, sampling time."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any, Literal, Self

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.errors import ColumnError, DataError, ParameterError, TimeError
from lostmotion.files.clock import COARSE_SHARE, counts_samples, find_clock
from lostmotion.files.columns import Wanted, named, resolve
from lostmotion.files.dates import date_orders, looks_numeric, states_zone
from lostmotion.files.number_cells import BAD_WORDS, decimal_mark, is_text, text_cells, to_numbers
from lostmotion.files.read import sampling_column, sampling_time
from lostmotion.files.table import Table
from lostmotion.files.text import find_rows, parse_text
from lostmotion.files.times import Stamps, number_scale, read_times

HEAD_ROWS = 60  # rows that the sampling time and the decimal mark are read from
FEWEST_ROWS = 3
DAY = 86400.0  # s
AUTOMATIC = ("auto", "automatic", "aut", "cas", "cascade", "rcas", "bcas")  # the controller moves the valve
MANUAL = ("man", "manual", "hand", "iman", "init", "initman", "lo", "oos", "off", "trk", "track", "rout", "local")


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
        Column that says whether the controller moves the valve.
    automatic : tuple of str
        What it then holds; empty: AUTO, CAS and their relatives.
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
        if self.dt is not None and not (np.isfinite(self.dt) and self.dt > 0):
            raise ParameterError.expected("dt > 0", self.dt, "give the sampling time in seconds")
        if self.time is False and self.dt is None:
            raise TimeError.expected("dt with ignored times", "none", "give the sampling time, dt=<seconds>")
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
    """Decide how to read the rows, by the rules of :func:`lostmotion.files.read_loop`.

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
        As in read_loop; besides, times that several rows share cannot tell gaps and are refused.

    Examples
    --------
    >>> layout, begin = find_layout(["t_s;CO;PV", *(f"{k};{k % 3},5;1" for k in range(0, 8, 2))], "a.csv", Asked())
    >>> layout.dt, layout.op, layout.decimal, begin
    (2.0, 'CO', ',', 1)
    """
    header, rows = find_rows(lines, source)
    before = rows[0]
    lines = [*lines[:before], *(line for line in lines[before:] if line != header)]
    header, rows = find_rows(lines, source)
    if len(rows) < FEWEST_ROWS:
        raise DataError.expected(f"at least {FEWEST_ROWS} complete rows", f"{len(rows)} in {source!r}", "wait for more")
    table = parse_text("\n".join([*lines, ""]).encode(), source)
    sampling = sampling_column(table, (asked.op, asked.pv, asked.time, asked.mode))
    names = [name for name in table.names if name != sampling]
    mode = None if asked.mode is None else named("mode", asked.mode, names)
    time: Wanted = asked.time
    columns = resolve([name for name in names if name != mode], asked.op, asked.pv, None, False, time)
    used = [name for name in (columns.op, columns.pv, columns.time, sampling) if name is not None]
    decimal = decimal_mark(table, used)
    notes = (*table.notes, *columns.notes, *_signal_notes(table, (columns.op, columns.pv), decimal))
    layout = Layout(
        header=header,
        names=tuple(table.names),
        delimiter=table.delimiter,
        op=columns.op,
        pv=columns.pv,
        time=columns.time,
        mode=mode,
        decimal=decimal if _proven(table, used, decimal) else None,
        dt=1.0,
        automatic=_automatic(table, mode, asked.automatic),
        notes=(*notes, *_mode_note(names, mode)),
    )
    ts = None if sampling is None else sampling_time(table, sampling, decimal)
    return _with_clock(layout, table, decimal, asked.dt, ts), before


def _proven(table: Table, names: list[str], decimal: str) -> bool:
    """Tell a mark that was seen, or that the delimiter leaves no doubt about, from a default."""
    return (
        decimal == ","
        or table.delimiter == ","
        or any(
            text_cells(table.column(name)).str.contains(r"\d\.|\.\d").any()
            for name in names
            if is_text(table.column(name))
        )
    )


def _signal_notes(table: Table, names: tuple[str, ...], decimal: str) -> tuple[str, ...]:
    comma = ("Numbers were read with a decimal comma.",) if decimal == "," else ()
    for name in names:
        to_numbers(table, name, decimal)  # a text column is refused here, at the door
    return comma


def _mode_note(names: list[str], mode: str | None) -> tuple[str, ...]:
    found = [name for name in names if name.strip().lower().rpartition(".")[2] in ("mode", "auto/man", "automan")]
    if mode is not None or not found:
        return ()
    return (f"Column {found[0]!r} was not used; name it as the mode to leave out manual operation.",)


def _automatic(table: Table, mode: str | None, given: tuple[str, ...]) -> tuple[str, ...]:
    """Content of the mode column that counts as automatic; without the user's word, only what is beyond doubt."""
    if mode is None or given:
        return given
    cells = text_cells(table.column(mode)).str.to_lowercase()
    odd = [cell for cell in cells.drop_nulls().unique().to_list() if cell not in (*AUTOMATIC, *MANUAL, *BAD_WORDS)]
    if odd:
        raise ColumnError.expected(
            f"AUTO, CAS, MAN.. in column {mode!r}",
            f"{sorted(odd)[:3]}",
            "say which content means automatic, automatic=(..)",
        )
    return AUTOMATIC


def _with_clock(layout: Layout, table: Table, decimal: str, dt: float | None, ts: float | None) -> Layout:
    if layout.time is None:
        clock = find_clock(None, dt, ts)
        return replace(layout, dt=clock.dt, notes=(*layout.notes, *clock.notes))
    layout, stamps = _with_times(layout, table, decimal)
    forward = _forward(stamps)
    _refuse_coarse(stamps, forward)
    clock = find_clock(forward if len(forward.seconds) >= FEWEST_ROWS else stamps, dt, ts)
    counter = counts_samples(forward, np.diff(forward.seconds))
    scale = layout.scale * clock.dt if counter else layout.scale
    return replace(layout, dt=clock.dt, scale=scale, notes=(*layout.notes, *clock.notes))


def _with_times(layout: Layout, table: Table, decimal: str) -> tuple[Layout, Stamps]:
    """Settle unit or order of the dates."""
    name = str(layout.time)
    stamps = read_times(table, name, decimal)
    cells = text_cells(table.column(name))
    cells = cells.set(cells.str.to_lowercase().is_in(list(BAD_WORDS)), None)
    if not looks_numeric(cells.drop_nulls()[0]):
        orders = date_orders(table, name, cells)
        notes = layout.notes
        if len(orders) > 1:
            notes = (*notes, f"Dates in {name!r} are read {orders[0]} until one proves the other.")
        calendar = "" if orders == ("",) else "UTC" if states_zone(cells) else "local"
        layout = replace(layout, orders=orders, calendar=calendar, notes=notes)
        return layout, replace(stamps, seconds=_unwrapped(stamps.seconds, layout.wrap))
    values, _ = to_numbers(table, name, decimal)
    scale, epoch = number_scale(name, values[~np.isnan(values)])
    return replace(layout, scale=scale or 1.0, calendar="UTC" if epoch else ""), stamps


def _unwrapped(seconds: FloatArray, wrap: float) -> FloatArray:
    """Times of day that go on after midnight."""
    back = np.diff(seconds, prepend=seconds[:1]) < -0.5 * wrap
    return np.asarray(seconds + wrap * np.cumsum(back)) if wrap else seconds


def _forward(stamps: Stamps) -> Stamps:
    """Rows whose time is known and later than all before: what is left of a stream with a few bad stamps."""
    seconds = np.where(np.isnan(stamps.seconds), -np.inf, stamps.seconds)
    before = np.concatenate([[-np.inf], np.maximum.accumulate(seconds)[:-1]])
    keep = seconds > before
    if keep.mean() < 1.0 - COARSE_SHARE:
        return stamps  # not a few: find_clock says what is wrong
    frame = stamps.table.frame.filter(keep.tolist())
    lines = stamps.table.lines
    kept = None if lines is None else [line for line, good in zip(lines, keep, strict=True) if good]
    table = replace(stamps.table, frame=frame, lines=kept)
    return replace(stamps, seconds=stamps.seconds[keep], table=table)


def _refuse_coarse(stamps: Stamps, forward: Stamps) -> None:
    if forward is stamps and (np.diff(stamps.seconds) == 0).mean() >= COARSE_SHARE:
        raise TimeError.expected(
            f"a time for each row in column {stamps.name!r}",
            f"several rows with one time, such as {stamps.at(0)}",
            "give dt=<seconds> and ignore the times; gaps cannot be told then",
        )
