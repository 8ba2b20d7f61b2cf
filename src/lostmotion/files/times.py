"""Time column -> seconds: plain numbers, units in the name, epochs, dates, durations."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import narwhals.stable.v2 as nw
import numpy as np
import polars as pl

from lostmotion.arrays import FloatArray
from lostmotion.errors import TimeError
from lostmotion.files.columns import time_unit
from lostmotion.files.dates import all_are, looks_numeric, parse_dates, states_zone
from lostmotion.files.number_cells import is_text, text_cells, to_numbers, without_words
from lostmotion.files.table import Table

# Medians of plain numbers above these are seconds, ms, us, ns since 1970 (1973 to 5138).
FIRST_DATE, LAST_DATE = -62_135_596_800.0, 253_402_300_799.0  # seconds since 1970 of the years 1 and 9999
EPOCHS = ((1e17, 1e-9, "ns"), (1e14, 1e-6, "us"), (1e11, 1e-3, "ms"), (1e8, 1.0, "s"))
DAY_SPANS = {  # of whom: from 2000 or 1970 on, up to 2051 or 2099, and the number of 1970-01-01
    "a spreadsheet": (36526.0, 55153.0, 25569.0),
    "MATLAB": (719529.0, 767011.0, 719529.0),
}
DAY = 86400.0  # s
DAY_DECIMALS = 3  # of a second: what a double of 45000 and some days resolves


@dataclass(frozen=True, eq=False)
class Stamps:
    """Times of the rows.

    Parameters
    ----------
    name : str
        Name of the column.
    seconds : ndarray, shape (n,)
        From the first row; NaN where the cell is empty.
    table : Table
        Where the column is, for messages.
    plain : bool
        Numbers without unit: they may count samples instead of seconds.
    notes : tuple of str
        What was assumed.
    dates : polars.Series of str, optional
        Stripped cells, null where missing, of dates and times of day in text; None for numbers and dates of frames.
    scale : float
        Seconds in one unit of a numeric column.
    epoch : bool
        Numbers that count from 1970.
    origin : float
        First time as it was read; seconds since 1970 for dates.
    local : bool
        Dates by the clock on the wall, which may be set back in autumn.
    certain : bool
        The first date has one reading, or is none.
    set_back : bool
        That clock was set back on the way: from there on the times are no longer what it showed.
    """

    name: str
    seconds: FloatArray
    table: Table = field(repr=False)
    plain: bool = False
    notes: tuple[str, ...] = ()
    dates: pl.Series | None = field(default=None, repr=False)
    scale: float = 1.0
    epoch: bool = False
    origin: float = 0.0
    local: bool = False
    certain: bool = True
    set_back: bool = False

    def from_first(self, seconds: FloatArray) -> Stamps:
        """The same with other times, of which the first is the new origin."""
        return replace(self, seconds=seconds - seconds[:1], origin=self.origin + float(seconds[0]))

    def at(self, row: int) -> str:
        """Say row, line and the time as it stands in the source."""
        return f"{self.table.column(self.name)[row]!s} in {self.table.where(row)}"


def read_times(table: Table, name: str, decimal: str = ".") -> Stamps:
    """Read a time column.

    Raises
    ------
    TimeError
        A cell is no time, or days and months cannot be told apart.

    Examples
    --------
    >>> import polars as pl
    >>> table = Table(nw.from_native(pl.DataFrame({"t_ms": [0, 250]}), eager_only=True), "a")
    >>> read_times(table, "t_ms").seconds
    array([0.  , 0.25])
    """
    series = table.column(name)
    if isinstance(series.dtype, nw.Datetime):
        stamps = _stamps(table, name, _of_our_era(name, series))
        return replace(stamps, local=series.dtype.time_zone is None)
    if isinstance(series.dtype, nw.Duration):
        return _stamps(table, name, _float(series.dt.total_microseconds()) * 1e-6)
    if isinstance(series.dtype, nw.Date):
        return _stamps(table, name, _of_our_era(name, series.cast(nw.Datetime("ms"))))
    if is_text(series):
        cells = without_words(text_cells(series))
        known = cells.drop_nulls()
        if len(known) and not looks_numeric(known[0]):
            seconds, notes, certain = parse_dates(table, name, cells)
            local = not (states_zone(cells) or all_are(cells, dated=False))
            return replace(_stamps(table, name, seconds, notes=notes), dates=cells, local=local, certain=certain)
    values, notes = to_numbers(table, name, decimal)
    return _from_numbers(table, name, values, notes)


def time_text(seconds: float, calendar: str = "") -> str:
    """Time as a date where it counts from 1970 ("local" or "UTC"), else in seconds.

    Examples
    --------
    >>> time_text(86400.5, "UTC"), time_text(86400.0, "local"), time_text(12.25)
    ('1970-01-02T00:00:00.500Z', '1970-01-02T00:00:00', '12.25 s')
    """
    if np.isnan(seconds):
        return "no time"
    if not calendar:
        return f"{seconds:.12g} s"
    moment = np.datetime64(round(seconds * 1e3), "ms")
    text = str(moment).removesuffix(".000")
    return f"{text}Z" if calendar == "UTC" else text


def _from_numbers(table: Table, name: str, values: FloatArray, notes: tuple[str, ...]) -> Stamps:
    known = values[~np.isnan(values)]
    scale, label = number_scale(name, known)
    if scale is not None and not label:
        return replace(_stamps(table, name, values * scale, notes=notes), scale=scale)
    if scale is not None:
        note = f"Times in {name!r} were read as {label} since 1970."
        stamps = _stamps(table, name, (values - known[0]) * scale, notes=(*notes, note))
        return replace(stamps, scale=scale, epoch=True, origin=float(known[0]) * scale)
    days = day_numbers(known)
    if days and not _round_steps(known):
        seconds = np.round((values - known[0]) * DAY, DAY_DECIMALS)
        note = f"Times in {name!r} were read as day numbers of {days}."
        origin = float((known[0] - DAY_SPANS[days][2]) * DAY)
        stamps = _stamps(table, name, seconds, notes=(*notes, note))
        return replace(stamps, scale=DAY, local=True, origin=origin)
    if days:
        raise _days_or_seconds(name, known, days)
    return _stamps(table, name, values, plain=True, notes=notes)


def number_scale(name: str, known: FloatArray) -> tuple[float | None, str]:
    """Seconds in one unit of a numeric time column, and the unit where it counts from 1970; None: not stated.

    Examples
    --------
    >>> number_scale("t_ms", np.array([0.0, 250.0])), number_scale("time", np.array([1.7e12]))
    ((0.001, ''), (0.001, 'ms'))
    """
    unit = time_unit(name)
    if unit is not None:
        return unit, ""
    middle = float(np.median(known)) if len(known) else 0.0
    for above, scale, label in EPOCHS:
        if middle > above:
            return scale, label
    return None, ""


def day_numbers(known: FloatArray) -> str:
    """Whose day numbers the times look like: of the size of today's and moving by parts of a day; empty: no one's.

    Examples
    --------
    >>> day_numbers(45000 + np.arange(5) / 1440), day_numbers(np.arange(5.0))
    ('a spreadsheet', '')
    """
    if len(known) < 2:
        return ""
    middle = float(np.median(known))
    moves = 0 < float(np.median(np.abs(np.diff(known)))) < 0.1
    fits = [whose for whose, (first, last, _) in DAY_SPANS.items() if moves and first < middle < last]
    return fits[0] if fits else ""


def _round_steps(known: FloatArray) -> bool:
    """Steps of whole milliseconds, as of a clock in seconds: a second is no such part of a day."""
    step = float(np.median(np.abs(np.diff(known)))) * 1e3
    return abs(step - round(step)) < 1e-6 * max(step, 1.0)


def _days_or_seconds(name: str, known: FloatArray, whose: str) -> TimeError:
    step = float(f"{np.median(np.abs(np.diff(known))):.6g}")
    return TimeError.expected(
        f"times with one reading in column {name!r}",
        f"{known[0]:.10g} and steps of {step:g}, seconds or day numbers of {whose}",
        f"give dt={step:g} and time=False if it is in seconds, or dt={step * DAY:g} and time=False if in days",
    ).leads_on({"dt": step, "time": False}, {"dt": float(f"{step * DAY:g}"), "time": False})


def _stamps(table: Table, name: str, seconds: FloatArray, plain: bool = False, notes: tuple[str, ...] = ()) -> Stamps:
    known = seconds[~np.isnan(seconds)]
    if not len(known):
        raise TimeError.expected(
            f"times in column {name!r}", "none", "pass dt=<seconds> and time=False to ignore the column"
        )
    origin = 0.0 if plain else known[0]  # a counter is known by its first value
    return Stamps(name, np.asarray(seconds - origin), table, plain, notes, origin=float(origin))


def _of_our_era(name: str, series: nw.Series[Any]) -> FloatArray:
    """Seconds since 1970, all of them dates of the calendar: frames hold any number as one."""
    seconds = _float(series.dt.timestamp("ms")) * 1e-3  # microseconds of far dates are more than 64 bits hold
    wrong = (seconds < FIRST_DATE) | (seconds > LAST_DATE)
    if wrong.any():
        raise TimeError.expected(
            f"dates of the years 1 to 9999 in column {name!r}",
            f"{int(wrong.sum())} others, the first in row {int(np.argmax(wrong)) + 1}",
            "export it again, or pass dt=<seconds> and time=False to ignore the column",
        )
    return _float(series.dt.timestamp("us")) * 1e-6


def _float(series: nw.Series[Any]) -> FloatArray:
    return np.array(series.cast(nw.Float64).to_numpy(), dtype=np.float64)
