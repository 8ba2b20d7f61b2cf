"""Linear part: stability of A, and the filter B/A with delay."""

from __future__ import annotations

import numpy as np
from numba import njit

from lostmotion.kernels.types import FloatArray


@njit(cache=True, nogil=True, error_model="numpy")
def inside_circle(poly: FloatArray, first: int, n: int) -> bool:
    """Whether all roots of z^n + poly[first] z^(n-1) + .. lie inside the unit circle (step-down, in place)."""
    last = first + n - 1
    for order in range(n, 0, -1):
        reflection = poly[last]
        if not abs(reflection) < 1.0:
            return False
        inverse = 1.0 / (1.0 - reflection * reflection)
        half = (order - 1) // 2
        for i in range(first, first + half):
            j = first + last - 1 - i
            upper = (poly[i] - reflection * poly[j]) * inverse
            poly[j] = (poly[j] - reflection * poly[i]) * inverse
            poly[i] = upper
        if order % 2 == 0:
            poly[first + half] = (poly[first + half] - reflection * poly[first + half]) * inverse
        last -= 1
    return True


@njit(cache=True, nogil=True)
def three_inside_circle(a1: float, a2: float, a3: float) -> bool:
    """Whether all roots of z^3 + a1 z^2 + a2 z + a3 lie inside the unit circle (Jury's criterion)."""
    return abs(a3) < 1.0 and abs(a1 + a3) < 1.0 + a2 and abs(a2 - a1 * a3) < 1.0 - a3 * a3


@njit(cache=True)
def is_stable(a: FloatArray, radius: float) -> bool:
    """Whether all roots of z^n + a[0] z^(n-1) + .. + a[n-1] lie inside `radius`."""
    poly = a.copy()
    scale = 1.0
    for i in range(a.size):
        scale *= radius
        poly[i] /= scale
    return inside_circle(poly, 0, poly.size)


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


@njit(cache=True)
def step_extremes(a: FloatArray, b: FloatArray, n: int) -> tuple[float, float, float]:
    """Response of B/A to a step after n samples, and its smallest and largest value until then."""
    y = simulate(a, b, 0, np.ones(n))
    return y[n - 1], y.min(), y.max()
