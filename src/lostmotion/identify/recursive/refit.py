"""A stretch of stored samples fitted again, with what older samples say as a prior."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.recursive.remembered import NONE, Memory, Prior, Refit, Stretch
from lostmotion.kernels.linear import is_stable
from lostmotion.kernels.recursive_ml import state as ml
from lostmotion.kernels.recursive_ml.bounds import HALVINGS, RADIUS, calm
from lostmotion.kernels.recursive_ml.equations import RIDGE

MOST_STEPS = 12  # bounds the work of an alarm: six kinds of change are fitted, each twice
GAINED = 1e-3  # of a unit of log-likelihood: a step that gains less was the last


def fit_again(memory: Memory, stretch: Stretch, prior: Prior, start: FloatArray, variance: float) -> Refit:
    """Gauss-Newton with halved steps on a stretch plus the prior, first with all errors at full weight."""
    refit = memory.replay(stretch, start, np.inf)
    for limit in (np.inf, memory.state[ml.CLIP] * np.sqrt(variance)):
        refit = memory.replay(stretch, refit.theta, limit)
        for _ in range(MOST_STEPS):
            better = _better(memory, stretch, prior, refit, limit)
            if better is None:
                break
            gained = refit.cost + prior.cost(refit.theta) - better.cost - prior.cost(better.theta)
            refit = better
            if gained < GAINED * variance:
                break
    return refit


def _better(memory: Memory, stretch: Stretch, prior: Prior, refit: Refit, limit: float) -> Refit | None:
    """One Gauss-Newton step, halved while it does not help or A would be unstable; None: no step helps."""
    h = refit.h.sum(axis=0)
    total = prior.h + h
    gradient = prior.h @ (prior.centre - refit.theta) + refit.r.sum(axis=0) - h @ refit.theta
    scale = np.sqrt(np.maximum(np.diag(total), NONE))
    ridge = total / np.outer(scale, scale) + RIDGE * np.eye(scale.size)
    step = np.linalg.solve(ridge, gradient / scale) / scale
    before = refit.cost + prior.cost(refit.theta)
    for _ in range(HALVINGS):
        theta = valid(memory, refit.theta + step)
        if is_stable(np.ascontiguousarray(theta[: memory.na]), RADIUS):
            trial = memory.replay(stretch, theta, limit)
            if trial.cost + prior.cost(theta) < before:
                return trial
        step = 0.5 * step
    return None


def valid(memory: Memory, theta: FloatArray) -> FloatArray:
    """The same parameters within their bounds; A may be unstable still."""
    (low, high), eta, limit = memory.span, memory.eta, memory.state[ml.RATIO_LIMIT]
    result = theta.copy()
    if result[eta] > result[eta + 1]:
        result[eta : eta + 2] = 0.5 * (result[eta] + result[eta + 1])
    result[eta : eta + 2] = np.clip(result[eta : eta + 2], low, high)
    result[eta + 2] = np.clip(result[eta + 2], -limit, limit)
    calm(result[eta + 3 :], RADIUS)
    return result
