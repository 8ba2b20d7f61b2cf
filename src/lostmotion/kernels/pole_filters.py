"""1/A of a signal, a block after the other.

A sample waits for the one before it. So up to three poles answer to eight samples at a time: to the samples themselves,
whose answers are known beforehand, and to what was there before them.
"""

from __future__ import annotations

import numpy as np
from numba import config

from lostmotion.arrays import FloatArray
from lostmotion.kernels.lanes import (
    EIGHT,
    Octet,
    address,
    load_eight,
    newest,
    plus_product,
    second_newest,
    spread_eight,
    store,
    third_newest,
    times,
)
from lostmotion.kernels.numba_cache import njit

GONE = 1e-100  # what has decayed to this is zero: below 1e-308 a product of two numbers takes a hundred times as long
REST = 256  # samples after which it is looked at
POLES = 3  # that answer to eight samples at a time
AHEAD = EIGHT * EIGHT  # floats of the answers to samples; behind them those to the past


@njit(nogil=True)
def answers_of(a: FloatArray) -> FloatArray:
    """What eight samples behind 1/A answer to each of themselves, and to each of POLES samples before them."""
    found = np.zeros(AHEAD + POLES * EIGHT)
    if a.size > POLES:
        return found
    pulse = found[:EIGHT]
    for i in range(EIGHT):
        value = 1.0 if i == 0 else 0.0
        for lag in range(1, min(a.size, i) + 1):
            value -= a[lag - 1] * pulse[i - lag]
        pulse[i] = value
    for j in range(1, EIGHT):
        for i in range(j, EIGHT):
            found[j * EIGHT + i] = pulse[i - j]
    for before in range(a.size):
        past = found[AHEAD + before * EIGHT :]
        for i in range(EIGHT):
            for later in range(min(a.size - before, i + 1)):
                past[i] -= a[before + later] * pulse[i - later]
    return found


@njit(nogil=True, fastmath={"contract"})
def _row_by_row(a: FloatArray, x: FloatArray, row: FloatArray, at: int) -> None:
    """The same one after the other; four poles run in registers."""
    if a.size != POLES + 1:
        for k in range(x.size):
            value = x[k]
            for lag in range(a.size, 0, -1):  # the newest last: it is the critical path
                value -= a[lag - 1] * row[at + k - lag]
            row[at + k] = value if abs(value) > GONE else 0.0
        return
    a1, a2, a3, a4 = a[0], a[1], a[2], a[3]
    y1, y2, y3, y4 = row[at - 1], row[at - 2], row[at - 3], row[at - 4]
    for k in range(x.size):
        value = (x[k] - a4 * y4 - a3 * y3 - a2 * y2) - a1 * y1
        value = value if abs(value) > GONE else 0.0
        y4, y3, y2, y1 = y3, y2, y1, value
        row[at + k] = value


@njit(nogil=True)
def _forget(row: FloatArray, at: int) -> None:
    """Make a past that has decayed zero."""
    if abs(row[at - 1]) < GONE and abs(row[at - 2]) < GONE and abs(row[at - 3]) < GONE:
        row[at - 3 : at] = 0.0


@njit(nogil=True, forceinline=True)
def _with_past(
    value: Octet, poles: int, g1: Octet, g2: Octet, g3: Octet, one: Octet, two: Octet, three: Octet
) -> Octet:
    if poles > 2:
        value = plus_product(value, g3, three)
    if poles > 1:
        value = plus_product(value, g2, two)
    return plus_product(value, g1, one)


@njit(nogil=True)
def _pole_filter(a: FloatArray, answers: FloatArray, x: FloatArray, row: FloatArray, at: int) -> None:
    """Continue row[at..] = (1/A) x; `answers` of ``answers_of``."""
    done, poles = 0, a.size
    if poles <= POLES:
        _forget(row, at)
        known, given, to = address(answers), address(x), address(row)
        h0, h1, h2, h3 = (load_eight(known, 0), load_eight(known, 8), load_eight(known, 16), load_eight(known, 24))
        h4, h5, h6, h7 = (load_eight(known, 32), load_eight(known, 40), load_eight(known, 48), load_eight(known, 56))
        g1, g2, g3 = load_eight(known, 64), load_eight(known, 72), load_eight(known, 80)
        y1, y2, y3 = spread_eight(to[at - 1]), spread_eight(to[at - 2]), spread_eight(to[at - 3])
        while done + EIGHT <= x.size:
            p = times(h0, spread_eight(given[done]))
            q = times(h1, spread_eight(given[done + 1]))
            p = plus_product(p, h2, spread_eight(given[done + 2]))
            q = plus_product(q, h3, spread_eight(given[done + 3]))
            p = plus_product(p, h4, spread_eight(given[done + 4]))
            q = plus_product(q, h5, spread_eight(given[done + 5]))
            p = plus_product(p, h6, spread_eight(given[done + 6]))
            q = plus_product(q, h7, spread_eight(given[done + 7]))
            y = _with_past(plus_product(p, spread_eight(1.0), q), poles, g1, g2, g3, y1, y2, y3)
            store(to, at + done, y)
            y1, y2, y3 = newest(y), second_newest(y), third_newest(y)
            done += EIGHT
    _row_by_row(a, x[done:], row, at + done)


def _pole_filter_plain(a: FloatArray, _answers: FloatArray, x: FloatArray, row: FloatArray, at: int) -> None:
    _row_by_row(a, x, row, at)


pole_filter = _pole_filter_plain if config.DISABLE_JIT else _pole_filter  # type: ignore[attr-defined]


@njit(nogil=True)
def all_pole(a: FloatArray, x: FloatArray, out: FloatArray) -> None:
    """Write (1/A) x into `out` (n,), from rest."""
    past, first, answers = max(a.size, POLES), min(REST, x.size), answers_of(a)
    head = np.zeros(past + first)
    pole_filter(a, answers, x[:first], head, past)
    for k in range(first):
        out[k] = head[past + k]
    for begin in range(REST, x.size, REST):
        pole_filter(a, answers, x[begin : min(begin + REST, x.size)], out, begin)
