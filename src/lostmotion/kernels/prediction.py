"""Errors of a prediction from nearest neighbours: small where the past of a signal tells its future."""

from __future__ import annotations

import numpy as np
from numba import njit

from lostmotion.arrays import FloatArray


@njit(cache=True, nogil=True)
def prediction_error(x: FloatArray, lags: int, neighbours: int, ahead: int) -> float:
    """Mean square error of predicting x `ahead` samples after a pattern of `lags` from the most similar patterns.

    The mean of what followed the `neighbours` nearest patterns is the prediction; patterns nearer than `lags` in time
    are not used. Distances go down the diagonals: from one pair of patterns to the next, one square is added and one
    taken away.
    """
    rows = x.size - lags - ahead + 1
    near = np.full((rows, neighbours), np.inf)
    told = np.zeros((rows, neighbours))
    for apart in range(lags, rows):
        distance = 0.0
        for k in range(lags):
            distance += (x[k] - x[k + apart]) ** 2
        for i in range(rows - apart):
            j = i + apart
            if i > 0:
                distance += (x[i + lags - 1] - x[j + lags - 1]) ** 2 - (x[i - 1] - x[j - 1]) ** 2
            if distance < near[i, neighbours - 1]:
                _insert(near[i], told[i], distance, x[j + lags + ahead - 1])
            if distance < near[j, neighbours - 1]:
                _insert(near[j], told[j], distance, x[i + lags + ahead - 1])
    total = 0.0
    for i in range(rows):
        mean = 0.0
        for k in range(neighbours):
            mean += told[i, k]
        total += (mean / neighbours - x[i + lags + ahead - 1]) ** 2
    return total / rows


@njit(cache=True, nogil=True)
def _insert(near: FloatArray, told: FloatArray, distance: float, future: float) -> None:
    """Keep the row of distances ascending."""
    k = near.size - 1
    while k > 0 and near[k - 1] > distance:
        near[k] = near[k - 1]
        told[k] = told[k - 1]
        k -= 1
    near[k] = distance
    told[k] = future
