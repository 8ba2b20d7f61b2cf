"""Dead zone and its inverse, sample by sample and over arrays."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.kernels.numba_cache import njit


@njit()
def forward(u: float, left: float, right: float, left_slope: float, right_slope: float) -> float:
    """Internal variable x of one input u (paper, eq 4)."""
    if u > right:
        return right_slope * (u - right)
    if u < left:
        return left_slope * (u - left)
    return 0.0 * u  # keeps NaN


@njit()
def inverse(v: float, left: float, right: float, left_slope: float, right_slope: float, at_zero: float) -> float:
    """Input u that makes the dead zone give v (paper, eqs 8-11); `at_zero` is the answer to v = 0."""
    if v > 0.0:
        return v / right_slope + right
    if v < 0.0:
        return v / left_slope + left
    return at_zero + v  # keeps NaN


@njit()
def forward_run(u: FloatArray, left: float, right: float, left_slope: float, right_slope: float) -> FloatArray:
    """Internal variable over an array."""
    x = np.empty(u.size)
    for k in range(u.size):
        x[k] = forward(u[k], left, right, left_slope, right_slope)
    return x


@njit()
def inverse_run(
    v: FloatArray, left: float, right: float, left_slope: float, right_slope: float, at_zero: float
) -> FloatArray:
    """Inverse over an array."""
    u = np.empty(v.size)
    for k in range(v.size):
        u[k] = inverse(v[k], left, right, left_slope, right_slope, at_zero)
    return u


@njit()
def sensitivities(u: FloatArray, left: float, right: float, log_ratio: float, x: FloatArray, dx: FloatArray) -> None:
    """Internal variable with right slope 1, and its derivatives.

    `x` (n,) and `dx` (3, n) are filled; the rows of `dx` belong to left, right and the logarithm of the
    slope ratio left/right.
    """
    ratio = np.exp(log_ratio)
    by_left, by_right, by_ratio = dx[0], dx[1], dx[2]
    for k in range(u.size):  # choices of values, not of ways: so it goes several samples at once
        over = u[k] - right
        under = u[k] - left
        above = over > 0.0
        below = (under < 0.0) & (not above)
        part = ratio * under if below else 0.0
        x[k] = over if above else part
        by_left[k] = -ratio if below else 0.0
        by_right[k] = -1.0 if above else 0.0
        by_ratio[k] = part
