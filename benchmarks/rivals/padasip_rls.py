"""padasip's ``FilterRLS``, two ways.

``fit_key_term``: the regressors of the paper (eq 23), so those of RecursiveIV with method="rls", and its forgetting
(eq 31: 0.995, growing towards 1 after 2,000 samples; a constant 1, 0.9999 or 0.9995 did worse). Told: orders, delay,
no offset, a break point on either side of 0. The x(k-d-i) are rebuilt with right slope 1, which only scales their b.

``fit_hinges``: what needs no rebuilt x. The input through 10 hinges with evenly spaced knots, 6 lags of each, and 8
past outputs, so 68 weights, without forgetting (3 to 15 past outputs and 4 to 14 knots were tried; fewer past outputs
are biased by the output noise, and few knots between the break points by their distance to them). The static
characteristic of the result is read back by the dead zone that is nearest to it. Told: delay, range of u, no offset.
"""

from __future__ import annotations

import time

import numpy as np
from common import DELAY, NA, NB, Array, Found, dead_zone, hammerstein, lag
from padasip.filters import FilterRLS
from scipy import optimize
from scipy.signal import lfilter

FIRST_WEIGHT = 1e-3  # padasip's eps; its inverse is the variance of the starting weights
FORGETTING, CONSTANT_FOR = 0.995, 2000
KNOTS, PAST_Y, LAGS = 10, 8, 6


def fit_key_term(u: Array, y: Array) -> Found:
    rls = FilterRLS(NA + NB + 4, mu=FORGETTING, eps=FIRST_WEIGHT, w="zeros")
    left, right, ratio = 0.0, 0.0, 1.0
    span = float(u.min()), float(u.max())
    past_y, past_x = [0.0] * NA, [0.0] * NB
    for k, delayed in enumerate(lag(u, DELAY).tolist()):
        over, under = float(delayed > right), float(delayed < left)
        zone = (over * delayed, -over, under * delayed, -under)
        rls.adapt(y[k], np.array([*(-value for value in past_y), *zone, *past_x]))
        if k >= CONSTANT_FOR:
            rls.mu = FORGETTING * rls.mu + 1.0 - FORGETTING
        x = over * (delayed - right) + ratio * under * (delayed - left)
        past_y, past_x = [y[k], *past_y[:-1]], [x, *past_x[:-1]]
        left, right, ratio = read_ratios(rls.w, (left, right, ratio), span)
    a, b = rls.w[:NA], np.r_[rls.w[NA], rls.w[NA + 4 :]]
    return hammerstein(a, b, left, right, np.log(ratio))


def read_ratios(w: Array, old: tuple[float, float, float], span: tuple[float, float]) -> tuple[float, float, float]:
    """Break points and slope ratio from the weights where they make sense, else the old ones."""
    over, over_knot, under, under_knot = w[NA : NA + 4]
    if over == 0.0 or under == 0.0:
        return old
    left, right, ratio = under_knot / under, over_knot / over, under / over
    return (
        left if span[0] < left <= 0.0 else old[0],
        right if 0.0 <= right < span[1] else old[1],
        ratio if 0.1 < ratio < 10.0 else old[2],
    )


def hinges(u: Array, knots: Array) -> Array:
    """One column a knot, bending outwards from zero."""
    beyond = u[:, None] - knots
    return np.where(knots > 0, np.maximum(beyond, 0.0), np.minimum(beyond, 0.0))


def fit_hinges(u: Array, y: Array) -> Found:
    knots = np.linspace(u.min(), u.max(), KNOTS + 2)[1:-1]
    columns = hinges(u, knots)
    past = [-lag(y, i + 1)[:, None] for i in range(PAST_Y)]
    regressors = np.hstack([*past, *(lag(columns, DELAY + i) for i in range(LAGS))])
    rls = FilterRLS(regressors.shape[1], mu=1.0, eps=FIRST_WEIGHT, w="zeros")
    rls.run(y, regressors)
    a, c = rls.w[:PAST_Y], rls.w[PAST_Y:].reshape(LAGS, -1)
    grid = np.linspace(u.min(), u.max(), 401)
    static = hinges(grid, knots) @ c.sum(axis=0) / (1.0 + a.sum())
    nearest = optimize.least_squares(lambda p: p[3] * dead_zone(grid, *p[:3]) - static, [-0.5, 0.5, 0.0, 1.0]).x

    def simulate(fresh: Array) -> Array:
        bent = hinges(fresh, knots)
        drive = sum(lag(bent, DELAY + i) @ c[i] for i in range(LAGS))
        return lfilter([1.0], np.r_[1.0, a], drive)

    return Found(nearest[0], nearest[1], float(np.exp(nearest[2])), simulate)


def seconds_per_step(u: Array, y: Array) -> float:
    """Of the filter alone, with as many prepared regressors as eq 23 has: the yardstick of the speed table."""
    rls = FilterRLS(NA + NB + 4, mu=1.0, eps=FIRST_WEIGHT, w="zeros")
    regressors = np.column_stack([lag(u, i) for i in range(NA + NB + 4)])
    rls.run(y[:100], regressors[:100])
    begin = time.process_time()
    rls.run(y, regressors)
    return (time.process_time() - begin) / len(u)
