"""``scipy.optimize.least_squares`` on the output error; gradients by differences.

Told: orders and delay, that there is no offset and that the noise is white. Start: generic (common.py).
"""

from __future__ import annotations

import numpy as np
from common import DELAY, NA, START_A, START_B, START_ZONE, Array, Found, dead_zone, hammerstein
from scipy import optimize
from scipy.signal import lfilter


def residuals(theta: Array, u: Array, y: Array) -> Array:
    a, b, zone = theta[:NA], theta[NA:-3], theta[-3:]
    return y - lfilter(np.r_[np.zeros(DELAY), b], np.r_[1.0, a], dead_zone(u, *zone))


def fit(u: Array, y: Array) -> Found:
    start = np.array([*START_A, *START_B, *START_ZONE])
    theta = optimize.least_squares(residuals, start, args=(u, y), x_scale="jac", max_nfev=200).x
    return hammerstein(theta[:NA], theta[NA:-3], *theta[-3:])
