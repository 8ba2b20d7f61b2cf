"""Backlash (play operator) of full width w, its exact inverse, and its derivatives.

The position x follows the command u when the gap between them is used up and rests otherwise, so that
u - w/2 <= x <= u + w/2 always. It is written as a clamp of the old position: no sum of increments, no drift.
"""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.kernels.numba_cache import njit


@njit()
def step(u: float, width: float, x: float) -> float:
    """Position after the command u from position x; NaN in u leaves it, NaN in x stands for rest at u."""
    if np.isnan(u):
        return x
    if np.isnan(x):
        return u
    if x < u - 0.5 * width:
        return u - 0.5 * width
    if x > u + 0.5 * width:
        return u + 0.5 * width
    return x


@njit()
def run(u: FloatArray, width: float, start: float) -> FloatArray:
    """Position over an array.

    `start` is the position before the first sample; NaN stands for rest at the first finite u. NaN in u
    leaves the position and gives NaN.
    """
    x = np.empty(u.size)
    position = start
    for k in range(u.size):
        position = step(u[k], width, position)
        x[k] = np.nan if np.isnan(u[k]) else position
    return x


@njit()
def sensitivities(u: FloatArray, width: float, start: float, x: FloatArray, dx: FloatArray) -> None:
    """Position and its derivatives with respect to width and start; `x` (n,) and `dx` (2, n) are filled.

    Exact along the path for almost every width and start: x is continuous in both. The derivative with
    respect to start is 1 until the first sample at which u moves x, and 0 ever after; where the first sample
    already clamps the start, it is 0 from there on. With NaN as start (rest at the first u) it is 0.
    """
    position = start
    by_width = 0.0
    by_start = 0.0 if np.isnan(start) else 1.0
    for k in range(u.size):
        before = position
        position = step(u[k], width, before)
        if position > before:
            by_width = -0.5
            by_start = 0.0
        elif position < before:
            by_width = 0.5
            by_start = 0.0
        x[k] = np.nan if np.isnan(u[k]) else position
        dx[0, k] = by_width
        dx[1, k] = by_start


@njit()
def inverse_step(v: float, width: float, last: float, side: float) -> tuple[float, float, float]:
    """Command u for the wanted position v, then the new `last` and `side`.

    `last` is the wanted position before (NaN: none yet), `side` the sign of its last move (0: none yet).
    The command leads by half the width in the direction of motion and jumps by the width where v turns.
    """
    if np.isnan(v):
        return v, last, side
    if v > last:
        side = 1.0
    elif v < last:
        side = -1.0
    return v + 0.5 * side * width, v, side


@njit()
def inverse_run(v: FloatArray, width: float, side: float) -> FloatArray:
    """Command over an array of wanted positions; `side` is the sign of the last move before it, 0 for rest."""
    u = np.empty(v.size)
    last = np.nan
    for k in range(v.size):
        u[k], last, side = inverse_step(v[k], width, last, side)
    return u
