"""Least squares on the first 1, 2, .. columns of a table, from its normal equations."""

from __future__ import annotations

import numpy as np
from numba import config

from lostmotion.arrays import FloatArray
from lostmotion.kernels.numba_cache import njit


@njit(nogil=True)
def _nested(gram: FloatArray, right: FloatArray, gains: FloatArray, explained: FloatArray) -> bool:
    """Fill coefficients (n, n), row i those of i + 1 columns, and what they explain (n,).

    One Cholesky factor serves all orders: that of a leading block leads it. False: no positive definite `gram` (n, n).
    """
    n = right.size
    root, half, total = np.zeros((n, n)), np.zeros(n), 0.0
    for i in range(n):
        for j in range(i + 1):
            value = gram[i, j]
            for k in range(j):
                value -= root[i, k] * root[j, k]
            if j < i:
                root[i, j] = value / root[j, j]
            elif value > 0.0:
                root[i, i] = np.sqrt(value)
            else:
                return False
        value = right[i]
        for k in range(i):
            value -= root[i, k] * half[k]
        half[i] = value / root[i, i]
        total += half[i] * half[i]
        explained[i] = total
        for j in range(i, -1, -1):
            value = half[j]
            for k in range(j + 1, i + 1):
                value -= root[k, j] * gains[i, k]
            gains[i, j] = value / root[j, j]
    return True


def _nested_plain(gram: FloatArray, right: FloatArray, gains: FloatArray, explained: FloatArray) -> bool:
    """The same by a solution of each: as plain Python the loops would take ten times as long."""
    for order in range(1, right.size + 1):
        try:
            gains[order - 1, :order] = np.linalg.solve(gram[:order, :order], right[:order])
        except np.linalg.LinAlgError:  # exactly singular
            return False
        explained[order - 1] = gains[order - 1, :order] @ right[:order]
    return True


nested = _nested_plain if config.DISABLE_JIT else _nested  # type: ignore[attr-defined]
