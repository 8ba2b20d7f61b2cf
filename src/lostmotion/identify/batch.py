"""Maximum likelihood by Levenberg-Marquardt with exact gradients, from one start."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lostmotion.identify.problem import Problem
from lostmotion.models._arguments import FloatArray

MOST_STEPS = 100
STEP_GAIN = 1e-4  # stop when a step promises less than this much of a unit of log-likelihood
ROUNDING = 1e-28  # relative sum of squares below which the data are reproduced to rounding


@dataclass(frozen=True)
class LocalFit:
    """A local maximum of the likelihood."""

    theta: FloatArray
    cost: float
    hessian: FloatArray
    steps: int
    converged: bool


def refine(
    problem: Problem, theta: FloatArray, free: npt.NDArray[np.bool_] | None = None, most_steps: int = MOST_STEPS
) -> LocalFit:
    """Minimise the sum of squared prediction errors from `theta` over its `free` entries (default all).

    Steps that make A unstable are refused like steps uphill; actuator parameters are projected on their valid
    set. Columns are scaled by their norm, so the damping is free of units (More, 1978).
    """
    index = np.flatnonzero(free) if free is not None else np.arange(theta.size)
    theta = problem.project(theta)
    cost, gradient, hessian = problem.evaluate(theta)
    floor = ROUNDING * float(problem.y @ problem.y)
    damping, converged, steps = 1e-3, False, 0
    while steps < most_steps and not converged:
        steps += 1
        step, promised = _damped_step(hessian, gradient, index, damping)
        variance = cost / max(problem.errors - index.size, 1)
        if cost <= floor or promised <= STEP_GAIN * variance:
            converged = True
            break
        trial = problem.project(theta + step)
        better = False
        if problem.admissible(trial):
            trial_cost, trial_gradient, trial_hessian = problem.evaluate(trial)
            better = trial_cost < cost
        if better:
            gained = cost - trial_cost
            converged = gained <= STEP_GAIN * variance and damping < 1e-2
            theta, cost, gradient, hessian = trial, trial_cost, trial_gradient, trial_hessian
            damping = max(damping * (0.1 if gained > 0.5 * promised else 0.5), 1e-12)
        else:
            damping *= 8.0
            converged = damping > 1e10
    return LocalFit(theta, cost, hessian, steps, converged)


def _damped_step(
    hessian: FloatArray, gradient: FloatArray, index: npt.NDArray[np.int64], damping: float
) -> tuple[FloatArray, float]:
    """Marquardt step and the decrease of the sum of squares that the quadratic model promises."""
    block = hessian[np.ix_(index, index)]
    scale = np.sqrt(np.diag(block))
    scale[scale == 0] = 1.0
    scaled = block / np.outer(scale, scale)
    slope = gradient[index] / scale
    damped = scaled + damping * np.eye(index.size)
    move = -np.linalg.solve(damped, slope)
    promised = float(-2.0 * slope @ move - move @ scaled @ move)
    step = np.zeros(gradient.size)
    step[index] = move / scale
    return step, promised
