"""What a historian keeps of a signal: rounded, compressed, stale, with rows missing."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray

Bools = npt.NDArray[np.bool_]
DATA = ("compressed", "coarse", "stale", "gaps")
ILL = 0.2  # of the loops have one of these
FINE, COARSE = 1e-4, (0.002, 0.01)  # resolution, share of span
EXCEPTION = (0.001, 0.006)  # dead band of exception reports, share of span
STALE = (0.05, 0.4)  # of the time
MISSING = (0.01, 0.1)


def resolution(random: np.random.Generator, how: str) -> float:
    """Smallest step that is stored, share of span."""
    return float(random.uniform(*COARSE)) if how == "coarse" else FINE


def rounded(values: FloatArray, step: float) -> FloatArray:
    """To whole multiples of a step.

    Examples
    --------
    >>> rounded(np.array([1.02, 2.49]), 0.5)
    array([1. , 2.5])
    """
    return np.asarray(np.round(values / step) * step)


def reported(values: FloatArray, dead_band: float) -> FloatArray:
    """Exception reports: a value is stored when it is further than the dead band from the last, and held.

    Examples
    --------
    >>> reported(np.array([0.0, 0.4, 0.8, 1.2, 1.0]), 0.5)
    array([0. , 0. , 0.8, 0.8, 0.8])
    """
    kept, last = np.empty_like(values), np.nan
    for k, value in enumerate(values.tolist()):
        if not abs(value - last) <= dead_band:
            last = value
        kept[k] = last
    return kept


def stretches(random: np.random.Generator, rows: int, share: float) -> Bools:
    """Rows of one to four stretches that make up a share of all, or less where they meet."""
    found = np.zeros(rows, dtype=np.bool_)
    pieces = int(random.integers(1, 5))
    length = max(int(share * rows / pieces), 1)
    for begin in random.integers(0, max(rows - length, 1), size=pieces).tolist():
        found[begin : begin + length] = True
    return found


def held(values: FloatArray, rows: Bools) -> FloatArray:
    """The last value before, where nothing comes any more.

    Examples
    --------
    >>> held(np.array([1.0, 2.0, 3.0, 4.0]), np.array([False, True, True, False]))
    array([1., 1., 1., 4.])
    """
    at = np.maximum.accumulate(np.where(rows, 0, np.arange(values.size)))
    return np.asarray(values[at])
