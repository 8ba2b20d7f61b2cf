"""Saturation between two limits, and its derivatives."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.kernels.numba_cache import njit


@njit()
def forward(u: float, low: float, high: float) -> float:
    """Internal variable x of one input u: u inside the limits, the limit outside; NaN stays NaN."""
    if u < low:
        return low
    if u > high:
        return high
    return u


@njit()
def run(u: FloatArray, low: float, high: float) -> FloatArray:
    """Internal variable over an array."""
    x = np.empty(u.size)
    for k in range(u.size):
        x[k] = forward(u[k], low, high)
    return x


@njit()
def sensitivities(u: FloatArray, low: float, high: float, x: FloatArray, dx: FloatArray) -> None:
    """Internal variable and its derivatives with respect to low and high; `x` (n,) and `dx` (2, n) are filled."""
    for k in range(u.size):
        x[k] = forward(u[k], low, high)
        dx[0, k] = 1.0 if u[k] < low else 0.0
        dx[1, k] = 1.0 if u[k] > high else 0.0
