"""How wide could a dead zone be that this record does not show? Profile likelihood of the width."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.distributions import normal_quantile
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.refinement import LocalFit, refine

HALVINGS = 6  # the bound to 1/64 of the last growth
STEPS = 20  # of everything else at a width
PLACES = 7  # over the range of OP
FIRST_SHARE = 0.005  # of the range of OP: the first width tried


def width_bound(fitted: Fitted, level: float = 0.95) -> float:
    """Largest width (scaled units) that the likelihood does not reject, one-sided; inf where none is rejected.

    Each trial width is refitted with everything else free, location included, from the fit of the width before. A
    dead zone that slides out of the range of OP says nothing: it is then held at several places inside.
    """
    problem = fitted.problem
    left, right = problem.eta_at, problem.eta_at + 1
    free = np.eye(fitted.fit.theta.size) if problem.basis is None else problem.basis
    own = np.flatnonzero(free[right])[0]
    basis = np.delete(free, own, axis=1)
    basis[right] = basis[left]  # both break points move together
    limit = fitted.fit.cost + normal_quantile(level) ** 2 * fitted.variance
    span = float(np.ptp(problem.u))
    low, high = float(problem.u.min()), float(problem.u.max())
    theta = fitted.fit.theta.copy()
    middle = 0.5 * (theta[left] + theta[right])

    def held(width: float, place: float) -> LocalFit:
        start = fitted.fit.theta.copy()
        start[left], start[right] = place - width / 2, place + width / 2
        return refine(problem, start, np.delete(free, [own, np.flatnonzero(free[left])[0]], axis=1), STEPS, tied=True)

    def rejected(width: float) -> bool:
        nonlocal theta
        start = theta.copy()
        centre = 0.5 * (start[left] + start[right])
        start[left], start[right] = centre - width / 2, centre + width / 2
        trial = refine(problem, start, basis, most_steps=STEPS, tied=True)
        if not low <= trial.theta[left] <= trial.theta[right] <= high:
            trial = min((held(width, place) for place in _places(low, high, width)), key=lambda one: one.cost)
        if trial.cost <= limit:
            theta = trial.theta
        return trial.cost > limit

    accepted = float(fitted.fit.theta[right] - fitted.fit.theta[left])
    width = max(accepted, FIRST_SHARE * span)
    while not rejected(width):
        accepted, width = width, 1.6 * width
        if width > span or abs(0.5 * (theta[left] + theta[right]) - middle) > span:
            return float(np.inf)
    for _ in range(HALVINGS):
        trial = 0.5 * (accepted + width)
        if rejected(trial):
            width = trial
        else:
            accepted = trial
    return width


def _places(low: float, high: float, width: float) -> FloatArray:
    """Middles of dead zones of a width inside a range."""
    reach = max(0.5 * (high - low - width), 0.0)
    return np.asarray(0.5 * (low + high) + reach * np.linspace(-1.0, 1.0, PLACES))
