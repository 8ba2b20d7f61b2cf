"""filterpy's unscented Kalman filter on the joint state: 3 states of the process and 9 parameters.

Told: orders and delay, no offset, the variance of the noise, and (by trial on these data) how fast the assumed random
walk of the parameters dies away; a constant walk of 1e-10 or 3e-11 did a little worse, 1e-12 twice as badly. Start:
generic (common.py) with prior deviations of 0.3 for a, 0.1 for b, 0.5 for the break points.
"""

from __future__ import annotations

import math

import numpy as np
from common import DELAY, NA, START_A, START_B, START_ZONE, Array, Found, hammerstein, lag
from filterpy.kalman import MerweScaledSigmaPoints, UnscentedKalmanFilter

VARIANCE = 0.03
PRIOR = np.array([0.1] * 3 + [0.1] * 3 + [0.01] * 3 + [0.25, 0.25, 0.1])
WALK = np.array([1.0] * 3 + [0.01] * 3 + [1.0] * 3)  # of a, b, zone: relative sizes
SIZE = len(PRIOR)


def move(state: Array, _: float, u: float) -> Array:
    """Observer form; plain floats, which are faster than arrays here."""
    s1, s2, s3, a1, a2, a3, b0, b1, b2, left, right, log_ratio = state.tolist()
    x = u - right if u > right else 0.0
    if u < left:
        x += math.exp(log_ratio) * (u - left)
    moved = state.copy()
    moved[0], moved[1], moved[2] = s2 - a1 * s1 + b0 * x, s3 - a2 * s1 + b1 * x, b2 * x - a3 * s1
    return moved


def fit(u: Array, y: Array) -> Found:
    points = MerweScaledSigmaPoints(SIZE, alpha=0.1, beta=2.0, kappa=0.0)
    filt = UnscentedKalmanFilter(SIZE, 1, 1.0, hx=lambda state: state[:1], fx=move, points=points)
    filt.x = np.array([0.0] * 3 + [*START_A, *START_B, *START_ZONE])
    filt.P, filt.R = np.diag(PRIOR), np.array([[VARIANCE]])
    filt.Q = 1e-8 * np.eye(SIZE)
    walk = np.arange(3, SIZE), np.arange(3, SIZE)
    for k, delayed in enumerate(lag(u, DELAY).tolist()):
        filt.Q[walk] = 1e-3 / (k + 100.0) ** 2 * WALK
        filt.predict(u=delayed)
        filt.update(y[k : k + 1])
        filt.P = 0.5 * (filt.P + filt.P.T)
    theta = filt.x[3:]
    return hammerstein(theta[:NA], theta[NA:-3], *theta[-3:])
