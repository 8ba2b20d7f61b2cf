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
from lostmotion.files.dates import looks_numeric, parse_dates
from lostmotion.files.number_cells import BAD_WORDS, is_text, text_cells, to_numbers
from lostmotion.files.table import Table

# Medians of plain numbers above these are seconds, ms, us, ns since 1970 (1973 to 5138).
EPOCHS = ((1e17, 1e-9, "ns"), (1e14, 1e-6, "us"), (1e11, 1e-3, "ms"), (1e8, 1.0, "s"))
# Spreadsheets count days from 1900: 36526 is 2000 and 55153 is 2051.
EXCEL_DAYS = (36526.0, 55153.0)
MATLAB_DAYS = (719529.0, 767011.0)  # datenum counts them from the year 0: 1970 to 2099


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
    """

    name: str
    seconds: FloatArray
    table: Table = field(repr=False)
    plain: bool = False
    notes: tuple[str, ...] = ()
    dates: pl.Series | None = field(default=None, repr=False)
    scale: float = 1.0
    epoch: bool = False

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
        return _stamps(table, name, _float(series.dt.timestamp("us")) * 1e-6)
    if isinstance(series.dtype, nw.Duration):
        return _stamps(table, name, _float(series.dt.total_microseconds()) * 1e-6)
    if isinstance(series.dtype, nw.Date):
        return _stamps(table, name, _float(series.cast(nw.Datetime("us")).dt.timestamp("us")) * 1e-6)
    if is_text(series):
        cells = text_cells(series)
        cells = cells.set(cells.str.to_lowercase().is_in(list(BAD_WORDS)), None)
        known = cells.drop_nulls()
        if len(known) and not looks_numeric(known[0]):
            seconds, notes = parse_dates(table, name, cells)
            return replace(_stamps(table, name, seconds, notes=notes), dates=cells)
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
        return replace(stamps, scale=scale, epoch=True)
    middle = float(np.median(known)) if len(known) else 0.0
    for span, origin in ((EXCEL_DAYS, "a spreadsheet"), (MATLAB_DAYS, "MATLAB")):
        if _counts_days(known, middle, span):
            raise TimeError.expected(
                f"times in seconds or dates in column {name!r}",
                f"{known[0]:.10g}, a day number of {origin}",
                "export it as date and time or in seconds, or call the column time_s if it is in seconds",
            )
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


def _counts_days(known: FloatArray, middle: float, span: tuple[float, float]) -> bool:
    """Numbers of the size of today's day number that move by parts of a day."""
    if not span[0] < middle < span[1] or len(known) < 2:
        return False
    return 0 < float(np.median(np.abs(np.diff(known)))) < 0.1


def _stamps(table: Table, name: str, seconds: FloatArray, plain: bool = False, notes: tuple[str, ...] = ()) -> Stamps:
    known = seconds[~np.isnan(seconds)]
    if not len(known):
        raise TimeError.expected(
            f"times in column {name!r}", "none", "pass dt=<seconds> and time=False to ignore the column"
        )
    origin = 0.0 if plain else known[0]  # a counter is known by its first value
    return Stamps(name, np.asarray(seconds - origin), table, plain, notes)


def _float(series: nw.Series[Any]) -> FloatArray:
    return np.array(series.cast(nw.Float64).to_numpy(), dtype=np.float64)
