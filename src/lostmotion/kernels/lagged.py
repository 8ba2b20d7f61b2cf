"""Gram matrices of lagged signals, exact and without building the lagged matrix."""

from __future__ import annotations

import numpy as np
from numba import njit

from lostmotion.arrays import FloatArray


@njit(cache=True)
def shift_gram(gram: FloatArray, signals: FloatArray, lags: int, start: int, stop: int) -> None:
    """Complete `gram` (m*lags, m*lags), ordered lag by lag, from its first block row and column.

    Entry (i, s), (j, t) is the sum over k in [start, stop) of s(k-i) t(k-j); moving both lags by one drops the
    last product and adds one in front.
    """
    m = signals.shape[1]
    for i in range(1, lags):
        for j in range(1, lags):
            for s in range(m):
                before_s = signals[start - i, s]
                after_s = signals[stop - i, s]
                for t in range(m):
                    gram[i * m + s, j * m + t] = (
                        gram[(i - 1) * m + s, (j - 1) * m + t]
                        + before_s * signals[start - j, t]
                        - after_s * signals[stop - j, t]
                    )


def lagged_gram(signals: FloatArray, lags: int, start: int, stop: int) -> FloatArray:
    """Sums over k in [start, stop) of s(k-i) t(k-j) for all signals s, t (n, m) and lags i, j < `lags`.

    Returns shape (m*lags, m*lags), ordered lag by lag.
    """
    m = signals.shape[1]
    gram = np.empty((m * lags, m * lags))
    head = signals[start:stop]
    for lag in range(lags):
        block = head.T @ signals[start - lag : stop - lag]
        gram[:m, lag * m : (lag + 1) * m] = block
        gram[lag * m : (lag + 1) * m, :m] = block.T
    shift_gram(gram, signals, lags, start, stop)
    return gram
