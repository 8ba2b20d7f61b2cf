"""Normal equations of what the prediction errors are linear in, A and D held, where only the input changes.

With A and D held every gradient but that of B belongs to courses that stay: they are filtered once. An input costs one
filter pass and its products with these.
"""

from __future__ import annotations

import numpy as np
from numba import config

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.lanes import widest
from lostmotion.kernels.likelihood import add_lagged
from lostmotion.kernels.numba_cache import njit
from lostmotion.kernels.pole_filters import all_pole


@njit(nogil=True)
def respond(a: FloatArray, d: FloatArray, x: FloatArray, out: FloatArray) -> None:
    """Fill `out` (n,) with (D/A) x, from rest."""
    raw = np.empty(x.size)
    all_pole(a, x, raw)
    for k in range(x.size):
        out[k] = raw[k]
    if d.size > 0 and x.size > 1:
        add_lagged(d, raw[:-1], out[1:])


@njit(nogil=True, fastmath={"reassoc", "contract"})
def _sum_of_products(one: FloatArray, other: FloatArray) -> float:
    widest()
    total = 0.0
    for k in range(one.size):
        total += one[k] * other[k]
    return total


_dot = np.dot if config.DISABLE_JIT else _sum_of_products  # type: ignore[attr-defined]


@njit(nogil=True)
def _add_early(
    b: FloatArray, p: int, early: float, s: int, head: int, padded: FloatArray, without: FloatArray,
    shared: FloatArray, initial: FloatArray, gram: FloatArray, cross: FloatArray, target: FloatArray,
) -> float:  # fmt: skip
    """The same over the first p rows of segment `s`, from `head` on."""
    lags, m, nc, squares = b.size, shared.shape[0], initial.shape[0], 0.0
    row = np.empty(lags)
    for k in range(p):
        error = without[head + k]
        for i in range(lags):
            row[i] = early * padded[lags - i + k]
            error -= b[i] * row[i]
        squares += error * error
        for i in range(lags):
            target[i] += row[i] * error
            for j in range(lags):
                gram[i, j] += row[i] * row[j]
            for f in range(m):
                cross[i, f] += row[i] * shared[f, head + k]
            for f in range(nc):
                cross[i, m + s * nc + f] += row[i] * initial[f, head + k]
        for f in range(m):
            target[lags + f] += shared[f, head + k] * error
        for f in range(nc):
            target[lags + m + s * nc + f] += initial[f, head + k] * error
    return squares


@njit(nogil=True)
def input_products(
    a: FloatArray,
    b: FloatArray,
    d: FloatArray,
    delay: int,
    first: int,
    segments: IntArray,
    x: FloatArray,
    without: FloatArray,
    shared: FloatArray,
    initial: FloatArray,
    early: float,
    gram: FloatArray,
    cross: FloatArray,
    target: FloatArray,
) -> float:
    """Products of the lags of w = (D/A) x(k - delay) and of courses, and of both with the prediction errors.

    The errors are `without` (n,), what they are without input, less B w. Adds to `gram` (lags, lags) the products of
    the lags; to `cross` (lags, m + s nc) those with `shared` (m, n) over all segments and with `initial` (nc, n) over
    each; to `target` (lags + m + s nc,) those of all with the errors. Over the rows from `first` + the order of D on,
    both from the start of a segment, and with `early` (root of their weight) over those before, where all that is given
    has it already. Returns the sum of squares of the errors.
    """
    lags, m, nc, p, squares = b.size, shared.shape[0], initial.shape[0], d.size, 0.0
    for s in range(segments.shape[0]):
        head, stop = segments[s, 0] + first, segments[s, 1]
        n = stop - head
        if n <= p:
            continue
        padded = np.zeros(lags + n)
        respond(a, d, x[head - delay : stop - delay], padded[lags:])
        errors = without[head + p : stop].copy()
        for i in range(lags):
            errors -= b[i] * padded[lags - i + p : lags - i + n]
        squares += _dot(errors, errors)
        for i in range(lags):
            row = padded[lags - i + p : lags - i + n]
            target[i] += _dot(row, errors)
            for j in range(i + 1):
                value = _dot(row, padded[lags - j + p : lags - j + n])
                gram[i, j] += value
                if j < i:
                    gram[j, i] += value
            for f in range(m):
                cross[i, f] += _dot(row, shared[f, head + p : stop])
            for f in range(nc):
                cross[i, m + s * nc + f] += _dot(row, initial[f, head + p : stop])
        if early > 0.0:
            squares += _add_early(b, p, early, s, head, padded, without, shared, initial, gram, cross, target)
        for f in range(m):
            target[lags + f] += _dot(shared[f, head + p : stop], errors)
        for f in range(nc):
            target[lags + m + s * nc + f] += _dot(initial[f, head + p : stop], errors)
    return squares
