"""Dead zone, its inverse, and its derivatives by the complex step."""

import numpy as np

STEP = 1e-30


def dead_zone(u, left, right, left_slope, right_slope):
    """x of one u (paper, eq 4); parameters may be complex, u decides the branch by real parts."""
    if u > np.real(right):
        return right_slope * (u - right)
    if u < np.real(left):
        return left_slope * (u - left)
    return 0.0


def inverse(v, left, right, left_slope, right_slope, at_zero):
    """u that gives v (paper, eqs 8-11)."""
    if v == 0:
        return at_zero
    return v / right_slope + right if v > 0 else v / left_slope + left


def nearest_to_zero(left, right):
    """Point of [left, right] nearest to zero."""
    if left > 0:
        return left
    return right if right < 0 else 0.0


def actuator(eta, u):
    """x for right slope 1; eta = left, right, log(left slope), or empty for x = u."""
    if len(eta) == 0:
        return np.array(u, dtype=complex)
    left, right, log_ratio = eta
    return np.array([dead_zone(value, left, right, np.exp(log_ratio), 1.0) for value in u], dtype=complex)


def derivatives(eta, u):
    """dx/deta, shape (len(eta), n), by the complex step."""
    rows = []
    for i in range(len(eta)):
        moved = np.array(eta, dtype=complex)
        moved[i] += 1j * STEP
        rows.append(actuator(moved, u).imag / STEP)
    return np.array(rows) if rows else np.empty((0, len(u)))
