"""Signals seen through the zero of the noise: F(q) = (1 - c) / (1 - c q^-1), gain 1 at rest.

Noise with D(q) v = (1 - c q^-1) e is autoregressive once PV and everything that acts on it have gone through F. Each
segment begins as if its first value had always been there.
"""

from __future__ import annotations

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
    """The signal of one stretch before F; the first value, behind which lies what was before, is that of the next."""
    found = x.copy()
    if zero == 0.0:
        return found
    for k in range(1, x.size):
        found[k] = (x[k] - zero * x[k - 1]) / (1.0 - zero)
    if x.size > 1:
        found[0] = found[1]
    return found
