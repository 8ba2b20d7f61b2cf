"""Steps of Levenberg-Marquardt on the sum of squared prediction errors, with the actuator left to the caller.

Where the actuator does not move all steps run in one call; where it does, each trial is handed back for its internal
variable. Normal equations of n parameters are a table (n + 1, n): J'J, and J'e as its last row.
"""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.linear import is_allowed
from lostmotion.kernels.normal_equations import normal_equations
from lostmotion.kernels.numba_cache import njit
from lostmotion.kernels.products import damped_step
from lostmotion.kernels.squared_errors import squared_errors

STEP_GAIN = 1e-4  # stop when a step promises less than this much of a unit of log-likelihood
STALL, STALL_GAIN = 10, 0.01  # or when ten steps together gained so little: the likelihood has kinks to zigzag on
SMOOTH = 1e-2  # damping below which a step promises all that there is
# times the promise of an undamped step: a bound further off is not reached. Of 2,111 refinements that had a bound those
# given up so would all have ended above it, also with 5 times; with 3 times one would not
HOPELESS = 10.0
# and times what the last ten steps gained: of 8,281 refinements of held sizes one would have got there
TOO_SLOW = 10.0
UNDAMPED = 1e-10  # relative, against singular equations
COST, DAMPING, PROMISED, ERRORS, FLOOR, BOUND, TARGET, TOLERANCE = range(8)  # floats of a refinement
STEPS, MOST, UPHILL, CONVERGED, TRYING, STILL = 0, 1, 2, 3, 4, 5  # integers of one


@njit()
def projected(normal: FloatArray, basis: FloatArray) -> FloatArray:
    """Normal equations of the directions `basis` (n, free), most of whose elements are 0; all where it is (n, 0)."""
    size, free = basis.shape
    if free == 0:
        return normal.copy()
    half, model = np.zeros((free, size)), np.zeros((free + 1, free))
    for column in range(free):
        for row in range(size):
            weight = basis[row, column]
            if weight != 0.0:
                for other in range(size):
                    half[column, other] += weight * normal[row, other]
                model[free, column] += weight * normal[size, row]
    for column in range(free):
        for row in range(size):
            weight = basis[row, column]
            if weight != 0.0:
                for other in range(free):
                    model[other, column] += half[other, row] * weight
    return model


@njit(inline="always")
def _propose(points: FloatArray, model: FloatArray, basis: FloatArray, numbers: FloatArray, counts: IntArray) -> None:
    """Fill the trial with a damped step from the best point, or say that there is none worth trying."""
    free, cost = model.shape[1], numbers[COST]
    counts[STEPS] += 1
    step, promised = damped_step(model[:free], model[free], numbers[DAMPING])
    numbers[PROMISED] = promised
    least = numbers[TOLERANCE] if numbers[DAMPING] < SMOOTH else 0.0
    if cost <= numbers[FLOOR] or promised <= max(STEP_GAIN, least) * (cost / numbers[ERRORS]):
        counts[CONVERGED], counts[TRYING] = 1, 0
        return
    if cost <= numbers[TARGET]:
        counts[TRYING] = 0
        return
    gap = cost - numbers[BOUND]
    far = counts[STEPS] > 1 and gap > HOPELESS * promised  # a damped step is looked at first: it is known
    if far and gap > HOPELESS * damped_step(model[:free], model[free], UNDAMPED)[1]:
        counts[TRYING] = 0
        return
    for row in range(points.shape[1]):
        points[1, row] = points[0, row]
    for row in range(basis.shape[0] if basis.shape[1] > 0 else 0):
        moved = 0.0
        for column in range(free):
            moved += basis[row, column] * step[column]
        points[1, row] += moved
    if basis.shape[1] == 0:
        for row in range(free):
            points[1, row] += step[row]


@njit(inline="always")
def _settle(cost: float, better: bool, history: FloatArray, numbers: FloatArray, counts: IntArray) -> None:
    """Damping, and whether to go on, after a trial that was `better` with its cost, or was not."""
    variance = numbers[COST] / numbers[ERRORS]
    if better:
        gained = numbers[COST] - cost
        done = gained <= max(STEP_GAIN, numbers[TOLERANCE]) * variance and numbers[DAMPING] < SMOOTH
        numbers[COST] = cost
        numbers[DAMPING] = max(numbers[DAMPING] * (0.1 if gained > 0.5 * numbers[PROMISED] else 0.5), 1e-12)
    else:
        counts[UPHILL] = 1
        numbers[DAMPING] *= 8.0
        done = numbers[DAMPING] > 1e10
    steps = counts[STEPS]
    history[steps] = numbers[COST]
    lately = history[steps - STALL] - numbers[COST] if steps > STALL else np.inf
    counts[CONVERGED] = done or lately <= max(STALL_GAIN, numbers[TOLERANCE]) * variance
    slow = numbers[COST] - numbers[BOUND] > TOO_SLOW * lately
    counts[TRYING] = not counts[CONVERGED] and not slow and steps < counts[MOST]


@njit(nogil=True, inline="always")
def _keep(values: FloatArray, out: FloatArray) -> None:
    for k in range(values.size):
        out[k] = values[k]


@njit(nogil=True)
def advance(
    points: FloatArray, normal: FloatArray, model: FloatArray, basis: FloatArray, history: FloatArray,
    numbers: FloatArray, counts: IntArray, integrating: bool, radius: float, held: bool, late: IntArray, least: float,
    most_back: float, direction: int, na: int, nb: int, ne: int, p: int, delay: int, first: int, segments: IntArray,
    x: FloatArray, dx: FloatArray, shapes: FloatArray, y: FloatArray, zero: float, early: float, scale: float,
) -> None:  # fmt: skip
    """Judge the trial, if there is one, and go on to the next of which the internal variable `x` is not known.

    `points` (2, n) are the best point and the trial; `normal` belongs to the best, `model` (free + 1, free) is the same
    of the directions in `basis`. `history` (most steps + 1,) gets the cost after each step; `numbers` and `counts` as
    named above. The rules of the linear part are those of ``is_allowed``, the rest is as in ``normal_equations``; all
    squares count `scale` times.
    """
    best, trial, found, size = points[0], points[1], np.empty_like(normal), points.shape[1]
    allowed = counts[STEPS] > 0  # what is handed back is
    while counts[TRYING]:
        if counts[STEPS] > 0:
            cost, better = numbers[COST], allowed
            if allowed and counts[UPHILL]:  # a step uphill needs no gradient, and where one was others will be
                squares = squared_errors(trial, na, nb, ne, p, delay, first, segments, x, y, zero, early)
                better = scale * squares < cost
            if better:
                found[:] = 0.0
                cost = scale * normal_equations(
                    trial, na, nb, ne, p, delay, first, segments, x, dx, shapes, y, found[:size], found[size], zero,
                    early,
                )  # fmt: skip
                better = cost < numbers[COST]
            if better:
                _keep(trial, best)
                for row in range(size + 1):
                    for column in range(size):
                        normal[row, column] = scale * found[row, column]
                _keep(projected(normal, basis).reshape(-1), model.reshape(-1))
            _settle(cost, better, history, numbers, counts)
        if counts[TRYING]:
            _propose(points, model, basis, numbers, counts)
        if counts[TRYING]:
            a, b = trial[:na], trial[na : na + nb + 1]
            allowed = is_allowed(a, b, integrating, radius, held, late, least, most_back, direction)
            if allowed and not counts[STILL]:
                break
