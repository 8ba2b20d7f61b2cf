"""Regressions on the lags of two signals, for many pairs of signals at once."""

from __future__ import annotations

import numpy as np
from numba import config

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.numba_cache import njit
from lostmotion.kernels.products import factorise, solve_behind

SMALLEST = np.finfo(np.float64).tiny


@njit(nogil=True, fastmath={"contract"})
def shifted(row: FloatArray, column: FloatArray, first: FloatArray, second: FloatArray, table: FloatArray) -> None:
    """Fill `table` (n, m) with products of lags, from those with a lag of 0 (`row` (m,), `column` (n,)).

    `first` (ends, n) and `second` (ends, m) hold the values that one lag more of both lets in, with the sign of their
    product in `first`: plus in front of the rows, minus at their end.
    """
    for j in range(row.size):
        table[0, j] = row[j]
    for i in range(1, column.size):
        table[i, 0] = column[i]
    for i in range(1, table.shape[0]):
        before, now = table[i - 1], table[i]
        for j in range(1, now.size):
            now[j] = before[j - 1]
        for end in range(first.shape[0]):
            weight, values = first[end, i], second[end]
            for j in range(1, now.size):
                now[j] += weight * values[j]


@njit(nogil=True, fastmath={"contract"})
def _without(table: FloatArray, first: FloatArray, second: FloatArray) -> None:
    """Take the products of `first` (k, n) and `second` (k, m) from `table` (n, m)."""
    for i in range(table.shape[0]):
        row = table[i]
        for k in range(first.shape[0]):
            weight, values = first[k, i], second[k]
            for j in range(row.size):
                row[j] -= weight * values[j]


def _without_plain(table: FloatArray, first: FloatArray, second: FloatArray) -> None:
    table -= first.T @ second


without = _without_plain if config.DISABLE_JIT else _without  # type: ignore[attr-defined]


@njit(nogil=True)
def regressions(
    own: FloatArray,
    mixed: FloatArray,
    drive: FloatArray,
    signs: FloatArray,
    past: FloatArray,
    cross: FloatArray,
    pairs: IntArray,
    ridge: float,
    uniform: bool,
    squares: FloatArray,
    gains: FloatArray,
) -> None:
    """Sums of squares that every pair explains, and its coefficients.

    Parameters
    ----------
    own : ndarray, shape (m, n, n)
        Products of the lags of every signal, the past taken away.
    mixed : ndarray, shape (2, p, n)
        Of the first of a pair at lag 0 with the second, and of the second at lag 0 with the first.
    drive : ndarray, shape (m, ends, n)
        Values of every signal at the ends of the rows, `signs` (ends,) as in ``shifted``.
    past : ndarray, shape (m, k, n)
        Products of the orthonormal past with the lags.
    cross : ndarray, shape (m, n)
        Of the target, the past taken away.
    ridge : float
        Share added to each diagonal: of its largest element where `uniform`, else of the element itself.
    squares : ndarray, shape (2, p)
        Filled: of both signals, and of their sum.
    gains : ndarray, shape (p, 2, n)
        Filled, of both signals.
    """
    n, ends = own.shape[1], signs.size
    table, both, whole = np.empty((n, n)), np.empty((n, n)), np.empty((2 * n, 2 * n))
    target, total, signed = np.empty(n), np.empty(2 * n), np.empty((ends, n))
    for p in range(pairs.shape[0]):
        s, t = pairs[p]
        first, second = own[s], own[t]
        for end in range(ends):
            for i in range(n):
                signed[end, i] = drive[t, end, i] * signs[end]
        # transposed: rows of the second
        shifted(mixed[1, p], mixed[0, p], signed, drive[s], table)
        without(table, past[t], past[s])
        for i in range(n):
            for j in range(i + 1):
                both[i, j] = first[i, j] + second[i, j] + table[i, j] + table[j, i]
                whole[i, j], whole[n + i, n + j] = first[i, j], second[i, j]
            for j in range(n):
                whole[n + i, j] = table[i, j]
            target[i], total[i], total[n + i] = cross[s, i] + cross[t, i], cross[s, i], cross[t, i]
        _add_ridge(both, ridge, uniform)
        _add_ridge(whole, ridge, uniform)
        squares[1, p] = factorise(both, target)
        squares[0, p] = factorise(whole, total)
        solve_behind(whole, total)
        for i in range(n):
            gains[p, 0, i], gains[p, 1, i] = total[i], total[n + i]


@njit(nogil=True)
def _add_ridge(gram: FloatArray, ridge: float, uniform: bool) -> None:
    largest = 0.0
    for i in range(gram.shape[0]):
        largest = max(largest, gram[i, i])
    for i in range(gram.shape[0]):
        gram[i, i] += ridge * ((largest if uniform else gram[i, i]) + SMALLEST)
