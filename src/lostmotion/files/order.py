"""Rows in any order -> rows in the order of time, each once: what is obvious is repaired and told."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.files.times import DAY, Stamps

HOUR = 3600.0  # s
LAST_HOUR = 4  # clocks are set back at night: in the hours 0 to 3 of a Sunday
SUNDAY = 3  # days after 1970-01-01, a Thursday
MIXED = 3  # times that rows of one block may change places with those of another, per step back


@dataclass(frozen=True, eq=False)
class Arranged:
    """Rows in the order of time.

    Attributes
    ----------
    rows : ndarray of int, shape (n,)
        Row of the table (from 0) of each.
    seconds : ndarray, shape (n,)
        Their times; NaN where the cell is empty.
    notes : tuple of str
        What was done.
    set_back : bool
        The clock was set back on the way: from there on the times are no longer what it showed.
    """

    rows: IntArray
    seconds: FloatArray
    notes: tuple[str, ...] = ()
    set_back: bool = False

    def picked(self, places: IntArray, note: str) -> Arranged:
        """Some of the rows, in another order."""
        return replace(self, rows=self.rows[places], seconds=self.seconds[places], notes=(*self.notes, note))


def by_time(stamps: Stamps) -> Arranged:
    """Rows whose order in the source means nothing, by their times."""
    rows = np.argsort(stamps.seconds, kind="stable")
    return Arranged(rows, stamps.seconds[rows])


def arranged(stamps: Stamps, values: Sequence[FloatArray]) -> Arranged:
    """Put rows into the order of time and leave out those that stand twice.

    Newest first is turned round, times of day go on after midnight, an hour that a clock was set back is put behind
    the one before, a few rows in disorder and the blocks of several exports are sorted. Rows that cannot be told to
    be one record stay as they are, for :func:`lostmotion.files.clock.find_clock` to refuse.

    Parameters
    ----------
    stamps : Stamps
        Times of the rows.
    values : sequence of ndarray, shape (n,)
        Signals: rows of one time are the same only if these are.

    Examples
    --------
    >>> import narwhals.stable.v2 as nw
    >>> import polars as pl
    >>> from lostmotion.files.table import Table
    >>> from lostmotion.files.times import read_times
    >>> frame = pl.DataFrame({"t_s": [4.0, 2.0, 2.0, 0.0]})
    >>> stamps = read_times(Table(nw.from_native(frame, eager_only=True), "a"), "t_s")
    >>> found = arranged(stamps, [np.array([3.0, 2.0, 2.0, 1.0])])
    >>> found.rows, found.notes[1]
    (array([3, 2, 0]), '1 row stood twice, with the same values, and was left out.')
    """
    found = Arranged(np.arange(len(stamps.seconds)), stamps.seconds)
    steps = np.diff(stamps.seconds)
    if np.isnan(stamps.seconds).any() or (steps > 0).all() or not steps.any():
        return found
    if np.sum(steps < 0) > np.sum(steps > 0):
        found = found.picked(found.rows[::-1], f"Rows stood newest first in {stamps.name!r} and were turned round.")
    if stamps.dates is not None and 0 <= stamps.origin < DAY:  # no dates in it
        found = _after_midnight(stamps, found)
    keys = np.column_stack([np.nan_to_num(signal, nan=np.inf) for signal in values])
    found = _wintered(stamps, found, keys)
    sorted_ = _sorted(stamps, found, keys)
    return found if sorted_ is None else sorted_


def _after_midnight(stamps: Stamps, found: Arranged) -> Arranged:
    """Times of day that begin anew."""
    back = np.diff(found.seconds, prepend=found.seconds[:1]) < -0.5 * DAY
    if not back.any():
        return found
    note = f"Times of day in {stamps.name!r} begin anew {int(back.sum())} times, each a day later."
    return Arranged(found.rows, np.asarray(found.seconds + DAY * np.cumsum(back)), (*found.notes, note))


def _wintered(stamps: Stamps, found: Arranged, keys: FloatArray) -> Arranged:
    """Move what follows an hour that stands twice, with other values, by that hour."""
    steps = np.diff(found.seconds)
    if not stamps.local or not (steps < 0).any():
        return found
    usual = float(np.median(steps[steps > 0]))
    for row in (np.flatnonzero(steps < 0) + 1).tolist():
        seconds = found.seconds
        forth = seconds[row] - seconds[row - 1] + HOUR
        clock = (stamps.origin + seconds[row]) % DAY
        sunday = (stamps.origin + seconds[row]) // DAY % 7 == SUNDAY
        if not (0 < forth <= 1.5 * usual and clock < LAST_HOUR * HOUR and sunday) or _repeats(found, keys, row):
            continue
        moved = np.where(np.arange(len(seconds)) >= row, seconds + HOUR, seconds)
        note = (
            f"The clock of {stamps.name!r} was set back an hour at {stamps.at(int(found.rows[row]))}; the rows go on."
        )
        found = Arranged(found.rows, moved, (*found.notes, note), set_back=True)
    return found


def _repeats(found: Arranged, keys: FloatArray, row: int) -> bool:
    """Whether the rows from `row` on are the same as earlier ones of the same times: an overlap."""
    again = int(np.searchsorted(found.seconds[:row], found.seconds[row]))
    length = min(row - again, len(found.seconds) - row)
    before, after = found.rows[again : again + length], found.rows[row : row + length]
    return length > 0 and bool((keys[before] == keys[after]).all())


def _sorted(stamps: Stamps, found: Arranged, keys: FloatArray) -> Arranged | None:
    """In order, and without rows that stand twice; None where these are not what is wrong."""
    backs = int(np.sum(np.diff(found.seconds) < 0))
    order = np.argsort(found.seconds, kind="stable")
    seconds = found.seconds[order]
    twice = _twice(seconds, keys[found.rows[order]])
    order = order[~twice]
    if (np.diff(seconds[~twice]) == 0).any():  # stamps too coarse, or two values of one time
        return None
    block = np.cumsum(np.diff(found.seconds, prepend=found.seconds[:1]) < 0)[order]
    if np.sum(np.diff(block) != 0) > MIXED * backs:  # recordings of one clock, one into the other
        return None
    if twice.any():
        count = int(twice.sum())
        rows, were = ("row", "was") if count == 1 else ("rows", "were")
        note = f"{count} {rows} stood twice, with the same values, and {were} left out."
        found = replace(found, notes=(*found.notes, note))
    if not backs:
        return replace(found, rows=found.rows[order], seconds=found.seconds[order])
    places = f"{backs} place{'s' if backs > 1 else ''}"
    return found.picked(order, f"Rows were out of order in {places} and were sorted by {stamps.name!r}.")


def _twice(seconds: FloatArray, keys: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Rows, in the order of time, that repeat one of the same time before them."""
    same = np.diff(seconds) == 0
    shared = np.flatnonzero(np.r_[False, same] | np.r_[same, False])
    twice = np.zeros(len(seconds), dtype=np.bool_)
    if shared.size:
        first = np.unique(np.column_stack([seconds[shared], keys[shared]]), axis=0, return_index=True)[1]
        twice[np.delete(shared, first)] = True
    return twice
