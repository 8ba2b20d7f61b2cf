"""Sums of products of lagged signals, and the damped step of a least-squares problem."""

from __future__ import annotations

import numpy as np
from numba import njit

from lostmotion.kernels.types import FloatArray


@njit(cache=True)
def add_products(
    first: FloatArray,
    ahead: int,
    rows: int,
    second: FloatArray,
    behind: int,
    columns: int,
    start: int,
    stop: int,
    out: FloatArray,
) -> None:
    """Add the sums over k in [start, stop) of first(k-ahead-i) second(k-behind-j) to `out` (rows, columns).

    Only the first row and column are summed up: moving both lags by one drops the last product and adds one in front.
    """
    gram = np.empty((rows, columns))
    head = first[start - ahead : stop - ahead]
    for j in range(columns):
        gram[0, j] = np.dot(head, second[start - behind - j : stop - behind - j])
    head = second[start - behind : stop - behind]
    for i in range(1, rows):
        gram[i, 0] = np.dot(first[start - ahead - i : stop - ahead - i], head)
    for i in range(1, rows):
        before, after = first[start - ahead - i], first[stop - ahead - i]
        for j in range(1, columns):
            gram[i, j] = gram[i - 1, j - 1] + before * second[start - behind - j] - after * second[stop - behind - j]
    out += gram


@njit(cache=True)
def explained(table: FloatArray, basis: FloatArray, known: FloatArray, floor: float, ridge: float) -> float:
    """Sum of squares that m columns explain beyond k columns that are always there.

    `table` (k + m + 1, m) holds the products of those k, of the m and of the target with the m columns; `basis`
    (k, r) makes the k orthonormal and `known` (r,) are their products with the target.
    """
    k, m = basis.shape[0], table.shape[1]
    past = np.dot(basis.T.copy(), table[:k])
    gram = table[k : k + m] - np.dot(past.T.copy(), past)
    cross = table[k + m] - np.dot(known, past)
    for i in range(m):
        gram[i, i] += ridge * gram[i, i] + floor
    return float(np.dot(cross, np.linalg.solve(gram, cross)))


@njit(cache=True)
def damped_step(hessian: FloatArray, gradient: FloatArray, damping: float) -> tuple[FloatArray, float]:
    """Marquardt step with columns scaled by their norm, and the decrease of the sum of squares that it promises."""
    n = gradient.size
    scale = np.ones(n)
    for i in range(n):
        if hessian[i, i] > 0.0:
            scale[i] = np.sqrt(hessian[i, i])
    scaled = np.empty((n, n))
    for i in range(n):
        for j in range(n):
            scaled[i, j] = hessian[i, j] / (scale[i] * scale[j])
        scaled[i, i] += damping
    slope = gradient / scale
    move = -np.linalg.solve(scaled, slope)
    # with (H + damping) move = -slope: move' H move = -slope' move - damping move' move
    promised = -np.dot(slope, move) + damping * np.dot(move, move)
    return move / scale, promised
