"""Turns and travel of a signal in one pass, pieces between missing samples apart."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.kernels.numba_cache import njit


@njit(nogil=True)
def turns(values: FloatArray, band: float) -> tuple[int, float]:
    """How often a signal turned round by at least `band` and more than nothing, and the sum of its moves.

    A piece begins behind every NaN. In each the first move of `band` gives the direction.
    """
    count, path = 0, 0.0
    direction, low, high, extreme, last = 0, np.nan, np.nan, np.nan, np.nan
    for value in values:
        if np.isnan(value):
            direction, low, high, last = 0, np.nan, np.nan, np.nan
            continue
        if np.isnan(last):
            low, high, last = value, value, value
        path += abs(value - last)
        last = value
        if direction == 0:
            low, high = min(low, value), max(high, value)
            if high > low and high - low >= band:
                direction = 1 if value == high else -1
                extreme = value
        elif direction * (value - extreme) >= 0.0:
            extreme = value
        elif abs(value - extreme) >= band:
            count += 1
            direction = -direction
            extreme = value
    return count, path
