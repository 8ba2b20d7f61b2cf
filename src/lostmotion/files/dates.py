"""Dates written as text -> seconds; whether day or month comes first is decided by the column, or refused."""

from __future__ import annotations

import re

import numpy as np
import polars as pl

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.errors import TimeError
from lostmotion.files.table import Table
from lostmotion.records.sampling import Bools

# A reading of the dates whose longest step is this many times another's is wrong: its days became months.
LONGEST_STEP = 20.0
_MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")
_DATE = (
    r"^(?:(?P<a>[0-9]{1,4})[-/. ](?P<b>[0-9]{1,2}|[A-Za-z]{3,9})[-/. ](?P<c>[0-9]{1,4})[T ,]*)?"
    r"(?:(?P<hour>[0-9]{1,2}):(?P<minute>[0-9]{2})(?::(?P<second>[0-9]{2})(?:[.,](?P<fraction>[0-9]{1,9}))?)?)?"
    r"[ \t]*(?P<half>[AaPp])?(?:\.?[Mm]\.?)?[ \t]*(?P<zone>Z|UTC|[+-][0-9]{2}:?[0-9]{2})?$"
)
_ORDERS = {"day first": "dmy", "month first": "mdy", "year first": "ymd"}


class AmbiguousDatesError(TimeError):
    """Day and month cannot be told apart, and it matters."""


def parse_dates(table: Table, name: str, cells: pl.Series) -> tuple[FloatArray, tuple[str, ...]]:
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
    parts = cells.str.extract_groups(_DATE).struct.unnest()
    filled = cells.is_not_null().to_numpy()
    dated = parts["a"].is_not_null().to_numpy()
    timed = parts["hour"].is_not_null().to_numpy()
    strange = filled & ~(dated | timed) | (filled & (dated != dated[filled][0]) if filled.any() else filled)
    if strange.any():
        raise _no_date(table, name, cells, int(np.flatnonzero(strange)[0]))
    seconds = np.where(filled, _time_of_day(parts), np.nan)
    if not dated.any():
        return seconds, ()
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
    seconds, _ = parse_dates(table, name, cells)
    known = ~np.isnan(seconds)
    parts = cells.str.extract_groups(_DATE).struct.unnest()
    if not parts["a"].is_not_null().any():
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
    parts = cells.drop_nulls().str.extract_groups(_DATE).struct.unnest()
    date, time = parts["a"].is_not_null(), parts["hour"].is_not_null()
    return len(parts) > 0 and bool((date & ~time).all() if dated else (time & ~date).all())


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
    parts = cells.str.extract_groups(_DATE).struct.unnest()
    timed = parts["hour"].is_not_null().to_numpy()
    dated = parts["a"].is_not_null().to_numpy()
    seconds = _time_of_day(parts)
    if not order:
        return np.where(timed & ~dated, seconds, np.nan)
    columns = {"a": _ints(parts["a"]), "b": _month_numbers(parts["b"]), "c": _ints(parts["c"])}
    place = {part: columns[side] for side, part in zip("abc", _ORDERS[order], strict=True)}
    return np.where(dated, days_from_date(place["y"], place["m"], place["d"]) * 86400.0 + seconds, np.nan)


def states_zone(cells: pl.Series) -> bool:
    """Tell dates that carry a time zone; they are then seconds of UTC."""
    return bool(cells.str.extract_groups(_DATE).struct.field("zone").is_not_null().any())


def _choose(
    table: Table, name: str, cells: pl.Series, days: dict[str, FloatArray], seconds: FloatArray
) -> tuple[FloatArray, tuple[str, ...]]:
    filled = ~np.isnan(seconds)
    valid = {order: day * 86400.0 + seconds for order, day in days.items() if not np.isnan(day[filled]).any()}
    if not valid:
        wrong = np.sum([np.isnan(day) & filled for day in days.values()], axis=0)
        raise _no_date(table, name, cells, int(np.argmax(wrong)))
    left = _distinct({order: time for order, time in valid.items() if _sorted(time) or _sorted(-time)} or valid)
    limit = LONGEST_STEP * min(_longest_step(time) for time in left.values())
    left = {order: time for order, time in left.items() if _longest_step(time) <= limit}
    if len(left) > 1:
        raise AmbiguousDatesError.expected(
            f"dates with one reading in column {name!r}",
            f"{cells.drop_nulls()[0]!r} to {cells.drop_nulls()[-1]!r}, {' or '.join(left)}",
            "give dt=<seconds>, or export ISO dates (2017-01-21 15:20:00)",
        )
    order, chosen = next(iter(left.items()))
    if len(_distinct(valid)) == 1:
        return chosen, ()
    return chosen, (f"Dates in {name!r} were read {order}, the reading whose times follow each other.",)


def _readings(parts: pl.DataFrame, filled: Bools) -> dict[str, FloatArray]:
    """Days from 1970-01-01 for each order that the lengths of the parts allow; NaN where impossible."""
    first, last = (parts[side].str.len_chars().fill_null(0).to_numpy()[filled] for side in "ac")
    month_named = parts["b"].str.contains("[A-Za-z]").fill_null(value=False).any()
    if (first >= 3).any():
        orders = ["year first"]
    elif month_named:
        orders = ["day first", "year first"] if (last < 3).all() else ["day first"]
    elif (last >= 3).any():
        orders = ["day first", "month first"]
    else:
        orders = ["day first", "month first", "year first"]
    if any(side.any() and not side.all() for side in (first >= 3, last >= 3)):
        orders = []  # some years of two digits, some of four
    columns = {"a": _ints(parts["a"]), "b": _month_numbers(parts["b"]), "c": _ints(parts["c"])}
    found = {}
    for order in orders:
        place = {part: columns[side] for side, part in zip("abc", _ORDERS[order], strict=True)}
        found[order] = days_from_date(place["y"], place["m"], place["d"])
    return found or {"": np.full(len(filled), np.nan)}


def days_from_date(year: IntArray, month: IntArray, day: IntArray) -> FloatArray:
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
    half = parts["half"].str.to_lowercase().to_numpy()
    hour = np.where(half == "p", hour % 12 + 12, np.where(half == "a", hour % 12, hour))
    fraction = ("0." + parts["fraction"].fill_null("0")).cast(pl.Float64).to_numpy()
    seconds = hour * 3600.0 + _ints(parts["minute"], 0) * 60.0 + _ints(parts["second"], 0) + fraction
    return np.asarray(seconds - _zone_seconds(parts["zone"]), dtype=np.float64)


def _zone_seconds(zone: pl.Series) -> FloatArray:
    digits = zone.str.replace(":", "", literal=True)
    sign = np.where(digits.str.starts_with("-").fill_null(value=False).to_numpy(), -1.0, 1.0)
    return sign * (_ints(digits.str.slice(1, 2), 0) * 3600.0 + _ints(digits.str.slice(3, 2), 0) * 60.0)


def _ints(column: pl.Series, default: int = -1) -> IntArray:
    return np.asarray(column.cast(pl.Int64, strict=False).fill_null(default).to_numpy(), dtype=np.int64)


def _month_numbers(column: pl.Series) -> IntArray:
    short = column.str.to_lowercase().str.slice(0, 3)
    numbers = {name: str(place + 1) for place, name in enumerate(_MONTHS)}
    named = short.str.contains("[a-z]").fill_null(value=False)
    return _ints(short.replace_strict(numbers, default=None).zip_with(named, column))


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
    found = re.match(_DATE, cell)
    return found is not None and (found["a"] is not None or found["hour"] is not None)


def looks_numeric(cell: str) -> bool:
    """Tell a plain number, with either decimal mark, from a date.

    Examples
    --------
    >>> looks_numeric("12,5"), looks_numeric("17/01/17 9:00")
    (True, False)
    """
    return re.fullmatch(r"[+-]?(\d+[.,]?\d*|[.,]\d+)([eE][+-]?\d+)?", cell) is not None
