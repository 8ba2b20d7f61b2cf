"""Least squares with the weights of weighted null-space fitting, from the coefficients of a high-order ARX."""

from __future__ import annotations

import numpy as np
from numba import config

from lostmotion.arrays import FloatArray
from lostmotion.kernels.numba_cache import njit

FLOOR = 1e-9  # of the largest variance: nothing counts as told better than this
RANK = 1e-12  # relative size of a direction that is none


@njit(nogil=True)
def _spread(a: FloatArray, b: FloatArray, shift: int, covariance: FloatArray, outputs: int, rows: int) -> FloatArray:
    """Covariance (rows, rows) of A B_n - B A_n; see ``weighted``."""
    size = covariance.shape[0]
    half, found = np.empty((rows, size)), np.empty((rows, rows))
    for row in range(rows):
        for i in range(size):
            half[row, i] = covariance[outputs + row, i]
        for lag in range(min(a.size, row)):
            weight, other = a[lag], covariance[outputs + row - lag - 1]
            for i in range(size):
                half[row, i] += weight * other[i]
        for lag in range(min(b.size, row - shift)):
            weight, other = b[lag], covariance[row - shift - lag - 1]
            for i in range(size):
                half[row, i] -= weight * other[i]
    for row in range(rows):
        ahead, behind = half[row, outputs:], half[row]
        for column in range(row + 1):
            value = ahead[column]
            for lag in range(min(a.size, column)):
                value += a[lag] * ahead[column - lag - 1]
            for lag in range(min(b.size, column - shift)):
                value -= b[lag] * behind[column - shift - lag - 1]
            found[row, column] = found[column, row] = value
    return found


def _spread_plain(
    a: FloatArray, b: FloatArray, shift: int, covariance: FloatArray, outputs: int, rows: int
) -> FloatArray:
    transfer, at = np.zeros((rows, len(covariance))), np.arange(rows)
    for lag, value in enumerate([1.0, *a]):
        transfer[at[lag:], outputs + at[: max(rows - lag, 0)]] += value
    for lag, value in enumerate(b, shift + 1):
        transfer[at[lag:], at[: max(rows - lag, 0)]] -= value
    return np.asarray(transfer @ covariance @ transfer.T)


spread = _spread_plain if config.DISABLE_JIT else _spread  # type: ignore[attr-defined]


@njit(nogil=True, inline="always")
def _energy(values: FloatArray) -> float:
    total = 0.0
    for value in values:
        total += value * value
    return total


@njit(nogil=True, inline="always")
def _solved(table: FloatArray) -> tuple[FloatArray, float]:
    """Least squares of the last row (m,) of `table` (p + 1, m) by those before it, and what is left; orthogonalised."""
    p, m = table.shape[0] - 1, table.shape[1]
    upper, found, left = np.zeros((p + 1, p + 1)), np.zeros(p), 0.0
    for row in range(p + 1):
        before = _energy(table[row])
        for other in range(row):
            if upper[other, other] > 0.0:
                share = 0.0
                for i in range(m):
                    share += table[other, i] * table[row, i]
                for i in range(m):
                    table[row, i] -= share * table[other, i]
                upper[other, row] = share
        left = _energy(table[row])
        if left > RANK * RANK * before:  # else it depends on the others
            upper[row, row] = np.sqrt(left)
            for i in range(m):
                table[row, i] /= upper[row, row]
    for row in range(p - 1, -1, -1):
        if upper[row, row] > 0.0:
            value = upper[row, p]
            for other in range(row + 1, p):
                value -= upper[row, other] * found[other]
            found[row] = value / upper[row, row]
    return found, left


@njit(nogil=True)
def weighted(
    a: FloatArray,
    b: FloatArray,
    shift: int,
    covariance: FloatArray,
    outputs: int,
    regressors: FloatArray,
    target: FloatArray,
) -> tuple[FloatArray, float]:
    """Solution (p,) of least weighted squares of `regressors` (m, p) times it less `target` (m,), and these squares.

    The errors are those of A B_n - B A_n, where `covariance` is that of the coefficients of A_n, of which there are
    `outputs`, then of B_n; B is `shift` rows later than B_n.
    """
    (m, p), root = regressors.shape, spread(a, b, shift, covariance, outputs, regressors.shape[0])
    largest, white = 0.0, np.empty((p + 1, m))
    for row in range(m):
        for column in range(m):
            largest = max(largest, abs(root[row, column]))
        for column in range(p):
            white[column, row] = regressors[row, column]
        white[p, row] = target[row]
    floor = max(FLOOR * largest, 1e-300)
    least_root = np.sqrt(floor)
    for row in range(m):
        here = root[row]
        for column in range(row):
            other, value = root[column], here[column]
            for i in range(column):
                value -= here[i] * other[i]
            here[column] = value / other[column] if other[column] > least_root else 0.0
        least = here[row]
        for i in range(row):
            least -= here[i] * here[i]
        here[row] = np.sqrt(least) if least > floor else least_root  # rounding: the others hang on it no further
        for one in white:
            for i in range(row):
                one[row] -= here[i] * one[i]
            one[row] /= here[row]
    return _solved(white)
