"""Times of the rows -> when the record began and what is missing at its gaps, where dates tell it."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta, timezone, tzinfo
from typing import Any
from zoneinfo import ZoneInfo

import narwhals.stable.v2 as nw
import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.files.clock import Clock, counts_samples
from lostmotion.files.dates import date_orders, dates_in_order, zone_of
from lostmotion.files.times import Stamps

OLDEST = 315_532_800.0  # 1980: dates before it count from nowhere, as 1970-01-01 00:00:05 does
COUNTED = (946_684_800.0, 2_556_144_000.0)  # 2000 to 2051: of this size are the seconds of today
ASTRAY = 60.0  # s, and a step: a date that is further from the time in the file is none
EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
DIGITS = 4  # of a second, that seconds since 1970 resolve


def began(stamps: Stamps | None, clock: Clock) -> tuple[datetime | None, tuple[float, ...]]:
    """When the first row was recorded, and the seconds that are missing at each gap.

    Parameters
    ----------
    stamps : Stamps or None
        Times of the rows, in their order.
    clock : Clock
        Sampling time and gaps.

    Returns
    -------
    start : datetime or None
        As the file writes it: without a zone where it states none. None: the times are no dates, day and month cannot
        be told apart, the clock was set back, or the sampling time does not lead from the first date to the others.
    gap_seconds : tuple of float
        Such that the first row behind each gap has its own time; empty where a row has no time.

    Examples
    --------
    >>> import polars as pl
    >>> from lostmotion.files.table import Table
    >>> from lostmotion.files.times import read_times
    >>> frame = pl.DataFrame({"Date": [f"2026-03-01 06:{minute:02}" for minute in (0, 1, 2, 30, 31)]})
    >>> stamps = read_times(Table(nw.from_native(frame, eager_only=True), "a"), "Date")
    >>> began(stamps, Clock(60.0, (3,)))
    (datetime.datetime(2026, 3, 1, 6, 0), (1620.0,))
    """
    if stamps is None or np.isnan(stamps.seconds).any():
        return None, ()
    seconds = stamps.seconds - stamps.seconds[0]
    if counts_samples(stamps, np.diff(seconds)):
        seconds = seconds * clock.dt
    rows = np.array(clock.gaps, dtype=np.int64)
    lost = np.maximum.accumulate(np.maximum(seconds[rows] - rows * clock.dt, 0.0))
    found = tuple(np.round(np.diff(lost, prepend=0.0), DIGITS).tolist())
    return (moment_of(stamps, stamps.seconds[0]) if _lead(seconds, rows, lost, clock.dt) else None), found


def _lead(seconds: FloatArray, rows: np.ndarray[Any, np.dtype[np.int64]], lost: FloatArray, dt: float) -> bool:
    """Whether the sampling time leads from the first row to either end of every stretch."""
    ends = np.array([*(rows - 1), len(seconds) - 1, *rows])
    told = ends * dt + np.concatenate([[0.0], lost, lost])
    steps = np.diff(seconds)
    steps[rows - 1] = 0.0
    return bool((np.abs(seconds[ends] - told) <= ASTRAY + steps.max(initial=0.0)).all())


def moment_of(stamps: Stamps, seconds: float) -> datetime | None:
    """Date of a time of the rows; None where the times are no dates, or not certain."""
    count = stamps.origin + float(seconds)
    series = stamps.table.column(stamps.name)
    written = stamps.dates is not None or isinstance(series.dtype, nw.Datetime | nw.Date)
    low, high = (OLDEST, np.inf) if written else COUNTED
    if not stamps.certain or stamps.set_back or not low <= count <= high:
        return None
    zone = None if stamps.local or isinstance(series.dtype, nw.Date) else _zone(stamps, series)
    moment = EPOCH + timedelta(seconds=round(count, DIGITS))
    return moment.replace(tzinfo=None) if zone is None else moment.astimezone(zone)


def open_date(stamps: Stamps | None) -> tuple[str, ...]:
    """Sentence that names the days on which the record may have begun, where its dates have several readings.

    Examples
    --------
    >>> import polars as pl
    >>> from lostmotion.files.table import Table
    >>> from lostmotion.files.times import read_times
    >>> frame = pl.DataFrame({"Date": [f"03/02/2026 06:{minute:02}" for minute in range(9)]})
    >>> print(*open_date(read_times(Table(nw.from_native(frame, eager_only=True), "a"), "Date")))
    '03/02/2026 06:00' in 'Date' may be 2026-02-03 (day first) or 2026-03-02 (month first): the record has no date; \
times of day and sampling time hold. Export ISO dates (2026-02-03).
    """
    if stamps is None or stamps.dates is None or stamps.certain:
        return ()
    first = stamps.dates.drop_nulls()[:1]
    orders = date_orders(stamps.table, stamps.name, stamps.dates)
    days = [(EPOCH + timedelta(seconds=float(dates_in_order(first, order)[0]))).date() for order in orders]
    shown = " or ".join(f"{day} ({order})" for day, order in zip(days, orders, strict=True))
    return (
        f"{first[0]!r} in {stamps.name!r} may be {shown}: the record has no date; times of day and sampling time hold. "
        f"Export ISO dates ({days[0]}).",
    )


def _zone(stamps: Stamps, series: nw.Series[Any]) -> tzinfo:
    """Zone that the first time states; UTC for seconds since 1970, and where its name is not known here."""
    if stamps.dates is not None:
        return timezone(timedelta(seconds=zone_of(stamps.dates)))
    name = getattr(series.dtype, "time_zone", None)
    try:
        return UTC if name in (None, "UTC") else ZoneInfo(str(name))
    except (LookupError, ValueError, OSError):  # a folder of zones is no zone
        return UTC
