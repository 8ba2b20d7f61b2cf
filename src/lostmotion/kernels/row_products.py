"""Products of every row of some with every row of others, a block of samples at a time."""

from __future__ import annotations

import numpy as np
from numba import config

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.lanes import (
    WIDEST,
    WIDTH,
    Quad,
    address,
    alive,
    load_widest,
    plus_product,
    spread_widest,
    store,
)
from lostmotion.kernels.no_literal import no_literal
from lostmotion.kernels.numba_cache import njit


@njit(nogil=True, forceinline=True)
def _add_four(sums: FloatArray, at: int, s0: Quad, s1: Quad, s2: Quad, s3: Quad) -> None:
    one = spread_widest(1.0)
    store(sums, at, plus_product(load_widest(sums, at), one, s0))
    store(sums, at + WIDEST, plus_product(load_widest(sums, at + WIDEST), one, s1))
    store(sums, at + 2 * WIDEST, plus_product(load_widest(sums, at + 2 * WIDEST), one, s2))
    store(sums, at + 3 * WIDEST, plus_product(load_widest(sums, at + 3 * WIDEST), one, s3))


@njit(nogil=True)
def _four_by_four(
    ahead: FloatArray, single: IntArray, i: int, final: int, r0: int, r1: int, r2: int, r3: int, m: int,
    rows: FloatArray, sums: FloatArray, at: int, width: int,
) -> None:  # fmt: skip
    """Add the products of four rows, from the i-th on and none behind the final one, with those that begin at r0 to r3.

    The former are in `ahead`, the latter in `rows`. Of every four rows the sums are `width` floats further on.
    """
    p0, p1, p2, p3 = single[i], single[min(i + 1, final)], single[min(i + 2, final)], single[min(i + 3, final)]
    a0 = a1 = a2 = a3 = b0 = b1 = b2 = b3 = spread_widest(0.0)
    c0 = c1 = c2 = c3 = d0 = d1 = d2 = d3 = spread_widest(0.0)
    for k in range(0, m, WIDEST):
        w, x = load_widest(ahead, p0 + k), load_widest(ahead, p1 + k)
        y, z = load_widest(ahead, p2 + k), load_widest(ahead, p3 + k)
        v = load_widest(rows, r0 + k)
        a0, b0 = plus_product(a0, w, v), plus_product(b0, x, v)
        c0, d0 = plus_product(c0, y, v), plus_product(d0, z, v)
        v = load_widest(rows, r1 + k)
        a1, b1 = plus_product(a1, w, v), plus_product(b1, x, v)
        c1, d1 = plus_product(c1, y, v), plus_product(d1, z, v)
        v = load_widest(rows, r2 + k)
        a2, b2 = plus_product(a2, w, v), plus_product(b2, x, v)
        c2, d2 = plus_product(c2, y, v), plus_product(d2, z, v)
        v = load_widest(rows, r3 + k)
        a3, b3 = plus_product(a3, w, v), plus_product(b3, x, v)
        c3, d3 = plus_product(c3, y, v), plus_product(d3, z, v)
    _add_four(sums, at, a0, a1, a2, a3)
    _add_four(sums, at + width, b0, b1, b2, b3)
    _add_four(sums, at + 2 * width, c0, c1, c2, c3)
    _add_four(sums, at + 3 * width, d0, d1, d2, d3)


@njit(nogil=True)
def _two_by_four(
    ahead: FloatArray, single: IntArray, i: int, final: int, r0: int, r1: int, r2: int, r3: int, m: int,
    rows: FloatArray, sums: FloatArray, at: int, width: int,
) -> None:  # fmt: skip
    """The same of two rows: where there are registers for no more."""
    p0, p1 = single[i], single[min(i + 1, final)]
    a0 = a1 = a2 = a3 = b0 = b1 = b2 = b3 = spread_widest(0.0)
    for k in range(0, m, WIDEST):
        w, x = load_widest(ahead, p0 + k), load_widest(ahead, p1 + k)
        v = load_widest(rows, r0 + k)
        a0, b0 = plus_product(a0, w, v), plus_product(b0, x, v)
        v = load_widest(rows, r1 + k)
        a1, b1 = plus_product(a1, w, v), plus_product(b1, x, v)
        v = load_widest(rows, r2 + k)
        a2, b2 = plus_product(a2, w, v), plus_product(b2, x, v)
        v = load_widest(rows, r3 + k)
        a3, b3 = plus_product(a3, w, v), plus_product(b3, x, v)
    _add_four(sums, at, a0, a1, a2, a3)
    _add_four(sums, at + width, b0, b1, b2, b3)


TOGETHER = 4 if WIDEST > WIDTH else 2
_tile = _four_by_four if WIDEST > WIDTH else _two_by_four


@njit(nogil=True)
def room(singles: int, lags: int) -> tuple[int, int, int]:
    """Shape of the sums of so many products."""
    return (singles + TOGETHER - 1) // TOGETHER * TOGETHER, (lags + 3) // 4 * 4, WIDEST


@njit(nogil=True)
def _add_tiles(
    ahead: FloatArray, single: IntArray, singles: int, last: int, lagged: IntArray, lags: int, begin: int, m: int,
    rows: FloatArray, parts: FloatArray,
) -> None:  # fmt: skip
    """Add the products of m samples; those of the others begin `begin` further on. `last` of the single rows exists."""
    sums, width = address(parts.reshape(-1)), parts.shape[1] * WIDEST
    for j in range(0, lags, 4):
        final = lagged.size - 1
        r0, r1 = lagged[j] + begin, lagged[min(j + 1, final)] + begin
        r2, r3 = lagged[min(j + 2, final)] + begin, lagged[min(j + 3, final)] + begin
        for i in range(0, singles, TOGETHER):
            _tile(ahead, single, i, last, r0, r1, r2, r3, m, rows, sums, i * width + j * WIDEST, width)


@njit(nogil=True)
def _add_row_products(
    flat: FloatArray, single: IntArray, singles: int, lagged: IntArray, lags: int, m: int, parts: FloatArray
) -> None:
    """Add the products of the first `singles` rows with the first `lags` others, m long; what follows these is zero.

    `single` and `lagged` are where they begin. `parts` (of the shape ``room``) are sums over every fourth or eighth
    sample. Behind m samples as many are read, and must be finite.
    """
    rows, one, whole = address(flat), address(single), m // WIDEST * WIDEST
    _add_tiles(rows, one, singles, single.size - 1, lagged, lags, no_literal(0), whole, rows, parts)
    if whole < m:
        last, places = np.zeros(single.size * WIDEST), np.arange(0, single.size * WIDEST, WIDEST)
        for i in range(single.size):
            for k in range(m - whole):
                last[i * WIDEST + k] = flat[single[i] + whole + k]
        few = no_literal(WIDEST)
        _add_tiles(address(last), address(places), singles, single.size - 1, lagged, lags, whole, few, rows, parts)
        alive((last, places))


def _add_row_products_plain(
    flat: FloatArray, single: IntArray, singles: int, lagged: IntArray, lags: int, m: int, parts: FloatArray
) -> None:
    ahead = np.stack([flat[at : at + m] for at in single[:singles]])
    parts[:singles, :lags, 0] += ahead @ np.stack([flat[at : at + m] for at in lagged[:lags]]).T


add_row_products = _add_row_products_plain if config.DISABLE_JIT else _add_row_products  # type: ignore[attr-defined]


@njit(nogil=True)
def added_up(parts: FloatArray, singles: int, lags: int) -> FloatArray:
    """The sums of each product, added up, (singles, lags)."""
    found = np.empty((singles, lags))
    for i in range(singles):
        for j in range(lags):
            value = parts[i, j, 0]
            for part in range(1, WIDEST):
                value += parts[i, j, part]
            found[i, j] = value
    return found
