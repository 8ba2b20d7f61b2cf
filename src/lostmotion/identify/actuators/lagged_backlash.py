"""Backlash behind a lag: the actuator moves slowly, and the play lies between it and the valve."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from scipy.signal import lfilter

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.actuator_lag import (
    NO_LAG,
    SEEN,
    SLOWEST,
    Lag,
    earlier,
    gain_by_lag,
    lagged,
    rise_behind,
)
from lostmotion.identify.actuators.backlash_family import BacklashFamily
from lostmotion.identify.actuators.polish import profile_end
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.refinement import LocalFit, refine, settled

# pole, share of the width that is found without one, and whether the delay is shorter
STARTS = ((0.2, 0.95, False), (0.5, 0.75, False), (0.4, 0.85, True), (0.7, 0.55, True))
STEPS = 8  # of everything else at a width


@dataclass(frozen=True)
class LaggedBacklash(BacklashFamily):
    """Play behind a pole; eta = width in [0, widest] and pole in [0, SLOWEST]."""

    own: ClassVar[tuple[str, ...]] = ("width", "pole")

    def act(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """Play of what comes out of the lag; a valve that moves follows a change of the pole, one that rests does not.

        At the rows at which it comes to rest it keeps the derivative, as it keeps its place.
        """
        pole = float(eta[1])
        driven = lagged(u, self.segments, pole)
        super().act(eta[:1], driven, x, dx[:1])
        for start, stop, _ in self.begun():
            before = np.append(u[start], driven[start : stop - 1])
            by_pole = lfilter([1.0], [1.0, -pole], before - u[start:stop])
            moves = np.diff(x[start:stop], prepend=np.nan) != 0.0
            last = np.maximum.accumulate(np.where(moves, np.arange(stop - start), 0))
            dx[1, start:stop] = by_pole[last]

    def path(self, eta: FloatArray, u: FloatArray, x: FloatArray) -> None:
        """The play alone."""
        super().path(eta[:1], lagged(u, self.segments, float(eta[1])), x)

    def valid(self, eta: FloatArray) -> FloatArray:
        """Width and pole in their range."""
        return np.append(super().valid(eta[:1]), min(max(eta[1], 0.0), SLOWEST))


def behind_lag(fitted: Fitted) -> Fitted:
    """The likeliest play behind a pole, begun at one that was found without."""
    family = fitted.problem.family
    if not isinstance(family, BacklashFamily):
        raise TypeError(f"expected a fit of a backlash, got one of {family.kind}; ask its own kind")
    behind = LaggedBacklash(family.widest, family.segments, rests=family.rests, load=family.load, loads=family.loads)
    whole = replace(fitted.problem, family=behind)
    at, basis = whole.eta_at + 1, fitted.basis
    if basis is not None:
        basis = np.insert(np.insert(basis, at, 0.0, axis=0), basis.shape[1], 0.0, axis=1)
        basis[at, -1] = 1.0
    fits = []
    for pole, share, shorter in STARTS:
        problem = earlier(whole) if shorter else whole
        theta = np.insert(fitted.fit.theta, at, pole)
        theta[problem.eta_at] *= share
        theta = settled(problem, theta, problem.free_but(problem.own, basis))
        fits.append(Fitted(problem, refine(problem, theta, basis), basis))
    return min(fits, key=lambda one: one.fit.cost)


def backlash_lag(fitted: Fitted) -> Lag:
    """What a lag leaves of a width.

    The interval is that of the profile over width and pole.
    """
    behind = behind_lag(fitted)
    gain = gain_by_lag(fitted, behind)
    rise = rise_behind(behind, gain)
    if gain <= 0.0 or rise <= 0.0:
        return NO_LAG
    ends = (profile_end(behind, 0, -1.0, rise, _held), profile_end(behind, 0, 1.0, rise, _held))
    pole = float(behind.actuator[1]) if gain > SEEN else 0.0
    return Lag(pole, behind.actuator[:1], {"width": ends})


def _held(fitted: Fitted, start: LocalFit, index: int, value: float) -> LocalFit | None:
    """Best fit with the width at a value; None where it cannot be."""
    problem, theta = fitted.problem, start.theta.copy()
    at = problem.eta_at + index
    theta[at] = value
    if abs(problem.project(theta)[at] - value) > 1e-9 * (1.0 + abs(value)):
        return None
    return refine(problem, theta, problem.free_but([at], fitted.basis), STEPS)
