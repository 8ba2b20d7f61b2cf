"""Signals seen through the zero of the noise: F(q) = (1 - c) / (1 - c q^-1), gain 1 at rest.

Noise with D(q) v = (1 - c q^-1) e is autoregressive once PV and everything that acts on it have gone through F. Each
segment begins as if its first value had always been there.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from lostmotion.arrays import FloatArray, IntArray


@njit(cache=True, nogil=True)
def smooth(x: FloatArray, zero: float, segments: IntArray, out: FloatArray) -> None:
    """Fill `out` (n,) on the segments; it may be `x` itself."""
    share = 1.0 - zero
    for start, stop in segments:
        value = x[start]
        for k in range(start, stop):
            value += share * (x[k] - value)
            out[k] = value


@njit(cache=True, nogil=True)
def roughen(x: FloatArray, zero: float) -> FloatArray:
    """The signal of one stretch before F, whose first value is kept."""
    found = np.empty(x.size)
    last = x[0] if x.size else 0.0
    for k in range(x.size):
        found[k] = (x[k] - zero * last) / (1.0 - zero)
        last = x[k]
    return found
