"""Covariance of a recursive estimate whose regressors were rebuilt with earlier estimates."""

from __future__ import annotations

import numpy as np
import scipy.linalg

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.recursive_iv import state as iv

NEAR = 0.25  # see `_recent`
ROUNDING = 1e-6  # relative negative eigenvalue of a covariance that is one still
ALIKE = 0.75  # share of the newest sample, 1/2 where one forgets for ever, 1 where all count alike


def covariance_of_theta(state: FloatArray, layout: IntArray, jacobian: FloatArray) -> FloatArray | None:
    """Covariance (n, n) of theta, None where the data do not tell.

    Parameters
    ----------
    state, layout : ndarray
        Of the kernel.
    jacobian : ndarray, shape (4, n)
        d zone / d theta.

    Notes
    -----
    With R = mean z phi', W = mean z (sum b dx/dzone)' and J = d zone/d theta the mean step of theta is
    -g R^-1 (R + W J) e for an error e, g the share of the newest sample: x(k-d-i) was rebuilt with the parameters of
    its time, so that what an error does to the later regressors is learnt by the recursion alone. The covariance of
    such a recursion solves a Lyapunov equation (Benveniste, Metivier and Priouret, *Adaptive Algorithms and
    Stochastic Approximations*, part I, chapter 3). With W = 0 it is the sandwich R^-1 S R^-T of Soderstrom and
    Stoica, *System Identification*, chapter 8. R comes from P; S, W and the noise from
    :mod:`lostmotion.kernels.recursive_iv.spread`.

    Where all samples count alike, what is wrong at the start goes no faster than 1/k, and is in none of that. It shows
    in how far theta has come since k0 = 2^m, k / 4 < k0 <= k / 2: an error that goes like 1/k moves by k / k0 - 1 times
    what is left of it, noise by the root of that times its standard error. The square over k / k0 - 1 is added.

    Where early samples are forgotten faster than 1/k, the present noise counts and not that of the start, when the
    model was poor. It is the geometric mean of two measures: the squared miss of the model's output is too large
    while A is inexact, the prediction error over 1 + sum a^2 too small under slow noise.
    """
    parts = iv.named(state, layout)
    p, n = parts["p"], parts["theta"].size
    total, total_squared, seen, seen_squared, squares, present, equation, since = state[iv.TOTAL : iv.SINCE + 1]
    if seen < n or not np.isfinite(p).all():
        return None
    with np.errstate(all="ignore"):
        feedback = total * since / seen * (p @ parts["rebuilt"])
        noise = total_squared * since**2 / seen_squared * (p @ parts["spread"] @ p.T)
        share = total_squared / total  # 1: all samples count alike; 1/2: constant forgetting
        decay = share * (np.eye(n) + feedback @ jacobian) + (0.5 - share) * np.eye(n)
        white = equation / (1.0 + np.sum(parts["theta"][: layout[iv.NA]] ** 2))
        level = np.sqrt(present * white) * seen_squared / squares if squares > 0 else 1.0
    if not all(np.isfinite(part).all() for part in (noise, decay, level)):
        return None
    try:
        if np.linalg.eigvals(decay).real.min() <= 0:  # the start is forgotten more slowly than noise is averaged
            return None
        sharper = np.eye(n) + (np.sqrt(level) - 1.0) * _recent(feedback, jacobian)
        covariance = scipy.linalg.solve_continuous_lyapunov(decay, sharper @ noise @ sharper.T)
        spread = np.sqrt(np.diag(covariance).clip(min=0.0))
        if not spread.all() or np.linalg.eigvalsh(covariance / np.outer(spread, spread))[0] < -ROUNDING:
            return None  # the regressors depend on each other, as with two levels of u: no covariance but rounding
    except (np.linalg.LinAlgError, ValueError):
        return None
    if share > ALIKE:
        covariance = covariance + _left_of_the_start(parts["theta"], parts["earlier"][0], int(layout[iv.COUNT]))
    return np.asarray(0.5 * (covariance + covariance.T))


def _left_of_the_start(theta: FloatArray, earlier: FloatArray, count: int) -> FloatArray:
    """Square of what is left of a wrong start; `earlier`: theta after the power of 2 before the last."""
    older = 2 ** (count.bit_length() - 2)
    moved = theta - earlier
    return np.asarray(np.outer(moved, moved) / (count / older - 1.0))


def _recent(feedback: FloatArray, jacobian: FloatArray) -> FloatArray:
    """Projection (n, n) on the directions that the feedback makes forget early samples, so that present noise counts.

    An eigenvalue of the feedback f counts by f^2 / (f^2 + NEAR^2).
    """
    small = jacobian @ feedback
    return feedback @ small @ np.linalg.pinv(small @ small + NEAR**2 * np.eye(len(small))) @ jacobian
