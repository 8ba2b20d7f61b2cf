"""Maximum likelihood by Levenberg-Marquardt with exact gradients, from one start."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.likelihood.problem import Inner, Problem
from lostmotion.kernels import products as kernel

# a bound against wandering: a start from the grid is done in far fewer, and what is not counts as not converged
MOST_STEPS = 100
FIRST_DAMPING = 1e-4  # relative; the starts are good, so the first step is nearly a Newton step
LINEAR_DAMPING = 1e-10  # of parameters in which the errors are linear: a ridge
STEP_GAIN = 1e-4  # stop when a step promises less than this much of a unit of log-likelihood
STALL, STALL_GAIN = 10, 0.01  # or when ten steps together gained so little: the likelihood has kinks to zigzag on
# times the promise of an undamped step: a bound further off is not reached. Of 2,111 refinements that had a bound those
# given up so would all have ended above it, also with 5 times; with 3 times one would not
HOPELESS = 10.0
UNDAMPED = 1e-10  # relative, against singular equations
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
    problem: Problem,
    theta: FloatArray,
    basis: FloatArray | None = None,
    most_steps: int = MOST_STEPS,
    tied: bool = False,
    bound: float = np.inf,
) -> LocalFit:
    """Minimise the sum of squared prediction errors from `theta` over theta + span(basis) (default: the problem's).

    Given up after the first step where it is plain that it does not end below `bound`.

    Steps that make A unstable are refused like steps uphill; actuator parameters are projected on their valid
    set (unless the basis ties them together). Columns are scaled by their norm, so the damping is free of units
    (More, 1978).
    """
    basis = problem.basis if basis is None else basis
    if not tied:
        theta = problem.project(theta)
    inside = _Inside(problem)
    cost, gradient, hessian = problem.evaluate(theta, inside.at)
    free = theta.size if basis is None else basis.shape[1]
    floor = ROUNDING * float(problem.y @ problem.y)
    damping, converged, steps, uphill, errors = FIRST_DAMPING, False, 0, False, max(problem.errors - free, 1)
    history = [cost]
    model = _projected(hessian, gradient, basis)
    while steps < most_steps and not converged:
        steps += 1
        step, promised = _damped_step(model, basis, damping)
        variance = cost / errors
        if cost <= floor or promised <= STEP_GAIN * variance:
            converged = True
            break
        if steps > 1 and _out_of_reach(cost - bound, promised, model):
            break
        trial = theta + step
        if not tied:
            trial = problem.project(trial)
        better = False
        # a step uphill needs no gradient, and where one was others will be
        if problem.admissible(trial) and (not uphill or problem.squares(trial, inside.at(trial)[0]) < cost):
            trial_cost, trial_gradient, trial_hessian = problem.evaluate(trial, inside.at)
            better = trial_cost < cost
        uphill = uphill or not better
        if better:
            gained = cost - trial_cost
            converged = gained <= STEP_GAIN * variance and damping < 1e-2
            theta, cost, hessian = trial, trial_cost, trial_hessian
            model = _projected(hessian, trial_gradient, basis)
            damping = max(damping * (0.1 if gained > 0.5 * promised else 0.5), 1e-12)
        else:
            damping *= 8.0
            converged = damping > 1e10
        history.append(cost)
        stalled = steps > STALL and history[-1 - STALL] - cost <= STALL_GAIN * variance
        converged = converged or stalled
    return LocalFit(theta, cost, hessian, steps, converged)


def settled(problem: Problem, theta: FloatArray, basis: FloatArray | None = None) -> FloatArray:
    """The vector with the best B, offset or load, and initial states: the errors are linear in these.

    Over theta + span(basis) (default: the problem's).

    Without them an integrating process starts so far off that its first steps go anywhere.
    """
    columns = linear_columns(problem, problem.basis if basis is None else basis)[1]
    theta = problem.project(theta)
    _, gradient, hessian = problem.evaluate(theta)
    moved = theta + linear_step(hessian, gradient, columns)
    return moved if problem.admissible(moved) else theta


def with_states(problem: Problem, theta: FloatArray, also: Sequence[int] = ()) -> FloatArray:
    """The vector with the best initial states, and parameters `also` in which the errors are linear."""
    columns = np.eye(problem.size)[:, [*range(problem.initial_at, problem.size), *also]]
    _, gradient, hessian = problem.evaluate(theta)
    return theta + linear_step(hessian, gradient, columns)


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
    return _damped_step(_projected(hessian, gradient, columns), columns, LINEAR_DAMPING)[0]


class _Inside:
    """What the actuator does; of the last actuator it is kept, as many refinements hold theirs."""

    def __init__(self, problem: Problem) -> None:
        self._problem, self._key = problem, b""
        self._inner: Inner | None = None

    def at(self, theta: FloatArray) -> Inner:
        """Internal variable and its derivatives."""
        key = theta[self._problem.eta_at : self._problem.noise_at].tobytes()
        if self._inner is None or key != self._key:
            self._key, self._inner = key, self._problem.internal(theta)
        return self._inner


def _out_of_reach(gap: float, promised: float, model: tuple[FloatArray, FloatArray]) -> bool:
    """Whether the cost will not fall by `gap`; what a damped step promises is looked at first."""
    return gap > HOPELESS * promised and gap > HOPELESS * float(kernel.damped_step(*model, UNDAMPED)[1])


def _projected(hessian: FloatArray, gradient: FloatArray, basis: FloatArray | None) -> tuple[FloatArray, FloatArray]:
    """Normal equations of the free directions."""
    return (hessian, gradient) if basis is None else (basis.T @ hessian @ basis, basis.T @ gradient)


def _damped_step(
    model: tuple[FloatArray, FloatArray], basis: FloatArray | None, damping: float
) -> tuple[FloatArray, float]:
    """Marquardt step and the decrease of the sum of squares that the quadratic model promises."""
    step, promised = kernel.damped_step(model[0], model[1], damping)
    return (step if basis is None else basis @ step), promised
