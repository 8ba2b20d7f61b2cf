"""Least squares for B at many given A, all delays at once: where to begin with a linear part.

With A fixed, A(q) z = B(q) x(k-d) is linear in B: z is a sum of lagged copies of X = (1/A) x. One Gram matrix of the
lags of X, filled by its shift structure, serves every delay and every order of B. The response to a constant input
(offset, or load of an integrating process) is fitted too; for every segment the decay of the slowest mode (its initial
state) is eliminated.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from numba import config, njit

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.lanes import WIDTH
from lostmotion.kernels.likelihood import add_lagged, all_pole
from lostmotion.kernels.pole_sums import GONE, derive_lags, respond, sum_lags, sum_modes
from lostmotion.kernels.products import add_lags

RIDGE = 1e-12
MOST_POLES = 3  # of which the sums at a few lags give the rest


@njit(cache=True, nogil=True)
def _add_segment(
    a: FloatArray,
    decays: FloatArray,
    drive: FloatArray,
    ones: FloatArray,
    target: FloatArray,
    first: int,
    low: int,
    lags: int,
    orders: int,
    known: FloatArray,
    grams: FloatArray,
) -> None:
    """Add the Gram matrices of [X(k-low) .. X(k-low-lags+1), level, y] over rows k >= first, without a decaying mode.

    For four A: `a` (na, 4), `decays` (4,); `grams` is (4, lags + 2, lags + 2), lower halves, of products of lags
    only those less than `orders` apart. `known` as in ``derive_lags``; empty: every lag is summed up.
    """
    n = target.size
    x, level = np.empty(WIDTH * n), np.empty(WIDTH * n)
    sums, modes = np.empty((lags, 3, WIDTH)), np.empty((5, WIDTH))
    respond(a, drive, ones, x, level)
    if known.size > 0:
        derive_lags(a, x, level, target, ones[-1], known, first, low, lags, orders, sums)
    else:
        sum_lags(x, level, target, first, low, lags, sums)
    sum_modes(x, level, target, decays, first, low, modes)
    square = 0.0
    for k in range(first, n):
        square += target[k] * target[k]
    part, with_mode = np.zeros((lags + 2, lags + 2)), np.zeros(lags + 2)
    for lane in range(WIDTH):
        decay, rows = decays[lane], n - first
        whole = rows if decay == 1.0 else (1.0 - decay ** (2 * rows)) / (1.0 - decay * decay)
        last = decay ** (rows - 1)
        with_mode[0], with_mode[lags + 1], with_mode[lags] = modes[0, lane], modes[1, lane], modes[2, lane]
        for lag in range(1, lags):  # one lag more: a value in front, a power of the decay, one value less at the end
            before, after = x[(first - low - lag) * WIDTH + lane], x[(n - low - lag) * WIDTH + lane]
            with_mode[lag] = before + decay * (with_mode[lag - 1] - last * after)
        part[:orders, 0] = sums[:orders, 0, lane]
        part[lags + 1, :lags], part[lags, :lags] = sums[:, 1, lane], sums[:, 2, lane]
        part[lags, lags], part[lags + 1, lags], part[lags + 1, lags + 1] = modes[3, lane], modes[4, lane], square
        for column in range(1, lags):
            head, tail = x[(first - low - column) * WIDTH + lane], x[(n - low - column) * WIDTH + lane]
            for row in range(column, min(column + orders, lags)):
                before, after = x[(first - low - row) * WIDTH + lane], x[(n - low - row) * WIDTH + lane]
                part[row, column] = part[row - 1, column - 1] + before * head - after * tail
        for i in range(lags + 2):
            share = with_mode[i] / whole
            for j in range(max(i - orders + 1, 0) if i < lags else 0, i + 1):
                grams[lane, i, j] += part[i, j] - share * with_mode[j]


@njit(cache=True, nogil=True)
def _pivot(left: float, whole: float) -> float:
    """Of a column of which others leave `left`; infinite where it is one of them, or nothing."""
    return float(np.sqrt(left)) if left > RIDGE * whole and whole > GONE else np.inf


@njit(cache=True, nogil=True)
def _least_squares(gram: FloatArray, at: int, lags: int, rss: FloatArray, b: FloatArray, work: FloatArray) -> None:
    """Residual sums of squares of y on X at lags at .. at + i and the level, for every i; fill rss (m,) and b (m, m).

    `work` (m + 2, m) is overwritten.
    The level comes last in every factorisation, so that each order is the one before it with a column more.
    """
    orders = rss.size
    root, steps, right = work[:orders], work[orders], work[orders + 1]
    left, level, wanted = gram[lags + 1, lags + 1], gram[lags, lags], gram[lags + 1, lags]
    for i in range(orders):
        for j in range(i):
            value = gram[at + i, at + j]
            for k in range(j):
                value -= root[i, k] * root[j, k]
            root[i, j] = value / root[j, j]
        value = gram[at + i, at + i]
        right[i], steps[i] = gram[lags + 1, at + i], gram[lags, at + i]
        for k in range(i):
            value -= root[i, k] * root[i, k]
            right[i] -= root[i, k] * right[k]
            steps[i] -= root[i, k] * steps[k]
        root[i, i] = _pivot(value, gram[at + i, at + i])
        right[i], steps[i] = right[i] / root[i, i], steps[i] / root[i, i]
        left -= right[i] * right[i]
        level -= steps[i] * steps[i]
        wanted -= right[i] * steps[i]
        pivot = _pivot(level, gram[lags, lags])
        rss[i] = max(left - (wanted / pivot) ** 2, 0.0)
        offset = wanted / pivot / pivot
        for j in range(i, -1, -1):
            value = right[j] - steps[j] * offset
            for k in range(j + 1, i + 1):
                value -= root[k, j] * b[i, k]
            b[i, j] = value / root[j, j]


@njit(cache=True, nogil=True)
def _whitened(
    d: FloatArray, segments: IntArray, x: FloatArray, y: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """D of y, x and a constant, from rest in every segment: D before 1/A is D behind it."""
    white, drive, ones = np.zeros(y.size), np.zeros(y.size), np.zeros(y.size)
    for start, stop in segments:
        white[start:stop], drive[start:stop], ones[start:stop] = y[start:stop], x[start:stop], 1.0
        add_lagged(d, y[start : stop - 1], white[start + 1 : stop])
        add_lagged(d, x[start : stop - 1], drive[start + 1 : stop])
        whole = ones[start:stop].copy()
        add_lagged(d, whole[:-1], ones[start + 1 : stop])
    return white, drive, ones


@njit(cache=True, nogil=True)
def _scan(
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
    quick: bool = False,
) -> int:
    """Residual sums of squares for every A (m, na), order of B below `orders` and delay low .. high.

    D(q) = 1 + sum d_i q^-i whitens. Fills rss (m, orders, delays) and b (m, orders, delays, orders); returns the
    number of rows. `quick`: with rounding as in ``derive_lags``, where there are few poles.
    """
    lags = high - low + orders
    first = high + orders + d.size
    white, drive, ones = _whitened(d, segments, x, y)
    rows = 0
    for start, stop in segments:
        rows += max(stop - start - first, 0)
    m, na = polynomials.shape
    known = np.zeros((segments.shape[0], lags if quick and 0 < na <= MOST_POLES and lags > na else 0))
    for s in range(segments.shape[0] if known.size > 0 else 0):
        start, stop = segments[s]
        if stop - start > first:
            cross, wanted = np.zeros((2, lags)), white[start + first : stop]
            add_lags(wanted, wanted, drive, start + first - low, lags, cross)
            known[s] = cross[0]
    a, modes = np.empty((na, WIDTH)), np.empty(WIDTH)
    squares, gains, work = np.empty(orders), np.empty((orders, orders)), np.empty((orders + 2, orders))
    for begin in range(0, m, WIDTH):
        for lane in range(WIDTH):
            a[:, lane], modes[lane] = polynomials[min(begin + lane, m - 1)], decays[min(begin + lane, m - 1)]
        grams = np.zeros((WIDTH, lags + 2, lags + 2))
        for s in range(segments.shape[0]):
            start, stop = segments[s]
            if stop - start > first:
                drives = drive[start:stop], ones[start:stop], white[start:stop]
                _add_segment(a, modes, *drives, first, low, lags, orders, known[s], grams)
        for lane in range(min(WIDTH, m - begin)):
            for at in range(high - low + 1):
                _least_squares(grams[lane], at, lags, squares, gains, work)
                for order in range(orders):
                    rss[begin + lane, order, at] = squares[order]
                    b[begin + lane, order, at, : order + 1] = gains[order, : order + 1]
    return rows


def _gram_plain(columns: list[Any], mode: FloatArray) -> npt.NDArray[Any]:
    table = np.column_stack(columns)
    table = table - np.outer(mode, mode @ table) / (mode @ mode)
    return np.asarray(table.T @ table)


def _scan_plain(
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
    quick: bool = False,  # noqa: ARG001  there is one way only
) -> int:
    """The same by the columns themselves: as plain Python the loops over rows would take minutes."""
    lags, first = high - low + orders, high + orders + d.size
    white, drive, ones = _whitened(d, segments, x, y)
    long = [(start, stop) for start, stop in segments.tolist() if stop - start > first]
    for m, (a, decay) in enumerate(zip(polynomials, decays, strict=True)):
        gram = np.zeros((lags + 2, lags + 2))
        for start, stop in long:
            response, level = np.empty(stop - start), np.empty(stop - start)
            all_pole(a, drive[start:stop], response)
            all_pole(a, ones[start:stop], level)
            lagged = [response[first - low - lag : stop - start - low - lag] for lag in range(lags)]
            mode = decay ** np.arange(stop - start - first)
            gram += _gram_plain([*lagged, level[first:], white[start + first : stop]], mode)
        for at in range(high - low + 1):
            squares, gains = np.empty(orders), np.zeros((orders, orders))
            _least_squares(gram, at, lags, squares, gains, np.empty((orders + 2, orders)))
            rss[m, :, at], b[m, :, at] = squares, gains
    return sum(stop - start - first for start, stop in long)


scan = _scan_plain if config.DISABLE_JIT else _scan  # type: ignore[attr-defined]
