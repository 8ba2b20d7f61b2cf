"""Regressions on the lags of two signals, for many pairs of signals at once."""

from __future__ import annotations

import numpy as np
from numba import config, njit

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.products import factorise, solve_behind

SMALLEST = np.finfo(np.float64).tiny


@njit(cache=True, nogil=True, fastmath={"contract"})
def shifted(row: FloatArray, column: FloatArray, first: FloatArray, second: FloatArray, table: FloatArray) -> None:
    """Fill `table` (n, m) with products of lags, from those with a lag of 0 (`row` (m,), `column` (n,)).

    `first` (ends, n) and `second` (ends, m) hold the values that one lag more of both lets in, with the sign of their
    product in `first`: plus in front of the rows, minus at their end.
    """
    table[0], table[1:, 0] = row, column[1:]
    for i in range(1, table.shape[0]):
        before, now = table[i - 1], table[i]
        now[1:] = before[: now.size - 1]
        for end in range(first.shape[0]):
            weight, values = first[end, i], second[end]
            for j in range(1, now.size):
                now[j] += weight * values[j]


@njit(cache=True, nogil=True, fastmath={"contract"})
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


@njit(cache=True, nogil=True)
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
    n = own.shape[1]
    table, both, whole = np.empty((n, n)), np.empty((n, n)), np.empty((2 * n, 2 * n))
    target, total = np.empty(n), np.empty(2 * n)
    for p in range(pairs.shape[0]):
        s, t = pairs[p]
        first, second = own[s], own[t]
        # transposed: rows of the second
        shifted(mixed[1, p], mixed[0, p], drive[t] * signs.reshape(-1, 1), drive[s], table)
        without(table, past[t], past[s])
        for i in range(n):
            for j in range(i + 1):
                both[i, j] = first[i, j] + second[i, j] + table[i, j] + table[j, i]
            whole[i, : i + 1], whole[n + i, :n], whole[n + i, n : n + i + 1] = (
                first[i, : i + 1],
                table[i],
                second[i, : i + 1],
            )
        target[:], total[:n], total[n:] = cross[s] + cross[t], cross[s], cross[t]
        _add_ridge(both, ridge, uniform)
        _add_ridge(whole, ridge, uniform)
        squares[1, p] = factorise(both, target)
        squares[0, p] = factorise(whole, total)
        solve_behind(whole, total)
        gains[p, 0], gains[p, 1] = total[:n], total[n:]


@njit(cache=True, nogil=True)
def _add_ridge(gram: FloatArray, ridge: float, uniform: bool) -> None:
    largest = 0.0
    for i in range(gram.shape[0]):
        largest = max(largest, gram[i, i])
    for i in range(gram.shape[0]):
        gram[i, i] += ridge * ((largest if uniform else gram[i, i]) + SMALLEST)
