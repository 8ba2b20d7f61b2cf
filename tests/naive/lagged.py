"""Gram matrix through the lagged matrix itself."""

import numpy as np


def lagged_matrix(signals, lags, start, stop):
    """One row for each k in [start, stop): all signals at k, then all at k-1, and so on."""
    return np.array([np.concatenate([signals[k - lag] for lag in range(lags)]) for k in range(start, stop)])


def lagged_gram(signals, lags, start, stop):
    """M'M of the lagged matrix M."""
    matrix = lagged_matrix(signals, lags, start, stop)
    return matrix.T @ matrix
