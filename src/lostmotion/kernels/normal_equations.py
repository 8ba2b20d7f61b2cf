"""Normal equations of the likelihood (``kernels.likelihood``), a block of samples at a time.

All gradients but those of eta are lags of a few signals. So of every two signals only the products with one of them at
its first lag are summed up; moving both lags by one drops the last product and adds one in front. And no more than a
block of the signals ever exists, whatever the length of the record.
"""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.gradient_signals import BLOCK, ETA, TILE, H, X, Z, block_at, fill_block, is_quiet, keep_past
from lostmotion.kernels.lanes import widest
from lostmotion.kernels.no_literal import no_literal
from lostmotion.kernels.numba_cache import njit
from lostmotion.kernels.pole_filters import answers_of
from lostmotion.kernels.row_products import add_row_products, added_up, room


@njit(nogil=True, inline="always")
def _layout(
    na: int, nb1: int, ne: int, p: int, nc: int, width: int
) -> tuple[IntArray, IntArray, IntArray, IntArray, IntArray]:
    """Signals in the order of their parameters: where each is in a buffer of rows `width` long, and its lags.

    Returns the place of its first sample at its first lag and the number of lags of each; the places of all lags; the
    first parameter of each, the initial state left open; and the places of the first lags, of the errors and, last
    because it goes first, of the initial state.
    """
    groups, behind = 4 + ne, 4 + ne if p > 0 else 0  # first row of the signals behind D
    history = width - BLOCK - TILE
    row, lag, count = np.empty(groups, np.int64), np.zeros(groups, np.int64), np.ones(groups, np.int64)
    place = np.zeros(groups, np.int64)
    row[0], lag[0], count[0] = behind + Z, 1, na
    row[1], count[1], place[1] = behind + X, nb1, na
    for e in range(ne):
        row[2 + e], place[2 + e] = behind + ETA + e, na + nb1 + 1 + e
    row[2 + ne], lag[2 + ne], count[2 + ne], place[2 + ne] = ETA + ne, 1, p, na + nb1 + 1 + ne  # v, before D
    row[3 + ne], count[3 + ne] = behind + H, nc
    begins, single, many = np.empty(groups, np.int64), np.empty(groups + 1, np.int64), 0
    for g in range(groups):
        begins[g] = row[g] * width + history - lag[g]
        single[g if g < groups - 1 else groups] = begins[g]
        many += count[g]
    single[groups - 1] = (behind + ETA + ne) * width + history
    lagged, at = np.empty(many, np.int64), 0
    for g in range(groups):
        for i in range(count[g]):
            lagged[at] = begins[g] - i
            at += 1
    return begins, count, lagged, place, single


@njit(nogil=True, inline="always")
def _assemble(
    cross: FloatArray,
    count: IntArray,
    heads: FloatArray,
    tails: FloatArray,
    place: IntArray,
    sign: FloatArray,
    hessian: FloatArray,
) -> None:
    """Add the products of all lags to `hessian`.

    `heads` and `tails` (groups, lags) are what one lag more lets in and out; `place` is the first parameter of each
    group, `sign` what its gradients are multiplied by.
    """
    groups = count.size
    at = np.zeros(groups + 1, np.int64)
    for g in range(groups):
        at[g + 1] = at[g] + count[g]
    for g in range(groups):
        for h in range(g + 1):
            table = np.zeros((count[g], count[h]))
            first, second = (g if g < groups - 1 else groups), (h if h < groups - 1 else groups)
            for i in range(count[g]):
                for j in range(count[h]):
                    if i == 0:
                        value = cross[first, at[h] + j]
                    elif j == 0:
                        value = cross[second, at[g] + i]
                    else:
                        value = (
                            table[i - 1, j - 1] + heads[g, i - 1] * heads[h, j - 1] - tails[g, i - 1] * tails[h, j - 1]
                        )
                    table[i, j] = value
                    if g != h or j <= i:
                        hessian[place[g] + i, place[h] + j] += sign[g] * sign[h] * value
                        if g != h or j < i:
                            hessian[place[h] + j, place[g] + i] += sign[g] * sign[h] * value


@njit(nogil=True, fastmath={"reassoc", "contract"})
def _sum(values: FloatArray, m: int) -> float:
    widest()
    total = 0.0
    for k in range(m):
        total += values[k]
    return total


@njit(nogil=True, inline="always")
def _add_block(
    flat: FloatArray, begins: IntArray, single: IntArray, lagged: IntArray, gone: int, skipped: int, rows: int,
    parts: FloatArray, sums: FloatArray,
) -> None:  # fmt: skip
    """Add the products of a block to `parts` and the sums of its signals to `sums`; the `gone` last lags are zero."""
    singles = single.size - 1 if gone else single.size
    add_row_products(flat, single + skipped, singles, lagged + skipped, lagged.size - gone, rows, parts)
    for g in range(begins.size):
        sums[g] += _sum(flat[begins[g] + skipped :], rows)


@njit(nogil=True, inline="always")
def _add_level(
    cross: FloatArray, sums: FloatArray, whole: float, level: int, count: IntArray, heads: FloatArray,
    tails: FloatArray, place: IntArray, sign: FloatArray, hessian: FloatArray, gradient: FloatArray,
) -> None:  # fmt: skip
    """Add the products with the errors, and those with the gradient of the offset, which is `whole` in every row."""
    at = 0
    for g in range(count.size):
        for i in range(count[g]):
            gradient[place[g] + i] += sign[g] * cross[count.size - 1, at]
            product = sign[g] * whole * sums[g]
            sums[g] += heads[g, i] - tails[g, i]
            hessian[level, place[g] + i] += product
            hessian[place[g] + i, level] += product
            at += 1


@njit(nogil=True, inline="always")
def _add_early(
    flat: FloatArray, begins: IntArray, count: IntArray, errors_at: int, place: IntArray, sign: FloatArray,
    d: FloatArray, level: int, early: float, hessian: FloatArray, gradient: FloatArray,
) -> float:  # fmt: skip
    """Add the weighted products of the first rows of a segment, one for each coefficient of D; their squared errors."""
    groups, many, cost, whole = count.size, 1, 0.0, -1.0
    for g in range(groups):
        many += count[g]
    row, at = np.empty(many), np.empty(many, np.int64)
    for k in range(d.size):
        n = 0
        for g in range(groups):
            for i in range(count[g]):
                row[n], at[n] = sign[g] * flat[begins[g] - i + k], place[g] + i
                n += 1
        row[n], at[n] = whole, level
        whole -= d[k]
        error = flat[errors_at + k]
        cost += early * error * error
        for i in range(many):
            gradient[at[i]] += early * row[i] * error
            for j in range(many):
                hessian[at[i], at[j]] += early * row[i] * row[j]
    return cost


@njit(nogil=True)
def _ends(flat: FloatArray, begins: IntArray, count: IntArray, column: int, values: FloatArray) -> None:
    """Fill `values` (groups, lags) with what is at a column, each group at its lags."""
    for g in range(count.size):
        for i in range(count[g] - 1):
            values[g, i] = flat[begins[g] + column - i]


@njit(nogil=True)
def normal_equations(
    theta: FloatArray, na: int, nb: int, ne: int, p: int, delay: int, first: int, segments: IntArray,
    x: FloatArray, dx: FloatArray, shapes: FloatArray, y: FloatArray, hessian: FloatArray, gradient: FloatArray,
    zero: float = 0.0, early: float = 0.0,
) -> float:  # fmt: skip
    """Add J'J and J'e of all segments to `hessian` (n, n) and `gradient` (n,); return the sum of e squared.

    `segments` (s, 2) holds start and stop rows; `first` counts from the start of each. Derivatives of x
    with respect to the ne parameters of the actuator are the rows of `dx` (m, samples) and then those of `shapes`.
    With a `zero` of the noise each segment has one more initial condition. The first p rows of a segment, before which
    the noise is taken as zero, count with the weight `early`.
    """
    nc, level, signals = max(na, nb) + (zero > 0.0), na + nb + 1, 4 + ne
    shared = level + 1 + ne
    a, b, d, offset = theta[:na], theta[na:level], theta[shared : shared + p], theta[level]
    history = max(na, nb + 1, p, 4) + 1
    begins, count, lagged, place, single = _layout(na, nb + 1, ne, p, nc, history + BLOCK + TILE)
    groups, many = count.size, lagged.size
    buffer = np.empty((2 * signals if p > 0 else signals, history + BLOCK + TILE))
    raw, white, flat = buffer[:signals], buffer[-signals:], buffer.reshape(-1)
    answers, sign = answers_of(a), np.empty(groups)
    for g in range(groups):
        sign[g] = 1.0 if g in (0, 2 + ne) else -1.0
    heads, tails = np.zeros((groups, history)), np.zeros((groups, history))
    parts, work = np.empty(room(groups + 1, many)), np.empty((2, BLOCK))
    whole, cost = 0.0, 0.0
    for value in d:
        whole += value
    whole = -(1.0 + whole)  # gradient of the offset
    for s in range(segments.shape[0]):
        head, n, place[-1] = segments[s, 0] + first, segments[s, 1] - segments[s, 0] - first, shared + p + s * nc
        if n <= p:
            continue
        c, sums, total = theta[place[-1] : place[-1] + nc], np.zeros(groups), 0.0
        parts[:] = 0.0
        buffer[:, :history] = 0.0
        k0 = no_literal(0)
        while k0 < n:
            m, skipped = block_at(k0, n, p), max(p - k0, 0)
            gone = nc if k0 > 0 and is_quiet(white[H, :history]) else 0
            part, at = y[head + k0 : head + k0 + m], head - delay
            fill_block(
                a, answers, b, c, d, offset, k0, at, x, dx, shapes, part, raw, white, history, work, zero, gone > 0
            )
            if k0 == 0:
                _ends(flat, begins, count, p - 1, heads)
                if early > 0.0:
                    cost += _add_early(flat, begins, count, single[-2], place, sign, d, level, early, hessian, gradient)
            if m > skipped:
                buffer[:, history + m : history + m + TILE] = 0.0  # what is behind a block is read, and adds nothing
                _add_block(flat, begins, single, lagged, gone, skipped, m - skipped, parts, sums)
                errors = white[ETA + ne, history + skipped : history + m]
                total, cost = total + _sum(errors, m - skipped), cost + np.dot(errors, errors)
            if k0 + m < n:
                keep_past(buffer, m, history)
            else:
                _ends(flat, begins, count, m - 1, tails)
            k0 += m
        cross = added_up(parts, groups + 1, many)
        _assemble(cross, count, heads, tails, place, sign, hessian)
        _add_level(cross, sums, whole, level, count, heads, tails, place, sign, hessian, gradient)
        hessian[level, level] += whole * whole * (n - p)
        gradient[level] += whole * total
    return cost
