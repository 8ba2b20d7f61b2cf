"""Maximum likelihood by Levenberg-Marquardt with exact gradients, from one start."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.likelihood.problem import Problem
from lostmotion.kernels import refinement as kernel
from lostmotion.kernels.products import damped_step

# a bound against wandering: a start from the grid is done in far fewer, and what is not counts as not converged
MOST_STEPS = 100
FIRST_DAMPING = 1e-4  # relative; the starts are good, so the first step is nearly a Newton step
LINEAR_DAMPING = 1e-10  # of parameters in which the errors are linear: a ridge
# times what the first step promises: of 512 refinements (of 2,341) that ended below their bound one was so far off
PLAINLY = 100.0
ROUNDING = 1e-28  # relative sum of squares below which the data are reproduced to rounding
_ADVANCE: Any = kernel.advance


@dataclass(frozen=True)
class LocalFit:
    """A local maximum of the likelihood."""

    theta: FloatArray
    cost: float
    hessian: FloatArray
    steps: int
    converged: bool


def refine(
    problem: Problem,
    theta: FloatArray,
    basis: FloatArray | None = None,
    most_steps: int = MOST_STEPS,
    tied: bool = False,
    bound: float = np.inf,
    target: float = -np.inf,
    tolerance: float = 0.0,
) -> LocalFit:
    """Minimise the sum of squared prediction errors from `theta` over theta + span(basis) (default: the problem's).

    Given up after the first step where it is plain that it does not end below `bound`, and done where it has reached
    `target`, or where a step, or ten together, gain less than `tolerance` variances.

    Steps that make A unstable are refused like steps uphill; actuator parameters are projected on their valid
    set (unless the basis ties them together). Columns are scaled by their norm, so the damping is free of units
    (More, 1978).
    """
    basis = problem.basis if basis is None else basis
    if not tied:
        theta = problem.project(theta)
    inner = problem.internal(theta)
    cost, gradient, hessian = problem.evaluate(theta, inner)
    still = _is_still(problem, basis, tied)
    basis = np.empty((theta.size, 0)) if basis is None else np.ascontiguousarray(basis)
    normal, points = stacked(hessian, gradient), np.empty((2, theta.size))
    points[:] = theta
    model = kernel.projected(normal, basis)
    errors, floor = max(problem.errors - model.shape[1], 1), ROUNDING * float(problem.y @ problem.y)
    numbers = np.array([cost, FIRST_DAMPING, 0.0, errors, floor, bound, target, tolerance])
    counts = np.array([0, most_steps, 0, 0, most_steps > 0, still])
    own = points, normal, model, basis, np.full(most_steps + 1, cost), numbers, counts, *problem.rules, *problem.layout
    known = problem.courses, problem.target, problem.structure.zero, problem.early, problem.scale
    _ADVANCE(*own, *inner, *known)
    while counts[kernel.TRYING]:
        if not tied:
            points[1] = problem.project(points[1])
        _ADVANCE(*own, *problem.internal(points[1]), *known)
    best, found = points[0].copy(), float(numbers[kernel.COST])
    problem.keep(best, (found, normal[-1], normal[:-1]))
    return LocalFit(best, found, normal[:-1], int(counts[kernel.STEPS]), bool(counts[kernel.CONVERGED]))


def _is_still(problem: Problem, basis: FloatArray | None, tied: bool) -> bool:
    """Whether the actuator, and what acts beside it, stay as they are."""
    eta = slice(problem.eta_at, problem.noise_at)
    if eta.start == eta.stop:
        return True
    return basis is not None and tied and not basis[eta].any()


def settled(problem: Problem, theta: FloatArray, basis: FloatArray | None = None) -> FloatArray:
    """The vector with the best B, offset or load, and initial states: the errors are linear in these.

    Over theta + span(basis) (default: the problem's).

    Without them an integrating process starts so far off that its first steps go anywhere.
    """
    columns = linear_columns(problem, problem.basis if basis is None else basis)[1]
    theta, own = problem.project(theta), problem.own
    moved = theta.copy()
    if columns[own.start : own.stop].any():  # the actuator is tied to what is linear
        _, gradient, hessian = problem.evaluate(theta)
        moved += linear_step(hessian, gradient, columns)
    else:
        gradient, hessian = problem.evaluate_beside(theta)
        moved[problem.others] += linear_step(hessian, gradient, columns[problem.others])
    return moved if problem.admissible(moved) else theta


def is_hopeless(problem: Problem, theta: FloatArray, basis: FloatArray | None, bound: float) -> bool:
    """Whether it is plain that a refinement from ``settled`` does not end below a sum of squares `bound`.

    The linear part of the way is known; what the rest promises is not near what is missing.
    """
    cost, gradient, hessian = problem.evaluate(theta)
    normal, basis = stacked(hessian, gradient), problem.basis if basis is None else basis
    model = kernel.projected(normal, np.empty((theta.size, 0)) if basis is None else np.ascontiguousarray(basis))
    linear = kernel.projected(normal, np.ascontiguousarray(linear_columns(problem, basis)[1]))
    known = damped_step(linear[:-1], linear[-1], LINEAR_DAMPING)[1]
    promised = damped_step(model[:-1], model[-1], kernel.UNDAMPED)[1] - known
    return bool(cost - known - bound > PLAINLY * promised > 0.0)


def with_states(problem: Problem, theta: FloatArray, also: Sequence[int] = ()) -> FloatArray:
    """The vector with the best initial states, and parameters `also` in which the errors are linear."""
    columns = np.eye(problem.size)[:, [*range(problem.initial_at, problem.size), *also]]
    _, gradient, hessian = problem.evaluate(theta)
    return theta + linear_step(hessian, gradient, columns)


def stacked(hessian: FloatArray, gradient: FloatArray) -> FloatArray:
    """J'J and below it J'e, (n + 1, n)."""
    normal = np.empty((gradient.size + 1, gradient.size))
    normal[:-1], normal[-1] = hessian, gradient
    return normal


def linear_columns(problem: Problem, basis: FloatArray | None) -> tuple[list[int], FloatArray]:
    """Indices of the parameters in which the errors are linear, and the free directions (size, free) with one of them.

    These are B, the offset, the sizes of what acts beside the actuator, and the initial states.
    """
    free = np.eye(problem.size) if basis is None else basis
    linear = [*range(problem.structure.na, problem.eta_at), *range(problem.own.stop, problem.noise_at)]
    linear += range(problem.initial_at, problem.size)
    return linear, free[:, free[linear].any(axis=0)]


def linear_step(hessian: FloatArray, gradient: FloatArray, columns: FloatArray) -> FloatArray:
    """To the least sum of squares along these directions, from the normal equations."""
    if not columns.size:  # nothing to move along: no process and no noise of any order
        return np.zeros(len(columns))
    model = kernel.projected(stacked(hessian, gradient), np.ascontiguousarray(columns))
    return np.asarray(columns @ damped_step(model[:-1], model[-1], LINEAR_DAMPING)[0])
