"""Variance of contrasts of the break points from the Fisher information of one test: what the test design minimises."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.kernels import dead_zone
from lostmotion.kernels.normal_equations import normal_equations
from lostmotion.kernels.numba_cache import njit

RIDGE = 1e-12  # relative; keeps the solution finite where a direction has no information at all


@njit()
def variances(
    theta: FloatArray,
    na: int,
    nb: int,
    p: int,
    delay: int,
    load: bool,
    u: FloatArray,
    y: FloatArray,
    noise_variance: float,
    basis: FloatArray,
    prior: FloatArray,
    contrasts: FloatArray,
) -> FloatArray:
    """Variance of each row of `contrasts` (t, 2) in (left, right), everything else unknown, shape (t,).

    `theta` is ordered as in :mod:`lostmotion.kernels.likelihood`, with a constant behind the actuator as fourth
    parameter of it where there is a `load`. `prior` (3,) holds the information about left, right and the logarithm of
    the slope ratio before the test. The columns of `basis` (theta.size, free) are what is unknown; where they leave
    the noise model out (open loop, where it is independent of the rest), y does not matter.
    """
    eta = na + nb + 2
    parameters = 4 if load else 3
    x, dx = np.empty(u.size), np.empty((parameters, u.size))
    dead_zone.sensitivities(u, theta[eta], theta[eta + 1], theta[eta + 2], x, dx[:3])
    if load:
        x += theta[eta + 3]
        dx[3] = 1.0
    full, gradient = np.zeros((theta.size, theta.size)), np.zeros(theta.size)
    segments = np.zeros((1, 2), dtype=np.int64)
    segments[0, 1] = u.size
    normal_equations(theta, na, nb, parameters, p, delay, delay, segments, x, dx, dx[:0], y, full, gradient)
    full /= noise_variance
    for i in range(3):
        full[eta + i, eta + i] += prior[i]
    information = np.dot(np.dot(basis.T, full), basis)
    directions = np.ascontiguousarray(np.dot(contrasts, basis[eta : eta + 2]))
    return _contrast_variances(information, directions)


@njit()
def _contrast_variances(information: FloatArray, contrasts: FloatArray) -> FloatArray:
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
            value = contrasts[c, i] / scale[i]
            for k in range(i):
                value -= root[i, k] * part[k]
            part[i] = value / root[i, i]
            result[c] += part[i] * part[i]
    return result
