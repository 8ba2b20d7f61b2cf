"""Cells of dates and times of day -> the numbers in them, in whatever order day, month and year stand."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import polars as pl

from lostmotion.arrays import FloatArray
from lostmotion.files.fixed_cells import FixedCells, Ints, fixed_cells
from lostmotion.records.sampling import Bools

FARTHEST_ZONE = 15 * 3600.0  # s from UTC: the zones of today end at +14:00, those of the past before 16 h
MANY = 200_000  # cells at a time: as text, their parts take much room
_MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")
DATE = (
    r"^(?:(?P<a>[0-9]{1,4})[-/. ](?P<b>[0-9]{1,2}|[A-Za-z]{3,9})[-/. ](?P<c>[0-9]{1,4})[T ,]*)?"
    r"(?:(?P<hour>[0-9]{1,2}):(?P<minute>[0-9]{2})(?::(?P<second>[0-9]{2})(?:[.,](?P<fraction>[0-9]{1,9}))?)?)?"
    r"[ \t]*(?P<half>[AaPp])?(?:\.?[Mm]\.?)?[ \t]*(?P<zone>Z|UTC|[+-][0-9]{2}:?[0-9]{2})?$"
)
ORDERS = {"day first": "dmy", "month first": "mdy", "year first": "ymd"}


@dataclass(frozen=True, eq=False)
class Parts:
    """What the cells hold: whether a date and a time of day, seconds of the latter, and the numbers of the former.

    A cell whose time zone is none, such as +24:00, is neither a date nor a time of day.
    """

    dated: Bools
    timed: Bools
    seconds: FloatArray
    numbers: tuple[Ints, Ints, Ints]
    digits: tuple[npt.NDArray[np.int8], npt.NDArray[np.int8]]  # letters of the first and the last part of the date
    month_named: bool

    def days(self, order: str) -> FloatArray:
        """Days from 1970-01-01 in one order; NaN where there is none."""
        place = dict(zip(ORDERS[order], self.numbers, strict=True))
        days = np.empty(len(self.dated))
        for first in range(0, len(days), MANY):
            some = slice(first, first + MANY)
            days[some] = days_from_date(place["y"][some], place["m"][some], place["d"][some])
        return days


def parts_of(cells: pl.Series) -> Parts:
    """Parts of all cells; some at a time, since as text they take much room."""
    pieces = [_piece(cells[first : first + MANY]) for first in range(0, max(len(cells), 1), MANY)]
    return Parts(
        np.concatenate([piece.dated for piece in pieces]),
        np.concatenate([piece.timed for piece in pieces]),
        np.concatenate([piece.seconds for piece in pieces]),
        _joined([piece.numbers for piece in pieces]),
        _joined([piece.digits for piece in pieces]),
        any(piece.month_named for piece in pieces),
    )


def _joined(pieces: list[Any]) -> Any:
    return tuple(np.concatenate(part) for part in zip(*pieces, strict=True))


def _piece(cells: pl.Series) -> Parts:
    alike = fixed_cells(cells, DATE)
    return _of_any(cells) if alike is None else _of_alike(alike)


def _of_alike(cells: FixedCells) -> Parts:
    named = cells.text("b").isalpha()
    month = _month_numbers(pl.Series([cells.text("b")])) if named else cells.numbers("b")
    sign = -1.0 if cells.text("zone").startswith("-") else 1.0
    ahead = _ahead(sign, *(cells.numbers("zone", 0, first, first + 2) for first in (0, 2)))
    real = ~np.isnan(ahead)
    return Parts(
        real & bool(cells.text("a")),
        real & bool(cells.text("hour")),
        _time_of_alike(cells) - ahead,
        (cells.numbers("a"), np.broadcast_to(month, len(cells)), cells.numbers("c")),
        tuple(np.full(len(cells), len(cells.text(side)), dtype=np.int8) for side in "ac"),  # type: ignore[arg-type]
        named,
    )


def _time_of_alike(cells: FixedCells) -> FloatArray:
    hour, minute, second = (cells.numbers(group, default=0) for group in ("hour", "minute", "second"))
    half = cells.text("half").lower()
    hour = hour % 12 + (12 if half == "p" else 0) if half else hour
    return np.asarray(hour * 3600.0 + minute * 60.0 + second + cells.fraction("fraction"))


def _of_any(cells: pl.Series) -> Parts:
    parts = cells.str.extract_groups(DATE).struct.unnest()
    ahead = zone_seconds(parts["zone"])
    real = ~np.isnan(ahead)
    return Parts(
        real & parts["a"].is_not_null().to_numpy(),
        real & parts["hour"].is_not_null().to_numpy(),
        _time_of_day(parts) - ahead,
        (_ints(parts["a"]), _month_numbers(parts["b"]), _ints(parts["c"])),
        tuple(parts[side].str.len_chars().fill_null(0).to_numpy().astype(np.int8) for side in "ac"),  # type: ignore[arg-type]
        bool(parts["b"].str.contains("[A-Za-z]").fill_null(value=False).any()),
    )


def days_from_date(year: Ints, month: Ints, day: Ints) -> FloatArray:
    """Days from 1970-01-01; NaN where there is no such day. Years below 70 are 20xx, below 100 19xx.

    Examples
    --------
    >>> days_from_date(np.array([1970, 24, 2023]), np.array([1, 2, 2]), np.array([2, 29, 29]))
    array([1.0000e+00, 1.9782e+04,        nan])
    """
    full = np.where(year < 70, year + 2000, np.where(year < 100, year + 1900, year))
    possible = (month >= 1) & (month <= 12) & (day >= 1) & (full < 3000)
    start = (np.where(possible, (full - 1970) * 12 + month - 1, 0)).astype("datetime64[M]")
    length = ((start + 1).astype("datetime64[D]") - start.astype("datetime64[D]")).astype(np.int64)
    days = start.astype("datetime64[D]").astype(np.int64) + day - 1
    return np.where(possible & (day <= length), days, np.nan).astype(np.float64)


def _time_of_day(parts: pl.DataFrame) -> FloatArray:
    hour = _ints(parts["hour"], 0)
    half = parts["half"].str.to_lowercase()
    after, before = ((half == letter).fill_null(value=False).to_numpy() for letter in "pa")
    hour = np.where(after, hour % 12 + 12, np.where(before, hour % 12, hour))
    fraction = ("0." + parts["fraction"].fill_null("0")).cast(pl.Float64).to_numpy()
    return np.asarray(hour * 3600.0 + _ints(parts["minute"], 0) * 60.0 + _ints(parts["second"], 0) + fraction)


def zone_seconds(zone: pl.Series) -> FloatArray:
    """Seconds ahead of UTC; 0 for Z and where none is stated, NaN for what is no zone, such as +24:00."""
    digits = zone.str.replace(":", "", literal=True)
    sign = np.where(digits.str.starts_with("-").fill_null(value=False).to_numpy(), -1.0, 1.0)
    return _ahead(sign, _ints(digits.str.slice(1, 2), 0), _ints(digits.str.slice(3, 2), 0))


def _ahead(sign: FloatArray | float, hours: Ints, minutes: Ints) -> FloatArray:
    seconds = hours * 3600.0 + minutes * 60.0
    return np.asarray(np.where((seconds <= FARTHEST_ZONE) & (minutes < 60), sign * seconds, np.nan))


def _ints(column: pl.Series, default: int = -1) -> Ints:
    return np.asarray(column.cast(pl.Int32, strict=False).fill_null(default).to_numpy(), dtype=np.int32)


def _month_numbers(column: pl.Series) -> Ints:
    short = column.str.to_lowercase().str.slice(0, 3)
    numbers = {name: str(place + 1) for place, name in enumerate(_MONTHS)}
    named = short.str.contains("[a-z]").fill_null(value=False)
    return _ints(short.replace_strict(numbers, default=None).zip_with(named, column))
