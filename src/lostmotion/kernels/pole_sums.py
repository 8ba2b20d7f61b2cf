"""Sums over rows for w processes at once, as many as fit a register: where the grid of poles spends its time."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.kernels.lanes import WIDEST, Quad, address, alive, plus_product, store, times
from lostmotion.kernels.lanes import load_widest as load
from lostmotion.kernels.lanes import spread_widest as spread
from lostmotion.kernels.numba_cache import njit

GONE = 1e-100  # a mode that has decayed to this is zero: numbers below 1e-308 take a hundred times as long
REST = 64  # rows after which it is looked at; the fastest mode of a grid decays by 1e-40 meanwhile
NUDGE = 1e-140  # keeps responses away from such numbers while a command rests at zero; its square is still above them


@njit(nogil=True, inline="always")
def respond(a: FloatArray, drive: FloatArray, ones: FloatArray, x: FloatArray, level: FloatArray) -> None:
    """Fill `x` and `level` (w n,), sample by sample, with 1/A of `drive` and `ones` (n,) for w processes, from rest.

    `a` is (na, w), coefficient by coefficient.
    """
    na, poles = a.shape[0], address(a.reshape(-1))
    to_x, to_level = address(x), address(level)
    none = spread(0.0)
    a1 = load(poles, 0) if na > 0 else none
    a2 = load(poles, WIDEST) if na > 1 else none
    a3 = load(poles, 2 * WIDEST) if na > 2 else none
    minus = spread(-1.0)
    a1, a2, a3 = times(minus, a1), times(minus, a2), times(minus, a3)
    x1, x2, x3, y1, y2, y3 = none, none, none, none, none, none
    for k in range(drive.size):
        first, second = spread(drive[k] + NUDGE), spread(ones[k])
        for i in range(3, min(na, k)):
            pole = times(minus, load(poles, i * WIDEST))
            first = plus_product(first, pole, load(to_x, (k - 1 - i) * WIDEST))
            second = plus_product(second, pole, load(to_level, (k - 1 - i) * WIDEST))
        first = plus_product(plus_product(plus_product(first, a3, x3), a2, x2), a1, x1)  # the newest last
        second = plus_product(plus_product(plus_product(second, a3, y3), a2, y2), a1, y1)
        x3, x2, x1, y3, y2, y1 = x2, x1, first, y2, y1, second
        store(to_x, k * WIDEST, first)
        store(to_level, k * WIDEST, second)
    alive((a, x, level))


@njit(nogil=True)
def _put(out: FloatArray, at: int, one: Quad, two: Quad, three: Quad) -> None:
    """Write three registers, one after the other."""
    store(out, at, one)
    store(out, at + WIDEST, two)
    store(out, at + 2 * WIDEST, three)


@njit(nogil=True, inline="always")
def sum_lags(
    x: FloatArray, level: FloatArray, target: FloatArray, first: int, low: int, lags: int, sums: FloatArray
) -> None:
    """Fill `sums` (lags, 3, w) with the products of x(k - low - lag) with x(k - low), target(k) and level(k).

    Over rows k >= first of `target` (n,); `x` and `level` are (w n,) as ``respond`` leaves them.
    """
    to_x, to_level, out = address(x), address(level), address(sums.reshape(-1))
    none, triple, last = spread(0.0), 3 * WIDEST, lags - 1
    for lag in range(0, lags, 4):  # a dozen sums stay in registers; beyond the last lag it is summed up again
        i1, i2, i3 = min(lag + 1, last), min(lag + 2, last), min(lag + 3, last)
        from_0, from_1, from_2, from_3 = low + lag, low + i1, low + i2, low + i3
        p0, p1, p2, p3, t0, t1 = none, none, none, none, none, none
        t2, t3, l0, l1, l2, l3 = none, none, none, none, none, none
        for k in range(first, target.size):
            newest, wanted, steps = load(to_x, (k - low) * WIDEST), spread(target[k]), load(to_level, k * WIDEST)
            x0 = load(to_x, (k - from_0) * WIDEST)
            p0, t0, l0 = plus_product(p0, x0, newest), plus_product(t0, x0, wanted), plus_product(l0, x0, steps)
            x1 = load(to_x, (k - from_1) * WIDEST)
            p1, t1, l1 = plus_product(p1, x1, newest), plus_product(t1, x1, wanted), plus_product(l1, x1, steps)
            x2 = load(to_x, (k - from_2) * WIDEST)
            p2, t2, l2 = plus_product(p2, x2, newest), plus_product(t2, x2, wanted), plus_product(l2, x2, steps)
            x3 = load(to_x, (k - from_3) * WIDEST)
            p3, t3, l3 = plus_product(p3, x3, newest), plus_product(t3, x3, wanted), plus_product(l3, x3, steps)
        _put(out, lag * triple, p0, t0, l0)
        _put(out, i1 * triple, p1, t1, l1)
        _put(out, i2 * triple, p2, t2, l2)
        _put(out, i3 * triple, p3, t3, l3)
    alive((x, level, sums))


@njit(nogil=True, inline="always")
def sum_modes(
    x: FloatArray, level: FloatArray, target: FloatArray, decays: FloatArray, first: int, low: int, sums: FloatArray
) -> None:
    """Fill `sums` (5, w) with products over rows k >= first.

    Of the modes decays^(k - first), `decays` (w,), with x(k - low), target(k) and level(k), and of level with itself
    and with target.
    """
    to_x, to_level, now, out = address(x), address(level), np.ones(WIDEST), address(sums.reshape(-1))
    place, factor, none = address(now), load(address(decays), 0), spread(0.0)
    drive, wanted, steps, square, both = none, none, none, none, none
    for begin in range(first, target.size, REST):
        mode = load(place, 0)
        for k in range(begin, min(begin + REST, target.size)):
            here, value = load(to_level, k * WIDEST), spread(target[k])
            drive = plus_product(drive, mode, load(to_x, (k - low) * WIDEST))
            wanted, steps = plus_product(wanted, mode, value), plus_product(steps, mode, here)
            square, both = plus_product(square, here, here), plus_product(both, here, value)
            mode = times(mode, factor)
        store(place, 0, mode)
        for lane in range(WIDEST):
            if now[lane] < GONE:
                now[lane] = 0.0
    store(out, 0, drive)
    store(out, WIDEST, wanted)
    store(out, 2 * WIDEST, steps)
    store(out, 3 * WIDEST, square)
    store(out, 4 * WIDEST, both)
    alive((x, level, decays, sums, now))


@njit(nogil=True, inline="always")
def _sum_few(
    x: FloatArray, level: FloatArray, target: FloatArray, decays: FloatArray, first: int, low: int, lags: int,
    kept: int, sums: FloatArray, last: FloatArray, modes: FloatArray,
) -> None:  # fmt: skip
    """Fill, over rows k >= first, in one pass: `sums` as ``sum_lags``, `modes` (6, w) as ``sum_modes``, `last` (3, w).

    Of the first three lags without target, in `sums`; `last` holds the products of target(k) with the `kept` last lags
    (three at most) of x(k - low), the last lag in the third row. The sixth of `modes` is the sum of x(k - low).
    """
    to_x, to_level, now, out = address(x), address(level), np.ones(WIDEST), address(sums.reshape(-1))
    place, factor, none, one = address(now), load(address(decays), 0), spread(0.0), spread(1.0)
    behind_1, behind_2, end = low + min(1, lags - 1), low + min(2, lags - 1), low + lags - 1
    end_0, end_1 = end - min(kept - 1, 2), end - min(kept - 1, 1)
    p0, p1, p2, l0, l1, l2, t0, t1 = none, none, none, none, none, none, none, none
    t2, whole, drive, wanted, steps, square, both = none, none, none, none, none, none, none
    for begin in range(first, target.size, REST):
        mode = load(place, 0)
        for k in range(begin, min(begin + REST, target.size)):
            value, here, x0 = spread(target[k]), load(to_level, k * WIDEST), load(to_x, (k - low) * WIDEST)
            p0, l0, whole = plus_product(p0, x0, x0), plus_product(l0, x0, here), plus_product(whole, one, x0)
            drive, wanted, steps = (
                plus_product(drive, mode, x0),
                plus_product(wanted, mode, value),
                plus_product(steps, mode, here),
            )
            square, both = plus_product(square, here, here), plus_product(both, here, value)
            x1, x2 = load(to_x, (k - behind_1) * WIDEST), load(to_x, (k - behind_2) * WIDEST)
            p1, l1 = plus_product(p1, x1, x0), plus_product(l1, x1, here)
            p2, l2 = plus_product(p2, x2, x0), plus_product(l2, x2, here)
            t0 = plus_product(t0, load(to_x, (k - end_0) * WIDEST), value)
            t1 = plus_product(t1, load(to_x, (k - end_1) * WIDEST), value)
            t2 = plus_product(t2, load(to_x, (k - end) * WIDEST), value)
            mode = times(mode, factor)
        store(place, 0, mode)
        for lane in range(WIDEST):
            if now[lane] < GONE:
                now[lane] = 0.0
    _put(out, (behind_2 - low) * 3 * WIDEST, p2, none, l2)  # of few lags these are the same
    _put(out, (behind_1 - low) * 3 * WIDEST, p1, none, l1)
    _put(out, 0, p0, none, l0)
    _put(address(last.reshape(-1)), 0, t0, t1, t2)
    _put(address(modes.reshape(-1)), 0, drive, wanted, steps)
    store(address(modes.reshape(-1)), 3 * WIDEST, square)
    store(address(modes.reshape(-1)), 4 * WIDEST, both)
    store(address(modes.reshape(-1)), 5 * WIDEST, whole)
    alive((x, level, decays, sums, last, modes, now))


@njit(nogil=True, inline="always")
def derive_lags(
    a: FloatArray, x: FloatArray, level: FloatArray, target: FloatArray, decays: FloatArray, constant: float,
    known: FloatArray, first: int, low: int, lags: int, sums: FloatArray, modes: FloatArray,
) -> None:  # fmt: skip
    """What ``sum_lags`` and ``sum_modes`` sum up over the rows, from the sums at a few lags, for up to three poles.

    x = drive - sum a_m q^-m x. So its products with target(k) are those of drive(k - lag), `known` (lags,), less those
    at later lags; and those with the level are its sums times the `constant` that drives the level, less those with
    earlier levels, which are those at earlier lags moved along the rows. With x(k - low) only the first three lags.
    """
    na, n, width = a.shape[0], target.size, WIDEST
    last = np.empty((3, width))
    _sum_few(x, level, target, decays, first, low, lags, na, sums, last, modes)
    for i in range(na):
        for lane in range(width):
            sums[lags - na + i, 1, lane] = last[3 - na + i, lane]
    poles, to_x, to_level, out = address(a.reshape(-1)), address(x), address(level), address(sums.reshape(-1))
    minus, step = spread(-1.0), 3 * width
    for lag in range(lags - na - 1, -1, -1):
        wanted = spread(known[lag])
        for m in range(na, 0, -1):
            wanted = plus_product(
                wanted, times(minus, load(poles, (m - 1) * width)), load(out, (lag + m) * step + width)
            )
        store(out, lag * step + width, wanted)
    whole = load(address(modes.reshape(-1)), 5 * width)
    for lag in range(1, lags):
        whole = plus_product(whole, spread(1.0), load(to_x, (first - low - lag) * width))
        whole = plus_product(whole, minus, load(to_x, (n - low - lag) * width))
        if lag < na:
            continue
        steps = times(spread(constant), whole)
        for m in range(na, 0, -1):
            levels = load(out, (lag - m) * step + 2 * width)
            for j in range(1, m + 1):
                before = load(to_x, (first - j - low - lag + m) * width)
                after = times(minus, load(to_x, (n - j - low - lag + m) * width))
                levels = plus_product(levels, before, load(to_level, (first - j) * width))
                levels = plus_product(levels, after, load(to_level, (n - j) * width))
            steps = plus_product(steps, times(minus, load(poles, (m - 1) * width)), levels)
        store(out, lag * step + 2 * width, steps)
    alive((a, x, level, sums, modes))
