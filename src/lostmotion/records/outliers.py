"""Wild samples of PV: single rows that jump away from their neighbours and come back (Hampel's filter)."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.records import limits
from lostmotion.records.sampling import Bools, runs

MAD = 1.4826  # deviation of a normal variable per median absolute deviation
AT_ONCE = 8192  # rows


def wild(values: FloatArray) -> Bools:
    """Rows that lie far from the median of their neighbours, at most two in a row, with agreement around them.

    The distance is measured in the larger of two robust deviations: that of all distances in the record and
    that of the neighbours from their own median. Steps have no agreement around them and stay.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Samples; NaN where missing.

    Returns
    -------
    ndarray of bool, shape (n,)

    Notes
    -----
    Hampel, *The influence curve and its role in robust estimation*, J. Amer. Stat. Assoc. 69 (1974) 383.

    Examples
    --------
    >>> pv = np.random.default_rng(0).normal(size=300)
    >>> pv[150:] += 50.0
    >>> pv[[40, 200, 201]] += 30.0
    >>> np.flatnonzero(wild(pv)).tolist()
    [40, 200, 201]
    """
    n, reach = len(values), limits.OUTLIER_WINDOW
    rows = np.zeros(n, dtype=np.bool_)
    if n <= 2 * reach or np.isnan(values).all():
        return rows
    middle, local = np.empty(n), np.empty(n)
    window = np.lib.stride_tricks.sliding_window_view(np.pad(values, reach, mode="reflect"), 2 * reach + 1)
    for begin in range(0, n, AT_ONCE):  # the neighbours of all rows would be the largest table of a whole diagnosis
        part = slice(begin, begin + AT_ONCE)
        around = np.delete(window[part], reach, axis=1)
        with np.errstate(all="ignore"):
            middle[part] = _median(around)
            local[part] = MAD * _median(np.abs(around - middle[part, None]))
    distance = np.abs(values - middle)
    typical = MAD * float(np.nanmedian(distance[distance > 0])) if np.any(distance > 0) else 0.0
    if typical == 0.0:
        return rows
    far = distance > limits.OUTLIER_SIZE * np.maximum(local, typical)
    for start, length in zip(*runs(far), strict=True):
        if length <= limits.OUTLIER_ROWS and _comes_back(values, distance, int(start), int(start + length)):
            rows[start : start + length] = True
    return rows


def _comes_back(values: FloatArray, distance: FloatArray, start: int, stop: int) -> bool:
    """Whether the samples before and after agree, against the size of the jump between them."""
    if start == 0 or stop == len(values):
        return False  # one side is missing: a step at the very end looks the same
    between = abs(float(values[stop]) - float(values[start - 1]))
    return not between > 0.25 * float(distance[start:stop].min())


def _median(windows: FloatArray) -> FloatArray:
    """Median of each row, of an even number of samples; missing ones are left out."""
    if np.isnan(windows).any():
        filled = np.where(np.isnan(windows).all(axis=1, keepdims=True), 0.0, windows)
        return np.asarray(np.nanmedian(filled, axis=1))
    half = windows.shape[1] // 2  # sorting so few takes less time than np.median
    return np.asarray(np.sort(windows, axis=1)[:, half - 1 : half + 1].mean(axis=1))
