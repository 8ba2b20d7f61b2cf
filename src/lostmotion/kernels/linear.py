"""Linear part: stability of A, and the filter B/A with delay."""

from __future__ import annotations

import numpy as np
from numba import njit

from lostmotion.kernels.types import FloatArray


@njit(cache=True)
def is_stable(a: FloatArray, radius: float) -> bool:
    """Whether all roots of z^n + a[0] z^(n-1) + .. + a[n-1] lie inside `radius` (step-down recursion)."""
    n = a.size
    poly = a.copy()
    scale = 1.0
    for i in range(n):
        scale *= radius
        poly[i] /= scale
    for order in range(n, 0, -1):
        reflection = poly[order - 1]
        if not abs(reflection) < 1.0:
            return False
        rest = 1.0 - reflection * reflection
        half = (order - 1) // 2
        for i in range(half):
            j = order - 2 - i
            upper = (poly[i] - reflection * poly[j]) / rest
            poly[j] = (poly[j] - reflection * poly[i]) / rest
            poly[i] = upper
        if order % 2 == 0:
            poly[half] = (poly[half] - reflection * poly[half]) / rest
    return True


@njit(cache=True)
def simulate(a: FloatArray, b: FloatArray, delay: int, x: FloatArray) -> FloatArray:
    """Output of q^-delay B/A from rest, for inputs x (n,)."""
    y = np.empty(x.size)
    for k in range(x.size):
        value = 0.0
        for i in range(b.size):
            j = k - delay - i
            if j >= 0:
                value += b[i] * x[j]
        for i in range(a.size):
            j = k - 1 - i
            if j >= 0:
                value -= a[i] * y[j]
        y[k] = value
    return y
