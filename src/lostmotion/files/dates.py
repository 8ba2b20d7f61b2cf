"""Dates written as text -> seconds; whether day or month comes first is decided by the column, or refused."""

from __future__ import annotations

import re

import numpy as np
import polars as pl

from lostmotion.arrays import FloatArray
from lostmotion.errors import TimeError
from lostmotion.files.date_parts import DATE, Parts, parts_of, zone_seconds
from lostmotion.files.table import Table
from lostmotion.records.sampling import Bools

# A reading of the dates whose longest step is this many times another's is wrong: its days became months.
LONGEST_STEP = 20.0
DOTTED = r"^[0-9]{1,2}\.[0-9]{1,2}\."  # 02.03.2026: where dates are written with dots, the day is first
_PERHAPS_A_ZONE = r"(?:Z|UTC|[+-][0-9]{2}:?[0-9]{2})$"
FEW = 1000  # cells that tell that not all are alike, as they mostly are not


class AmbiguousDatesError(TimeError):
    """Day and month cannot be told apart, and it matters."""


def parse_dates(table: Table, name: str, cells: pl.Series) -> tuple[FloatArray, tuple[str, ...], bool]:
    """Seconds of dates and times of day; missing cells are NaN.

    Parameters
    ----------
    table : Table
        Where the column is, for messages.
    name : str
        Name of the column.
    cells : polars.Series of str
        Stripped cells; null where empty. ISO 8601, or numbers and month names in any of the usual orders.

    Returns
    -------
    seconds : ndarray, shape (n,)
        From 1970-01-01, or from midnight where there is no date.
    notes : tuple of str
        The order that was chosen, where more than one was possible.
    certain : bool
        No other order gives the same steps from other days.

    Raises
    ------
    TimeError
        A cell is no date, or the order of day and month cannot be decided and matters.

    Examples
    --------
    >>> import narwhals.stable.v2 as nw
    >>> cells = pl.Series("t", ["21-Jan-17 15:20:00", "1/21/2017 3:20:30 PM"])
    >>> table = Table(nw.from_native(cells.to_frame(), eager_only=True), "a")
    >>> [round(parse_dates(table, "t", cells[row : row + 1])[0][0]) for row in (0, 1)]
    [1485012000, 1485012030]
    """
    filled = cells.is_not_null().to_numpy()
    parts = parts_of(cells)
    dated = parts.dated
    strange = filled & ~(dated | parts.timed) | (filled & (dated != dated[filled][0]) if filled.any() else filled)
    if strange.any():
        raise _no_date(table, name, cells, int(np.flatnonzero(strange)[0]))
    seconds = np.where(filled, parts.seconds, np.nan)
    if not dated.any():
        return seconds, (), True
    return _choose(table, name, cells, _readings(parts, filled), seconds)


def date_orders(table: Table, name: str, cells: pl.Series) -> tuple[str, ...]:
    """Orders of day, month and year that read the column as :func:`parse_dates` does, up to a constant.

    Returns
    -------
    tuple of str
        Keys for :func:`dates_in_order`; ("",) where the cells hold times of day only.

    Examples
    --------
    >>> import narwhals.stable.v2 as nw
    >>> cells = pl.Series("t", ["05/06/2024 10:00", "05/06/2024 10:01"])
    >>> date_orders(Table(nw.from_native(cells.to_frame(), eager_only=True), "a"), "t", cells)
    ('day first', 'month first')
    """
    seconds, _, _ = parse_dates(table, name, cells)
    known = ~np.isnan(seconds)
    parts = parts_of(cells)
    if not parts.dated.any():
        return ("",)
    first = int(np.argmax(known))
    elapsed = seconds - seconds[first]
    readings = {order: dates_in_order(cells, order) for order in _readings(parts, known)}
    return tuple(
        order
        for order, times in readings.items()
        if np.allclose(times - times[first], elapsed, rtol=0.0, atol=1e-3, equal_nan=True)
    )


def all_are(cells: pl.Series, *, dated: bool) -> bool:
    """Whether every cell is a date without a time of day, or (not `dated`) a time of day without a date.

    Examples
    --------
    >>> all_are(pl.Series(["1.2.2024", None]), dated=True), all_are(pl.Series(["1.2.2024 10:00"]), dated=True)
    (True, False)
    """
    known = cells.drop_nulls()
    return len(known) > 0 and _alike(known[:FEW], dated=dated) and _alike(known.unique(), dated=dated)


def _alike(cells: pl.Series, *, dated: bool) -> bool:
    parts = cells.str.extract_groups(DATE).struct.unnest()
    date, time = parts["a"].is_not_null(), parts["hour"].is_not_null()
    return bool((date & ~time).all() if dated else (time & ~date).all())


def dates_in_order(cells: pl.Series, order: str) -> FloatArray:
    """Seconds of dates in one order of day, month and year; NaN for every cell that is no such date.

    Parameters
    ----------
    cells : polars.Series of str
        Stripped cells; null where empty.
    order : str
        From :func:`date_orders`.

    Examples
    --------
    >>> dates_in_order(pl.Series(["02.01.1970 00:00:01", "soon", None]), "day first")
    array([86401.,    nan,    nan])
    """
    if order != "year first":
        return _slow_dates(cells, order)
    times = _iso_dates(cells)
    rest = np.flatnonzero(np.isnan(times) & cells.is_not_null().to_numpy())
    if rest.size:
        times[rest] = _slow_dates(cells.gather(rest), order)
    return times


def _iso_dates(cells: pl.Series) -> FloatArray:
    """Seconds of 2017-01-21 15:20:00, with T or up to six decimals, by the fast parser; NaN for all else."""
    blank = cells.str.replace("T", " ", literal=True)
    full = blank.str.len_bytes().is_between(19, 26).fill_null(value=False)
    moments = blank.set(~full, None).str.to_datetime("%Y-%m-%d %H:%M:%S%.f", strict=False, time_unit="us")
    known = moments.is_not_null().to_numpy()
    count = moments.to_physical().fill_null(0).to_numpy()
    whole, fraction = count // 1_000_000, count % 1_000_000 / 1e6
    times = (whole % 86_400 + fraction) + (whole // 86_400) * 86_400.0  # rounded as in _slow_dates
    return np.where(known, times, np.nan)


def _slow_dates(cells: pl.Series, order: str) -> FloatArray:
    parts = parts_of(cells)
    if not order:
        return np.where(parts.timed & ~parts.dated, parts.seconds, np.nan)
    return np.where(parts.dated, parts.days(order) * 86400.0 + parts.seconds, np.nan)


def states_zone(cells: pl.Series) -> bool:
    """Tell dates that carry a time zone; they are then seconds of UTC."""
    perhaps = cells.filter(cells.str.contains(_PERHAPS_A_ZONE).fill_null(value=False))
    return bool(perhaps.str.extract_groups(DATE).struct.field("zone").is_not_null().any())


def zone_of(cells: pl.Series) -> float:
    """Seconds by which the zone of the first cell that states one is ahead of UTC; 0 where none does.

    Examples
    --------
    >>> zone_of(pl.Series(["2026-03-01 06:00:00+01:00", "2026-03-01 06:01:00+01:00"]))
    3600.0
    """
    first = cells.filter(cells.str.contains(_PERHAPS_A_ZONE).fill_null(value=False))[:1]
    ahead = zone_seconds(first.str.extract_groups(DATE).struct.field("zone"))
    return float(ahead[0]) if len(ahead) else 0.0


def _choose(
    table: Table, name: str, cells: pl.Series, days: dict[str, FloatArray], seconds: FloatArray
) -> tuple[FloatArray, tuple[str, ...], bool]:
    filled = ~np.isnan(seconds)
    valid = {order: day * 86400.0 + seconds for order, day in days.items() if not np.isnan(day[filled]).any()}
    if not valid:
        wrong = np.sum([np.isnan(day) & filled for day in days.values()], axis=0)
        raise _no_date(table, name, cells, int(np.argmax(wrong)))
    left = _distinct({order: time for order, time in valid.items() if _sorted(time) or _sorted(-time)} or valid)
    limit = LONGEST_STEP * min(_longest_step(time) for time in left.values())
    left = {order: time for order, time in left.items() if _longest_step(time) <= limit}
    dotted = bool(cells.drop_nulls()[:1].str.contains(DOTTED).any()) and next(iter(left)) == "day first"
    if len(left) > 1 and not dotted:
        raise AmbiguousDatesError.expected(
            f"dates with one reading in column {name!r}",
            f"{cells.drop_nulls()[0]!r} to {cells.drop_nulls()[-1]!r}, {' or '.join(left)}",
            "give dt=<seconds>, or export ISO dates (2017-01-21 15:20:00)",
        )
    order, chosen = next(iter(left.items()))
    certain = dotted or "month first" not in days or _alone(valid, chosen)  # 21-Jan-17 is never the 17th
    if len(_distinct(valid)) == 1:
        return chosen, (), certain
    return chosen, (f"Dates in {name!r} were read {order}, the reading whose times follow each other.",), certain


def _alone(valid: dict[str, FloatArray], chosen: FloatArray) -> bool:
    """Whether no other reading has the same steps from another day."""
    first = int(np.argmax(~np.isnan(chosen)))
    others = (times for times in valid.values() if times[first] != chosen[first])
    return not any(np.array_equal(times - times[first], chosen - chosen[first], equal_nan=True) for times in others)


def _readings(parts: Parts, filled: Bools) -> dict[str, FloatArray]:
    """Days from 1970-01-01 for each order that the lengths of the parts allow; NaN where impossible."""
    first, last = (count[filled] for count in parts.digits)
    if (first >= 3).any():
        orders = ["year first"]
    elif parts.month_named:
        orders = ["day first", "year first"] if (last < 3).all() else ["day first"]
    elif (last >= 3).any():
        orders = ["day first", "month first"]
    else:
        orders = ["day first", "month first", "year first"]
    if any(side.any() and not side.all() for side in (first >= 3, last >= 3)):
        orders = []  # some years of two digits, some of four
    return {order: parts.days(order) for order in orders} or {"": np.full(len(filled), np.nan)}


def _sorted(times: FloatArray) -> bool:
    finite = times[~np.isnan(times)]
    return bool((np.diff(finite) >= 0).all())


def _longest_step(times: FloatArray) -> float:
    return float(np.max(np.abs(np.diff(times[~np.isnan(times)])), initial=0.0))


def _distinct(readings: dict[str, FloatArray]) -> dict[str, FloatArray]:
    """Keep readings that differ in the time elapsed since the first row."""
    kept: dict[str, FloatArray] = {}
    for order, times in readings.items():
        elapsed = times - times[~np.isnan(times)][0]
        if not any(np.array_equal(elapsed, other, equal_nan=True) for other in kept.values()):
            kept[order] = elapsed
    return {order: readings[order] for order in kept}


def _no_date(table: Table, name: str, cells: pl.Series, row: int) -> TimeError:
    return TimeError.expected(
        f"times in column {name!r} (seconds, or dates such as 2017-01-21 15:20:00, all alike)",
        f"{cells[row]!r} in {table.where(row)}",
        "repair the cell, or pass dt=<seconds> and time=False to ignore the column",
    )


def looks_like_a_time(cell: str) -> bool:
    """Tell a date or a time of day from a word.

    Examples
    --------
    >>> looks_like_a_time("17/01/17 9:00"), looks_like_a_time("10:00:05"), looks_like_a_time("FIC 101")
    (True, True, False)
    """
    found = re.match(DATE, cell)
    return found is not None and (found["a"] is not None or found["hour"] is not None)


def looks_numeric(cell: str) -> bool:
    """Tell a plain number, with either decimal mark, from a date.

    Examples
    --------
    >>> looks_numeric("12,5"), looks_numeric("17/01/17 9:00")
    (True, False)
    """
    return re.fullmatch(r"[+-]?(\d+[.,]?\d*|[.,]\d+)([eE][+-]?\d+)?", cell) is not None
