"""Least squares for B at many given A, all delays at once: where to begin with a linear part.

With A fixed, A(q) z = B(q) x(k-d) is linear in B: z is a sum of lagged copies of X = (1/A) x. One Gram matrix of the
lags of X, filled by its shift structure, serves every delay and every order of B. The response to a constant input
(offset, or load of an integrating process) is fitted too; for every segment the decay of the slowest mode (its initial
state) is eliminated.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.likelihood import GONE, add_lagged, all_pole

RIDGE = 1e-12


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _product(first: FloatArray, second: FloatArray) -> float:
    """Sum of the products."""
    total = 0.0
    for k in range(first.size):
        total += first[k] * second[k]
    return total


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _add_segment(
    x: FloatArray,
    y: FloatArray,
    level: FloatArray,
    decay: float,
    first: int,
    low: int,
    lags: int,
    gram: FloatArray,
) -> None:
    """Add the Gram matrix of [X(k-low) .. X(k-low-lags+1), level, y] over rows k >= first, without the decaying mode.

    `gram` is (lags + 2, lags + 2).
    """
    n = y.size
    size = lags + 2
    part = np.zeros((size, size))
    with_decay = np.zeros(size)
    mode = np.zeros(n - first)  # the decay
    mode[0] = 1.0
    for k in range(1, mode.size):
        mode[k] = mode[k - 1] * decay
        if mode[k] < GONE:
            break
    steps, target, newest = level[first:], y[first:], x[first - low : n - low]  # slices: loops over them run in lanes
    with_decay[lags], with_decay[lags + 1] = _product(mode, steps), _product(mode, target)
    whole = _product(mode, mode)
    part[lags, lags] = _product(steps, steps)
    part[lags + 1, lags], part[lags + 1, lags + 1] = _product(steps, target), _product(target, target)
    for lag in range(lags):
        shifted = x[first - low - lag : n - low - lag]
        product, cross, sums, decayed = 0.0, 0.0, 0.0, 0.0
        for k in range(shifted.size):
            value = shifted[k]
            product += value * newest[k]
            cross += value * target[k]
            sums += value * steps[k]
            decayed += value * mode[k]
        part[lag, 0] = product
        part[lags + 1, lag] = cross
        part[lags, lag] = sums
        with_decay[lag] = decayed
    for column in range(1, lags):
        for row in range(column, lags):
            head = x[first - 1 - (low + row - 1)] * x[first - 1 - (low + column - 1)]
            tail = x[n - 1 - (low + row - 1)] * x[n - 1 - (low + column - 1)]
            part[row, column] = part[row - 1, column - 1] + head - tail
    for i in range(size):
        for j in range(i + 1):
            gram[i, j] += part[i, j] - with_decay[i] * with_decay[j] / whole


@njit(cache=True, nogil=True)
def _least_squares(gram: FloatArray, at: int, count: int, lags: int, b: FloatArray) -> float:
    """Residual sum of squares of y on X at lags at .. at + count - 1 and the level; fill b (count,)."""
    size = count + 1
    root = np.zeros((size, size))
    right = np.zeros(size)
    for i in range(size):
        row = at + i if i < count else lags
        right[i] = gram[lags + 1, row]
        for j in range(i + 1):
            total = gram[row, at + j if j < count else lags]
            if i == j:
                whole = total
                for k in range(j):
                    total -= root[i, k] * root[j, k]
                root[i, i] = np.sqrt(total) if total > RIDGE * whole else np.inf
            else:
                for k in range(j):
                    total -= root[i, k] * root[j, k]
                root[i, j] = total / root[j, j]
    rss = gram[lags + 1, lags + 1]
    for i in range(size):
        for k in range(i):
            right[i] -= root[i, k] * right[k]
        right[i] /= root[i, i]
        rss -= right[i] * right[i]
    for i in range(size - 1, -1, -1):
        for k in range(i + 1, size):
            right[i] -= root[k, i] * right[k]
        right[i] /= root[i, i]
    b[:count] = right[:count]
    return float(max(rss, 0.0))


@njit(cache=True, nogil=True)
def scan(
    x: FloatArray,
    y: FloatArray,
    segments: IntArray,
    d: FloatArray,
    polynomials: FloatArray,
    decays: FloatArray,
    low: int,
    high: int,
    orders: int,
    rss: FloatArray,
    b: FloatArray,
) -> int:
    """Residual sums of squares for every A (m, na), order of B below `orders` and delay low .. high.

    D(q) = 1 + sum d_i q^-i whitens. Fills rss (m, orders, delays) and b (m, orders, delays, orders); returns the
    number of rows.
    """
    lags = high - low + orders
    first = high + orders + d.size
    white, drive, ones = np.zeros(y.size), np.zeros(y.size), np.ones(y.size)
    rows = 0
    for start, stop in segments:  # from rest, D before 1/A is D behind it
        white[start:stop], drive[start:stop] = y[start:stop], x[start:stop]
        add_lagged(d, y[start : stop - 1], white[start + 1 : stop])
        add_lagged(d, x[start : stop - 1], drive[start + 1 : stop])
        whole = ones[start:stop].copy()
        add_lagged(d, whole[:-1], ones[start + 1 : stop])
        rows += max(stop - start - first, 0)
    whitened, level = np.zeros(y.size), np.zeros(y.size)
    for m in range(polynomials.shape[0]):
        gram = np.zeros((lags + 2, lags + 2))
        for start, stop in segments:
            if stop - start <= first:
                continue
            all_pole(polynomials[m], drive[start:stop], whitened[start:stop])
            all_pole(polynomials[m], ones[start:stop], level[start:stop])
            _add_segment(whitened[start:stop], white[start:stop], level[start:stop], decays[m], first, low, lags, gram)
        for order in range(orders):
            for delay in range(low, high + 1):
                rss[m, order, delay - low] = _least_squares(
                    gram, delay - low, order + 1, lags, b[m, order, delay - low]
                )
    return rows
