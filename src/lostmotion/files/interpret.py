"""Table -> what it means: columns, decimal mark, signals, times and sampling time, for whole files and growing ones."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import datetime

import narwhals.stable.v2 as nw
import numpy as np

from lostmotion.arguments import seconds
from lostmotion.arrays import FloatArray, IntArray
from lostmotion.errors import DataError, TimeError
from lostmotion.files.began import began, moment_of, open_date
from lostmotion.files.clock import Clock, find_clock
from lostmotion.files.columns import SAMPLING_NAMES, Columns, Wanted, key, resolve, time_unit
from lostmotion.files.dates import AmbiguousDatesError, looks_numeric
from lostmotion.files.held import held, no_common_rate
from lostmotion.files.long import with_columns_of_tags
from lostmotion.files.moments import with_moments
from lostmotion.files.number_cells import decimal_mark, to_numbers
from lostmotion.files.order import arranged, by_time
from lostmotion.files.quality import ALL, Trust, distrusted, quality_column
from lostmotion.files.resampled import resampled
from lostmotion.files.table import Table
from lostmotion.files.times import Stamps, read_times

FEWEST = 2  # rows


@dataclass(frozen=True, eq=False)
class Meaning:
    """What the columns of a table hold.

    Attributes
    ----------
    table : Table
        As it was read, with one column of times where a column of dates stood beside one of times of day.
    columns : Columns
        Which column plays which role.
    used : tuple of str
        Columns that were read, the one of sampling times included.
    decimal : "." or ","
        Decimal mark of text cells.
    signals : dict of ndarray, shape (n,)
        By role: op, pv, and sp and position where they are wanted and there. NaN where a cell is missing.
    stamps : Stamps or None
        Times; None without a time column, or with one that cannot be read and is not needed.
    clock : Clock
        Sampling time and gaps.
    assumed, words : tuple of str
        What was assumed about the columns; which words and times were passed over.
    made_up : (float, float)
        Shares of the samples of OP and PV that lie between stored values.
    start : datetime or None
        When the first sample was recorded; of a growing file None.
    gap_seconds : tuple of float
        What is missing at each gap of the clock; empty where that is not known.
    """

    table: Table
    columns: Columns
    used: tuple[str, ...]
    decimal: str
    signals: dict[str, FloatArray]
    stamps: Stamps | None
    clock: Clock
    assumed: tuple[str, ...]
    words: tuple[str, ...]
    made_up: tuple[float, float] = (0.0, 0.0)
    start: datetime | None = None
    gap_seconds: tuple[float, ...] = ()

    @property
    def notes(self) -> tuple[str, ...]:
        """All that was assumed, as sentences."""
        return (*self.assumed, *self.words, *self.clock.notes)


def interpret(
    table: Table,
    op: str = "OP",
    pv: str = "PV",
    sp: Wanted = "SP",
    position: Wanted = None,
    time: Wanted = None,
    mode: Wanted = None,
    dt: float | None = None,
    usable: Callable[[Stamps], Stamps] | None = None,
    loop: str | None = None,
    trust: Trust = ALL,
) -> Meaning:
    """Find out what the columns of a table mean; the settings are those of :func:`lostmotion.files.read_loop`.

    Parameters
    ----------
    usable : callable
        Stamps -> those that the sampling time is told from. A growing file, whose further rows are not known, drops
        a few bad ones. None: all rows are here, and are put into the order of time.
    trust : Trust
        What is believed of columns of quality; a growing file has none.

    Raises
    ------
    ColumnError, TimeError, DataError, ParameterError
        As in read_loop.

    Examples
    --------
    >>> import narwhals.stable.v2 as nw
    >>> import polars as pl
    >>> frame = pl.DataFrame({"t_s": ["0", "0,5", "1"], "CO": ["50", "51", "?"], "PV": ["1", "2", "1,5"]})
    >>> meaning = interpret(Table(nw.from_native(frame, eager_only=True), "a", None, ";"))
    >>> meaning.columns.op, meaning.decimal, meaning.clock.dt, meaning.signals["op"]
    ('CO', ',', 0.5, array([50., 51., nan]))
    """
    check_dt(dt)
    table = with_moments(table) if time is None else table
    if usable is None:
        table = with_columns_of_tags(table, trust)
    if len(table.frame) < FEWEST:
        raise DataError.expected(f"at least {FEWEST} rows", f"1 in {table.source!r}", "check the export")
    sampling = _sampling_column(table, (op, pv, sp, position, time, mode))
    columns = resolve([name for name in table.names if name != sampling], op, pv, sp, position, time, mode, loop)
    roles = (columns.op, columns.pv, columns.sp, columns.position, columns.time, sampling)
    used = tuple(name for name in roles if name is not None)
    decimal = decimal_mark(table, list(used))
    comma = ("Numbers were read with a decimal comma.",) if decimal == "," else ()
    signals, words = _signals(table, columns, decimal)
    if usable is None:
        words = (*words, *_without_bad(table, columns, signals, trust))
    stamps, doubt = _stamps(table, columns.time, decimal, dt)
    if stamps is not None and usable is not None:
        stamps = usable(stamps)
    elif stamps is not None:
        words = (*words, *open_date(stamps))
        table, signals, stamps = _in_order(table, signals, stamps)
        table = _holding(table, columns.mode)
        even = resampled(stamps.seconds, signals, dt, table.own_times)
        if even is not None:
            clock = Clock(even.dt, (), (*stamps.notes, even.note))
            assumed = (*table.notes, *columns.notes, *comma)
            taken, said = table.taken(even.rows), (*words, *doubt)
            start = moment_of(stamps, even.first)
            return Meaning(taken, columns, used, decimal, even.signals, None, clock, assumed, said, even.made_up, start)
    made_up = (0.0, 0.0)
    if usable is None and table.own_times:
        filled = held(table, {role: getattr(columns, role) for role in signals}, signals)
        table, signals, made_up = table.taken(filled.rows), filled.signals, filled.made_up
        words = (*words, *filled.notes)
        stamps = None if stamps is None else _of_rows(stamps, table, filled.rows)
    ts = None if sampling is None else _sampling_time(table, sampling, decimal)
    clock = _clock(table, columns.pv, stamps, dt, ts, whole=usable is None)
    assumed = (*table.notes, *columns.notes, *comma)
    words = (*words, *doubt)
    start, lost = began(stamps, clock) if usable is None else (None, ())
    return Meaning(table, columns, used, decimal, signals, stamps, clock, assumed, words, made_up, start, lost)


def _clock(table: Table, pv: str, stamps: Stamps | None, dt: float | None, ts: float | None, whole: bool) -> Clock:
    """Clock of the rows; where each tag has times of its own, the error tells of them."""
    if stamps is None or not table.own_times:
        return find_clock(stamps, dt, ts, whole)
    cause = None
    if len(stamps.seconds) >= FEWEST:
        try:
            return find_clock(stamps, dt, ts, whole)
        except TimeError as error:
            if dt is not None:
                raise
            cause = error
    raise no_common_rate(stamps.seconds, ~table.column(pv).is_null().to_numpy()) from cause


def _of_rows(stamps: Stamps, table: Table, rows: IntArray) -> Stamps:
    """Times of some of the rows."""
    dates = None if stamps.dates is None else stamps.dates[rows.tolist()]
    return replace(stamps.from_first(stamps.seconds[rows]), table=table, dates=dates)


def _in_order(
    table: Table, signals: dict[str, FloatArray], stamps: Stamps
) -> tuple[Table, dict[str, FloatArray], Stamps]:
    """Rows in the order of time, and what was done to have them so."""
    found = by_time(stamps) if table.own_times else arranged(stamps, list(signals.values()))
    notes = (*stamps.notes, *found.notes)
    if np.array_equal(found.rows, np.arange(len(stamps.seconds))):
        return table, signals, replace(stamps, seconds=found.seconds, notes=notes, set_back=found.set_back)
    table = table.taken(found.rows)
    moved = replace(stamps.from_first(found.seconds), table=table, notes=notes, set_back=found.set_back)
    return table, {role: values[found.rows] for role, values in signals.items()}, moved


def _holding(table: Table, mode: str | None) -> Table:
    """Modes hold until the next one, where each tag has times of its own."""
    if mode is None or not table.own_times:
        return table
    return replace(table, frame=table.frame.with_columns(nw.col(mode).fill_null(strategy="forward")))


def check_dt(dt: float | None) -> None:
    """Refuse a sampling time that is none."""
    if dt is not None:
        seconds("dt", dt)


def _sampling_column(table: Table, wanted: tuple[Wanted, ...]) -> str | None:
    """Column such as `ts` that repeats one number: the sampling time. Asked for by name, it is a column."""
    asked = {name.strip().lower() for name in wanted if isinstance(name, str)}
    for name in table.names:
        if key(name) not in SAMPLING_NAMES or name.strip().lower() in asked:
            continue
        series = table.column(name)
        cells = {str(value).strip() for value in series.drop_nulls().unique().to_list()} - {"", "nan"}
        if len(cells) == 1 and looks_numeric(next(iter(cells))):
            return name
    return None


def _sampling_time(table: Table, name: str, decimal: str) -> float | None:
    """Seconds that :func:`_sampling_column` repeats; None where they are no sampling time."""
    values, _ = to_numbers(table, name, decimal)
    value = float(values[~np.isnan(values)][0]) * (time_unit(name) or 1.0)
    return value if value > 0 else None


def _signals(table: Table, columns: Columns, decimal: str) -> tuple[dict[str, FloatArray], tuple[str, ...]]:
    signals: dict[str, FloatArray] = {}
    notes: tuple[str, ...] = ()
    for role in ("op", "pv", "sp", "position"):
        name = getattr(columns, role)
        if name is not None:
            signals[role], words = to_numbers(table, name, decimal)
            notes += words
            table.let_go([name])
    return signals, notes


def _without_bad(table: Table, columns: Columns, signals: dict[str, FloatArray], trust: Trust) -> tuple[str, ...]:
    """Make values missing whose quality is bad; notes."""
    notes: tuple[str, ...] = ()
    for role, values in signals.items():
        name = getattr(columns, role)
        beside = quality_column(table, name)
        if beside is not None and beside not in (columns.op, columns.pv, columns.sp, columns.position, columns.mode):
            bad, said = distrusted(table, beside, name, trust)
            values[bad] = np.nan
            notes += said
    return notes


def _stamps(table: Table, name: str | None, decimal: str, dt: float | None) -> tuple[Stamps | None, tuple[str, ...]]:
    """Read the time column; with dt given, one whose dates have two readings is left out."""
    if name is None:
        return None, ()
    try:
        return read_times(table, name, decimal), ()
    except AmbiguousDatesError:
        if dt is None:
            raise
        return None, (f"Day and month in {name!r} cannot be told apart; dt = {dt:g} s was not checked.",)
