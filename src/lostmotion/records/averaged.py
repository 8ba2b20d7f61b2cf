"""Steps of a set point that pass through an odd value between: the rows are means over several scans."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.records.limits import AT_REST, FEWEST_THROUGH, FINE_STEP, THROUGH_SHARE

UNITS = (10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01)  # in which set points are typed
ON_UNIT = 0.05  # of a unit: nearer than this is a multiple of it, rounded


@dataclass(frozen=True)
class Steps:
    """Steps of a set point from one rest to another.

    Parameters
    ----------
    count : int
        All of them, ramps included.
    through : int
        Those with one row between, of a value that nobody typed.
    """

    count: int
    through: int

    @property
    def averaged(self) -> bool:
        """Whether so many pass through a value between that the rows cannot be samples."""
        return self.through >= max(FEWEST_THROUGH, THROUGH_SHARE * self.count)


def steps_of(sp: FloatArray | None) -> Steps:
    """Count the steps of a set point that is typed, and those of them that a mean shows between.

    Parameters
    ----------
    sp : ndarray, shape (n,), or None
        Samples; those missing are passed over.

    Notes
    -----
    A value between is one row, and no multiple of the round unit of which all values at rest are multiples: two moves
    by hand, one after another, are. Without such a unit nothing is counted. Means over k scans show a step between
    two scans of one row, (k - 1) of k.

    Examples
    --------
    >>> scans = np.repeat([50.0, 52.0, 47.0, 51.0, 50.0, 53.0], 50)
    >>> means = np.r_[scans[3:], 53.0, 53.0, 53.0].reshape(-1, 4).mean(axis=1)
    >>> steps_of(scans[2::4]), steps_of(means)
    (Steps(count=5, through=0), Steps(count=5, through=4))
    """
    known = np.zeros(0) if sp is None else sp[~np.isnan(sp)]
    if known.size < 2 or np.ptp(known) == 0.0:
        return Steps(0, 0)
    starts = np.r_[0, np.flatnonzero(np.abs(np.diff(known)) > FINE_STEP * np.ptp(known)) + 1]
    level, length = known[starts], np.diff(starts, append=known.size)
    rests = np.flatnonzero(length >= AT_REST)
    before, after = rests[:-1], rests[1:]
    moved = level[after] != level[before]
    middle = before[moved & (after == before + 2)] + 1
    unit = next((one for one in UNITS if not _odd(level[rests], one).any()), None)
    if unit is None:
        return Steps(int(moved.sum()), 0)
    between = (level[middle] - level[middle - 1]) * (level[middle + 1] - level[middle]) > 0
    return Steps(int(moved.sum()), int(np.sum(between & (length[middle] == 1) & _odd(level[middle], unit))))


def _odd(values: FloatArray, unit: float) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Which values are no multiples of a unit."""
    return np.abs(values / unit - np.round(values / unit)) > ON_UNIT
