"""Straight lines through a signal, as a swinging door finds them."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Sequence
from functools import cache

import numpy as np

from lostmotion.arrays import FloatArray, IntArray

PLAIN_ROWS = 50_000  # plain Python is done with these before Numba is imported


def knots(values: FloatArray, tolerance: float) -> IntArray:
    """Rows at which one line ends and the next begins, greedily, first and last row included.

    A line starts at a sample and goes on while some slope passes all its samples within `tolerance`. NaN ends a line.
    The same function runs compiled or, on a short signal in a process without Numba, as it stands.
    """
    if values.size > PLAIN_ROWS or "numba" in sys.modules:
        return _compiled()(values, tolerance)
    return _knots(values.tolist(), tolerance)


@cache
def _compiled() -> Callable[[FloatArray, float], IntArray]:
    from lostmotion.kernels.numba_cache import njit  # noqa: PLC0415  a check of one record must not wait for Numba

    run: Callable[[FloatArray, float], IntArray] = njit()(_knots)
    return run


def _knots(values: FloatArray | Sequence[float], tolerance: float) -> IntArray:
    n = len(values)
    found = np.empty(n, dtype=np.int64)
    count, start, k = 1, 0, 1
    found[0] = 0
    low, high = -math.inf, math.inf
    while k < n:
        low = max(low, (values[k] - tolerance - values[start]) / (k - start))
        high = min(high, (values[k] + tolerance - values[start]) / (k - start))
        if low <= high and not (math.isnan(values[k]) or math.isnan(values[start])):
            k += 1
            continue
        start = k - 1 if k - 1 > start else k  # two samples always make a line, unless one is missing
        found[count] = start
        count += 1
        low, high = -math.inf, math.inf
        k = start + 1
    if found[count - 1] != n - 1:
        found[count] = n - 1
        count += 1
    return found[:count]
