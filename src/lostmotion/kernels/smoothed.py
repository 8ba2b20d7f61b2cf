"""Signals seen through the zero of the noise: F(q) = (1 - c) / (1 - c q^-1), gain 1 at rest.

Noise with D(q) v = (1 - c q^-1) e is autoregressive once PV and everything that acts on it have gone through F. Each
segment begins as if its first value had always been there.
"""

from __future__ import annotations

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.numba_cache import njit


@njit(nogil=True, fastmath={"contract"})
def smooth(x: FloatArray, zero: float, segments: IntArray, out: FloatArray) -> None:
    """Fill `out` (n,) on the segments; it may be `x` itself."""
    share = 1.0 - zero
    for start, stop in segments:
        value = x[start]
        for k in range(start, stop):
            value += share * (x[k] - value)
            out[k] = value


@njit(nogil=True, fastmath={"contract"})
def smooth_rows(x: FloatArray, zero: float, segments: IntArray, out: FloatArray) -> None:
    """The same for every row of `x` (m, n): four at a time, as none waits for another."""
    share, whole = 1.0 - zero, x.shape[0] - x.shape[0] % 4
    for row in range(0, whole, 4):
        x0, x1, x2, x3 = x[row], x[row + 1], x[row + 2], x[row + 3]
        y0, y1, y2, y3 = out[row], out[row + 1], out[row + 2], out[row + 3]
        for start, stop in segments:
            v0, v1, v2, v3 = x0[start], x1[start], x2[start], x3[start]
            for k in range(start, stop):
                v0 += share * (x0[k] - v0)
                v1 += share * (x1[k] - v1)
                v2 += share * (x2[k] - v2)
                v3 += share * (x3[k] - v3)
                y0[k], y1[k], y2[k], y3[k] = v0, v1, v2, v3
    for row in range(whole, x.shape[0] - 1, 2):
        x0, x1, y0, y1 = x[row], x[row + 1], out[row], out[row + 1]
        for start, stop in segments:
            v0, v1 = x0[start], x1[start]
            for k in range(start, stop):
                v0 += share * (x0[k] - v0)
                v1 += share * (x1[k] - v1)
                y0[k], y1[k] = v0, v1
    if x.shape[0] % 2:
        smooth(x[-1], zero, segments, out[-1])


@njit(nogil=True)
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
