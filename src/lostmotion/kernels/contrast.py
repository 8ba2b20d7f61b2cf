"""Variance of contrasts of the break points from the Fisher information of one test: what the test design minimises."""

from __future__ import annotations

import numpy as np
from numba import njit

from lostmotion.kernels import dead_zone, likelihood
from lostmotion.kernels.types import FloatArray

RIDGE = 1e-12  # relative; keeps the solution finite where a direction has no information at all


@njit(cache=True)
def variances(
    theta: FloatArray,
    na: int,
    nb: int,
    p: int,
    delay: int,
    u: FloatArray,
    y: FloatArray,
    with_noise: bool,
    noise_variance: float,
    prior: FloatArray,
    contrasts: FloatArray,
) -> FloatArray:
    """Variance of each row of `contrasts` (t, 2) in (left, right), everything else unknown, shape (t,).

    `theta` is ordered as in :mod:`lostmotion.kernels.likelihood`. `prior` (3,) holds the information about left, right
    and the logarithm of the slope ratio before the test. Without `with_noise` (open loop) the noise model is
    independent of the rest, and y is not looked at.
    """
    eta = na + nb + 2
    x, dx = np.empty(u.size), np.empty((3, u.size))
    dead_zone.sensitivities(u, theta[eta], theta[eta + 1], theta[eta + 2], x, dx)
    full, gradient = np.zeros((theta.size, theta.size)), np.zeros(theta.size)
    segments = np.zeros((1, 2), dtype=np.int64)
    segments[0, 1] = u.size
    likelihood.normal_equations(theta, na, nb, 3, p, delay, delay, segments, x, dx, y, full, gradient)
    dropped = 0 if with_noise else p
    size = theta.size - dropped
    information = np.empty((size, size))
    for i in range(size):
        for j in range(size):
            row, column = i + (dropped if i >= eta + 3 else 0), j + (dropped if j >= eta + 3 else 0)
            information[i, j] = full[row, column] / noise_variance
    for i in range(3):
        information[eta + i, eta + i] += prior[i]
    return _contrast_variances(information, eta, contrasts)


@njit(cache=True)
def _contrast_variances(information: FloatArray, at: int, contrasts: FloatArray) -> FloatArray:
    """Variance of each contrast by Cholesky of the scaled information; infinite where it has no root."""
    size = information.shape[0]
    scale = np.ones(size)
    for i in range(size):
        if information[i, i] > 0.0:
            scale[i] = np.sqrt(information[i, i])
    root = np.zeros((size, size))
    for i in range(size):
        for j in range(i + 1):
            value = information[i, j] / (scale[i] * scale[j])
            if i == j:
                value += RIDGE
            for k in range(j):
                value -= root[i, k] * root[j, k]
            if i == j:
                if not value > 0.0:
                    return np.full(contrasts.shape[0], np.inf)
                root[i, i] = np.sqrt(value)
            else:
                root[i, j] = value / root[j, j]
    result = np.zeros(contrasts.shape[0])
    part = np.zeros(size)
    for c in range(contrasts.shape[0]):
        for i in range(size):
            value = contrasts[c, i - at] / scale[i] if at <= i < at + 2 else 0.0
            for k in range(i):
                value -= root[i, k] * part[k]
            part[i] = value / root[i, i]
            result[c] += part[i] * part[i]
    return result
