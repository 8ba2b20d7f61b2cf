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
from numba import config

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.lanes import WIDEST, Quad, address, alive, less, over, plus_product, root_above, store, times
from lostmotion.kernels.lanes import load_widest as load
from lostmotion.kernels.lanes import spread_widest as spread
from lostmotion.kernels.likelihood import add_lagged
from lostmotion.kernels.numba_cache import njit
from lostmotion.kernels.pole_filters import all_pole
from lostmotion.kernels.pole_sums import GONE, derive_lags, respond, sum_lags, sum_modes
from lostmotion.kernels.products import add_lags

RIDGE = 1e-12
MOST_POLES = 3  # of which the sums at a few lags give the rest


@njit(nogil=True, inline="always")
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
    square: float,
    grams: FloatArray,
) -> None:
    """Add the Gram matrices of [X(k-low) .. X(k-low-lags+1), level, y] over rows k >= first, without a decaying mode.

    For WIDEST A: `a` (na, w), `decays` (w,); `grams` is (lags + 2, lags + 2, w), lower halves, of products of lags
    only those less than `orders` apart. `known` as in ``derive_lags``; empty: every lag is summed up. `square` is the
    sum of y squared.
    """
    n = target.size
    x, level = np.empty(WIDEST * n), np.empty(WIDEST * n)
    sums, modes = np.empty((lags, 3, WIDEST)), np.empty((6, WIDEST))
    respond(a, drive, ones, x, level)
    if known.size > 0:
        derive_lags(a, x, level, target, decays, ones[-1], known, first, low, lags, sums, modes)
    else:
        sum_lags(x, level, target, first, low, lags, sums)
        sum_modes(x, level, target, decays, first, low, modes)
    with_mode, whole = np.empty((lags + 2, WIDEST)), np.empty(WIDEST)
    for lane in range(WIDEST):
        with_mode[0, lane], with_mode[lags + 1, lane], with_mode[lags, lane] = (
            modes[0, lane],
            modes[1, lane],
            modes[2, lane],
        )
        decay, rows = decays[lane], n - first
        whole[lane] = rows if decay == 1.0 else (1.0 - decay ** (2 * rows)) / (1.0 - decay * decay)
        last = decay ** (rows - 1)
        for lag in range(1, lags):  # one lag more: a value in front, a power of the decay, one value less at the end
            before, after = x[(first - low - lag) * WIDEST + lane], x[(n - low - lag) * WIDEST + lane]
            with_mode[lag, lane] = before + decay * (with_mode[lag - 1, lane] - last * after)
    part = np.zeros((lags + 2, lags + 2, WIDEST))
    for lane in range(WIDEST):
        for lag in range(lags):
            if lag < orders:
                part[lag, 0, lane] = sums[lag, 0, lane]
            part[lags + 1, lag, lane], part[lags, lag, lane] = sums[lag, 1, lane], sums[lag, 2, lane]
        part[lags, lags, lane], part[lags + 1, lags, lane] = modes[3, lane], modes[4, lane]
        part[lags + 1, lags + 1, lane] = square
    _add_part(x, first - low, n - low, lags, orders, part, with_mode, whole, grams)


@njit(nogil=True, inline="always")
def _add_part(
    x: FloatArray, first: int, last: int, lags: int, orders: int, part: FloatArray, with_mode: FloatArray,
    whole: FloatArray, grams: FloatArray,
) -> None:  # fmt: skip
    """Complete `part` from its first column, and add it to `grams` without what the mode explains."""
    to_x, table, out = address(x), address(part.reshape(-1)), address(grams.reshape(-1))
    mode, size, one = address(with_mode.reshape(-1)), lags + 2, spread(1.0)
    for column in range(1, lags):
        head, tail = load(to_x, (first - column) * WIDEST), load(to_x, (last - column) * WIDEST)
        for row in range(column, min(column + orders, lags)):
            let_in = times(load(to_x, (first - row) * WIDEST), head)
            let_out = times(load(to_x, (last - row) * WIDEST), tail)
            value = plus_product(let_in, one, load(table, ((row - 1) * size + column - 1) * WIDEST))
            store(table, (row * size + column) * WIDEST, less(value, let_out))
    energy = load(address(whole), 0)
    for i in range(size):
        share = over(load(mode, i * WIDEST), energy)
        for j in range(max(i - orders + 1, 0) if i < lags else 0, i + 1):
            at = (i * size + j) * WIDEST
            value = less(load(table, at), times(share, load(mode, j * WIDEST)))
            store(out, at, plus_product(value, one, load(out, at)))
    alive((x, part, with_mode, whole, grams))


@njit(nogil=True, forceinline=True)
def _pivot(left: Quad, whole: Quad) -> Quad:
    """Of columns of which others leave `left`; infinite where one is one of them, or nothing."""
    return root_above(left, plus_product(spread(GONE), spread(RIDGE), whole))


@njit(nogil=True, inline="always")
def _least_squares(gram: FloatArray, at: int, lags: int, rss: FloatArray, b: FloatArray, work: FloatArray) -> None:
    """Residual sums of squares of y on X at lags at .. at + i and the level, for every i, of WIDEST grids at once.

    Fills rss (m, w), not cut off at zero, and b (m, m, w); `work` (m + 2, m, w) is overwritten. The level comes last in
    every factorisation, so that each order is the one before it with a column more.
    """
    orders, size = rss.shape[0], lags + 2
    table, squares, gains = address(gram.reshape(-1)), address(rss.reshape(-1)), address(b.reshape(-1))
    root, line = address(work.reshape(-1)), orders * WIDEST
    to_steps, to_right = orders * line, (orders + 1) * line
    with_y, with_level = (lags + 1) * size * WIDEST, lags * size * WIDEST
    left, level = load(table, with_y + (lags + 1) * WIDEST), load(table, with_level + lags * WIDEST)
    wanted, whole_level = load(table, with_y + lags * WIDEST), load(table, with_level + lags * WIDEST)
    for i in range(orders):
        row, here = ((at + i) * size + at) * WIDEST, i * WIDEST
        for j in range(i):
            value = load(table, row + j * WIDEST)
            for k in range(j):
                value = less(value, times(load(root, i * line + k * WIDEST), load(root, j * line + k * WIDEST)))
            store(root, i * line + j * WIDEST, over(value, load(root, j * line + j * WIDEST)))
        whole = load(table, row + here)
        value, right = whole, load(table, with_y + (at + i) * WIDEST)
        steps = load(table, with_level + (at + i) * WIDEST)
        for k in range(i):
            factor = load(root, i * line + k * WIDEST)
            value = less(value, times(factor, factor))
            right = less(right, times(factor, load(root, to_right + k * WIDEST)))
            steps = less(steps, times(factor, load(root, to_steps + k * WIDEST)))
        pivot = _pivot(value, whole)
        right, steps = over(right, pivot), over(steps, pivot)
        store(root, i * line + here, pivot)
        store(root, to_right + here, right)
        store(root, to_steps + here, steps)
        left, level = less(left, times(right, right)), less(level, times(steps, steps))
        wanted = less(wanted, times(right, steps))
        pivot = _pivot(level, whole_level)
        share = over(wanted, pivot)
        store(squares, here, less(left, times(share, share)))
        offset = over(share, pivot)
        for j in range(i, -1, -1):
            value = less(load(root, to_right + j * WIDEST), times(load(root, to_steps + j * WIDEST), offset))
            for k in range(j + 1, i + 1):
                value = less(value, times(load(root, k * line + j * WIDEST), load(gains, i * line + k * WIDEST)))
            store(gains, i * line + j * WIDEST, over(value, load(root, j * line + j * WIDEST)))
    alive((gram, rss, b, work))


@njit(nogil=True, inline="always")
def _whitened(
    d: FloatArray, segments: IntArray, x: FloatArray, y: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """D of y, x and a constant, from rest in every segment: D before 1/A is D behind it."""
    white, drive, ones = np.zeros(y.size), np.zeros(y.size), np.zeros(y.size)
    for start, stop in segments:
        for k in range(start, stop):
            white[k], drive[k], ones[k] = y[k], x[k], 1.0
        add_lagged(d, y[start : stop - 1], white[start + 1 : stop])
        add_lagged(d, x[start : stop - 1], drive[start + 1 : stop])
        whole = ones[start:stop].copy()
        add_lagged(d, whole[:-1], ones[start + 1 : stop])
    return white, drive, ones


@njit(nogil=True)
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
    every: int = 1,
) -> int:
    """Residual sums of squares for every A (m, na), order of B below `orders` and delay low .. high.

    D(q) = 1 + sum d_i q^-i whitens. Fills rss (m, orders, delays) and b (m, orders, delays, orders); returns the
    number of rows. `quick`: with rounding as in ``derive_lags``, where there are few poles. `every`: of so many delays
    one is looked at, the others are left as they are.
    """
    lags = high - low + orders
    first = high + orders + d.size
    white, drive, ones = _whitened(d, segments, x, y)
    rows = 0
    for start, stop in segments:
        rows += max(stop - start - first, 0)
    m, na = polynomials.shape
    few = quick and 0 < na <= MOST_POLES and na < lags and orders <= MOST_POLES
    known, squares_of_y = np.zeros((segments.shape[0], lags if few else 0)), np.zeros(segments.shape[0])
    for s in range(segments.shape[0]):
        start, stop = segments[s]
        if stop - start > first:
            cross, wanted = np.zeros((2, lags)), white[start + first : stop]
            squares_of_y[s] = np.dot(wanted, wanted)
            if few:
                add_lags(wanted, wanted, drive, start + first - low, lags, cross)
                for lag in range(lags):
                    known[s, lag] = cross[0, lag]
    a, modes = np.empty((na, WIDEST)), np.empty(WIDEST)
    squares, gains = np.empty((orders, WIDEST)), np.empty((orders, orders, WIDEST))
    work = np.empty((orders + 2, orders, WIDEST))
    for begin in range(0, m, WIDEST):
        for lane in range(WIDEST):
            which = min(begin + lane, m - 1)
            modes[lane] = decays[which]
            for i in range(na):
                a[i, lane] = polynomials[which, i]
        grams = np.zeros((lags + 2, lags + 2, WIDEST))
        for s in range(segments.shape[0]):
            start, stop = segments[s]
            if stop - start > first:
                wanted, square = white[start:stop], squares_of_y[s]
                _add_segment(
                    a, modes, drive[start:stop], ones[start:stop], wanted, first, low, lags, orders, known[s], square,
                    grams,
                )  # fmt: skip
        for at in range(0, high - low + 1, every):
            _least_squares(grams, at, lags, squares, gains, work)
            for lane in range(min(WIDEST, m - begin)):
                for order in range(orders):
                    rss[begin + lane, order, at] = max(squares[order, lane], 0.0)
                    for i in range(order + 1):
                        b[begin + lane, order, at, i] = gains[order, i, lane]
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
    every: int = 1,
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
        grams = np.repeat(gram[:, :, None], WIDEST, axis=2)
        squares, gains = np.empty((orders, WIDEST)), np.zeros((orders, orders, WIDEST))
        for at in range(0, high - low + 1, every):
            _least_squares(grams, at, lags, squares, gains, np.empty((orders + 2, orders, WIDEST)))
            rss[m, :, at], b[m, :, at] = np.maximum(squares[:, 0], 0.0), gains[:, :, 0]
    return sum(stop - start - first for start, stop in long)


scan = _scan_plain if config.DISABLE_JIT else _scan  # type: ignore[attr-defined]
