"""Products of the lags of noise seen through several zeros at once: which of them it has."""

from __future__ import annotations

import numpy as np
from numba import config

from lostmotion.arrays import FloatArray
from lostmotion.kernels.lanes import WIDTH, address, less, load, over, plus_product, spread, store, times
from lostmotion.kernels.numba_cache import njit
from lostmotion.kernels.smoothed import smooth

AT_ONCE = 7  # lags whose sums stay in registers


@njit(nogil=True)
def _see_through(v: FloatArray, zeros: FloatArray, seen: FloatArray) -> None:
    """Fill `seen` (4 n,), sample by sample, with v / (1 - c q^-1) as if the first value had always been there."""
    share, out = less(spread(1.0), load(address(zeros), 0)), address(seen)
    value = spread(v[0])
    for k in range(v.size):
        value = plus_product(value, share, less(spread(v[k]), value))
        store(out, k * WIDTH, over(value, share))


@njit(nogil=True)
def _add_lags(seen: FloatArray, first: int, n: int, lags: int, out: FloatArray) -> None:
    """Fill `out` (lags, 4) with the sums over rows k in [first, n) of seen(k) seen(k - lag)."""
    of, sums, none, last = address(seen), address(out.reshape(-1)), spread(0.0), lags - 1
    for lag in range(0, lags, AT_ONCE):  # beyond the last lag it is summed up again
        i1, i2, i3 = min(lag + 1, last), min(lag + 2, last), min(lag + 3, last)
        i4, i5, i6 = min(lag + 4, last), min(lag + 5, last), min(lag + 6, last)
        s0, s1, s2, s3, s4, s5, s6 = none, none, none, none, none, none, none
        for k in range(first, n):
            now = load(of, k * WIDTH)
            s0, s1 = (
                plus_product(s0, now, load(of, (k - lag) * WIDTH)),
                plus_product(s1, now, load(of, (k - i1) * WIDTH)),
            )
            s2, s3 = (
                plus_product(s2, now, load(of, (k - i2) * WIDTH)),
                plus_product(s3, now, load(of, (k - i3) * WIDTH)),
            )
            s4, s5 = (
                plus_product(s4, now, load(of, (k - i4) * WIDTH)),
                plus_product(s5, now, load(of, (k - i5) * WIDTH)),
            )
            s6 = plus_product(s6, now, load(of, (k - i6) * WIDTH))
        store(sums, i6 * WIDTH, s6)
        store(sums, i5 * WIDTH, s5)
        store(sums, i4 * WIDTH, s4)
        store(sums, i3 * WIDTH, s3)
        store(sums, i2 * WIDTH, s2)
        store(sums, i1 * WIDTH, s1)
        store(sums, lag * WIDTH, s0)


@njit(nogil=True)
def _shift(seen: FloatArray, n: int, table: FloatArray) -> None:
    """Complete the upper half of `table` (lags, lags, 4) from its first row.

    Moving both lags by one drops the last product and adds one in front.
    """
    lags = table.shape[0]
    of, out, first = address(seen), address(table.reshape(-1)), lags - 1
    for i in range(1, lags):
        before, after = load(of, (first - i) * WIDTH), load(of, (n - i) * WIDTH)
        for j in range(i, lags):
            value = plus_product(load(out, ((i - 1) * lags + j - 1) * WIDTH), before, load(of, (first - j) * WIDTH))
            store(out, (i * lags + j) * WIDTH, less(value, times(after, load(of, (n - j) * WIDTH))))


@njit(nogil=True)
def _add_products_behind(v: FloatArray, zeros: FloatArray, grams: FloatArray) -> None:
    """Add the products of the lags 0, 1, .. of v seen through four `zeros` to `grams` (lags, lags, 4).

    Over rows with all lags.
    """
    lags, n = grams.shape[0], v.size
    seen, part = np.empty(WIDTH * n), np.empty((lags, lags, WIDTH))
    _see_through(v, zeros, seen)
    _add_lags(seen, lags - 1, n, lags, part[0])
    _shift(seen, n, part)  # by the address of an argument: that of an array which is not used again is that of nothing
    for i in range(lags):
        for j in range(i, lags):
            for lane in range(WIDTH):
                grams[i, j, lane] += part[i, j, lane]
                if j > i:
                    grams[j, i, lane] += part[i, j, lane]


def _add_products_behind_plain(v: FloatArray, zeros: FloatArray, grams: FloatArray) -> None:
    lags, seen = len(grams), np.empty(v.size)
    for lane, zero in enumerate(zeros):
        smooth(v, zero, np.array([[0, v.size]]), seen)
        lagged = np.stack([seen[lags - 1 - lag : v.size - lag] for lag in range(lags)]) / (1.0 - zero)
        grams[:, :, lane] += lagged @ lagged.T


add_products_behind = _add_products_behind_plain if config.DISABLE_JIT else _add_products_behind  # type: ignore[attr-defined]
