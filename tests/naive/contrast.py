"""Variance of contrasts of the break points: every derivative by the complex step, the information inverted at once."""

import numpy as np

from tests.naive.dead_zone import STEP, actuator
from tests.naive.likelihood import segment_errors


def errors(theta, na, nb, p, delay, load, u, y):
    """Prediction errors of one segment, from row `delay` on."""
    eta = na + nb + 2
    noise = eta + (4 if load else 3)
    x = actuator(theta[eta : eta + 3], u) + (theta[eta + 3] if load else 0.0)
    a, b, offset, d, c = theta[:na], theta[na : eta - 1], theta[eta - 1], theta[noise : noise + p], theta[noise + p :]
    return segment_errors(a, b, c, offset, d, delay, delay, x, y)[1]


def variances(theta, na, nb, p, delay, load, u, y, noise_variance, basis, prior, contrasts):
    """Variance of each contrast."""
    columns = []
    for i in range(len(theta)):
        moved = np.array(theta, dtype=complex)
        moved[i] += 1j * STEP
        columns.append(errors(moved, na, nb, p, delay, load, u, y).imag / STEP)
    jacobian = np.array(columns).T
    eta = na + nb + 2
    information = jacobian.T @ jacobian / noise_variance
    information[[eta, eta + 1, eta + 2], [eta, eta + 1, eta + 2]] += prior
    covariance = basis @ np.linalg.inv(basis.T @ information @ basis) @ basis.T
    block = covariance[eta : eta + 2, eta : eta + 2]
    return np.array([contrast @ block @ contrast for contrast in contrasts])
