"""Straight lines through a signal, as a swinging door finds them."""

from __future__ import annotations

import numpy as np
from numba import njit

from lostmotion.arrays import FloatArray, IntArray


@njit(cache=True)
def knots(values: FloatArray, tolerance: float) -> IntArray:
    """Rows at which one line ends and the next begins, greedily, first and last row included.

    A line starts at a sample and goes on while some slope passes all its samples within `tolerance`. NaN ends a line.
    """
    n = values.size
    found = np.empty(n, dtype=np.int64)
    count, start, k = 1, 0, 1
    found[0] = 0
    low, high = -np.inf, np.inf
    while k < n:
        low = max(low, (values[k] - tolerance - values[start]) / (k - start))
        high = min(high, (values[k] + tolerance - values[start]) / (k - start))
        if low <= high and not (np.isnan(values[k]) or np.isnan(values[start])):
            k += 1
            continue
        start = k - 1 if k - 1 > start else k  # two samples always make a line, unless one is missing
        found[count] = start
        count += 1
        low, high = -np.inf, np.inf
        k = start + 1
    if found[count - 1] != n - 1:
        found[count] = n - 1
        count += 1
    return found[:count]
