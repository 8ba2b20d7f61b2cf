"""Bounds of a slice of a record: rows, times since its first row, dates -> rows."""

from __future__ import annotations

import math
import operator
import re
import sys
from datetime import UTC, date, datetime, timedelta
from typing import TYPE_CHECKING, Any

import numpy as np

from lostmotion.errors import DataError, ParameterError

if TYPE_CHECKING:
    from lostmotion.records.record import LoopRecord

_UNITS = {"ms": 1e-3, "s": 1.0, "sec": 1.0, "min": 60.0, "m": 60.0, "h": 3600.0, "d": 86400.0, "w": 604800.0}
_PART = re.compile(r"(\d+(?:\.\d*)?|\.\d+)\s*([a-z]+)\s*")
_SAME = 1e-6  # of a sampling time: a bound this near to a row is that row
WAYS = "give rows (record[0:500]), times (record['10min':'2h']) or dates (record['2026-03-01 06:00':])"


def seconds_in(text: str) -> float | None:
    """Seconds of a time such as "90s", "1h30min" or "-2d"; None where the text is none.

    Examples
    --------
    >>> seconds_in("1h30min"), seconds_in("-1.5 d"), seconds_in("2026-03-01")
    (5400.0, -129600.0, None)
    """
    lower = text.strip().lower()
    sign, rest = (-1.0, lower[1:].lstrip()) if lower.startswith("-") else (1.0, lower)
    total, at = 0.0, 0
    for part in _PART.finditer(rest):
        if part.start() != at or part[2] not in _UNITS:
            return None
        total, at = total + float(part[1]) * _UNITS[part[2]], part.end()
    return sign * total if rest and at == len(rest) else None


def as_moment(value: Any) -> datetime:
    """Date and time of a datetime, a date, a NumPy or pandas time stamp or an ISO text.

    Raises
    ------
    ParameterError
        It is none of these.

    Examples
    --------
    >>> as_moment("2026-03-01 06:00"), as_moment(np.datetime64("2026-03-01"))
    (datetime.datetime(2026, 3, 1, 6, 0), datetime.datetime(2026, 3, 1, 0, 0))
    """
    given = value
    if isinstance(value, np.datetime64):
        value = value.astype("datetime64[us]").item()
    elif isinstance(value, str):
        try:
            value = datetime.fromisoformat(value.strip())
        except ValueError as error:
            raise ParameterError.expected("a date such as '2026-03-01 06:00'", repr(value), WAYS) from error
    elif hasattr(value, "to_pydatetime"):
        value = value.to_pydatetime()
    if isinstance(value, date) and not isinstance(value, datetime):
        value = datetime(value.year, value.month, value.day)
    if not isinstance(value, datetime) or not _has_utc(value):
        raise ParameterError.expected("a date such as '2026-03-01 06:00'", repr(given), WAYS)
    return value


def _has_utc(moment: datetime) -> bool:
    """Whether a moment lies in the years 1 to 9999 of UTC too."""
    try:
        return moment.tzinfo is None or moment.astimezone(UTC) is not None
    except OverflowError:
        return False


def bound(record: LoopRecord, value: Any) -> int | None:
    """Row that a bound of a slice stands for; None and negative rows as in a list.

    Raises
    ------
    ParameterError
        A bound that is no row, time or date, or a date of a record whose dates are not known.
    """
    if value is None:
        return None
    seconds = _seconds(value)
    if seconds is not None:
        return _first_from((seconds + (len(record) * record.dt if seconds < 0 else 0.0)) / record.dt)
    if isinstance(value, str | date | np.datetime64):
        return _row_of(record, as_moment(value))
    try:
        return operator.index(value)
    except TypeError as error:
        raise ParameterError.expected("a slice from one bound to another", repr(value), WAYS) from error


def _seconds(value: Any) -> float | None:
    """Of a time; None for rows and dates."""
    if isinstance(value, str):
        return seconds_in(value)
    if isinstance(value, np.timedelta64):
        return float(value / np.timedelta64(1, "ns")) * 1e-9
    return value.total_seconds() if isinstance(value, timedelta) else None


def _first_from(steps: float) -> int:
    """First row that is not before so many sampling times."""
    return max(math.ceil(min(steps - _SAME, sys.maxsize)), 0)


def _row_of(record: LoopRecord, moment: datetime) -> int:
    """First row at or after a moment."""
    if record.start is None:
        got = f"{moment}, and the record does not say when it began"
        remedy = "give rows or times, or say it: dataclasses.replace(record, start='2026-03-01 06:00')"
        raise ParameterError.expected("rows or times since the first row", got, remedy)
    elapsed = elapsed_seconds(record.start, moment)
    stretches = record.stretch_starts
    if stretches is None:
        gap = record.gaps[0]
        if elapsed <= gap * record.dt:
            return _first_from(elapsed / record.dt)
        known = f"a date up to {record.start + timedelta(seconds=gap * record.dt)}, where time is missing"
        raise ParameterError.expected(known, moment, "how much is missing is not known; give rows behind it")
    edges = [0, *record.gaps, len(record)]
    last = max(int(np.searchsorted(stretches, elapsed + _SAME * record.dt, side="right")) - 1, 0)
    row = edges[last] + _first_from((elapsed - stretches[last]) / record.dt)
    return min(row, edges[last + 1])


def elapsed_seconds(start: datetime, moment: datetime) -> float:
    """Seconds from one moment to another; one without a time zone is in that of the start.

    Raises
    ------
    ParameterError
        The moment has a time zone, the start has none.
    """
    if start.tzinfo is None and moment.tzinfo is not None:
        raise ParameterError.expected("a date without time zone, as the record's", moment, "leave the zone out")
    if start.tzinfo is not None:
        moment = moment if moment.tzinfo is not None else moment.replace(tzinfo=start.tzinfo)
        start, moment = start.astimezone(UTC), moment.astimezone(UTC)  # across a change of the clock as well
    return (moment - start).total_seconds()


def later(start: datetime, seconds: float) -> datetime:
    """Moment so many seconds after the start, in its time zone."""
    if start.tzinfo is None:
        return start + timedelta(seconds=seconds)
    return (start.astimezone(UTC) + timedelta(seconds=seconds)).astimezone(start.tzinfo)


def nothing_there(record: LoopRecord, rows: slice, count: int) -> DataError:
    """Error of a slice that holds too little, with the span that there is."""
    there = f"rows 0 .. {len(record)}, 0 s .. {len(record) * record.dt:g} s"
    if record.start is not None:
        there += f", {record.start} .. {record.moment(len(record) - 1) or 'unknown'}"
    got = f"{count} in {rows.start!r}:{rows.stop!r}"
    return DataError.expected("at least 2 samples", got, f"the record holds {there}")
