"""Healthy characteristics that are no straight line: what a dead zone must explain better than.

A characteristic that bends (a valve of equal percentages, a flow that is measured without its root, two slopes that
meet) is explained by a dead zone better than by a straight line, by its two slopes and a gap where it bends.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.in_place import in_place_of, refined
from lostmotion.identify.likelihood.criterion import gain_over_linear, per_row
from lostmotion.identify.likelihood.family import Family
from lostmotion.identify.likelihood.fitted import Fitted

STEEPEST = 5.0  # logarithm of the ratio of the slopes at both ends; a valve with a rangeability of 50 has 3.9
STRAIGHT = 1e-4  # curvature times OP below which the series is exact
BROKEN = float(np.log(3.0))  # logarithm of the ratio of two slopes: more is no healthy valve, with or without a gap
BENDS_AT = (0.25, 0.75)  # quantiles of OP at which two slopes may meet, beside the middle of the gap


@dataclass(frozen=True)
class CurvedFamily(Family):
    """Characteristic of equal percentages, x = (exp(c u) - 1) / c, without a gap; own parameter = c of any sign."""

    steepest: float = STEEPEST
    kind: ClassVar[str] = "none"
    own: ClassVar[tuple[str, ...]] = ("curvature",)

    def act(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """The curve and its derivative."""
        c = float(self.valid(eta[:1])[0])
        v = c * u
        if abs(c) * float(np.abs(u).max(initial=0.0)) < STRAIGHT:
            x[:] = u * (1.0 + v * (0.5 + v / 6.0))
            dx[0] = u**2 * (0.5 + v / 3.0)
            return
        x[:] = np.expm1(v) / c
        dx[0] = (u * np.exp(v) - x) / c

    def valid(self, eta: FloatArray) -> FloatArray:
        """Not steeper than valves are."""
        return np.clip(eta, -self.steepest, self.steepest)


def without_gap(fitted: Fitted, linear: Fitted) -> Fitted:
    """The likeliest model without a gap beside a dead zone: the linear one, two slopes that meet, or a curve.

    Where it is plain that one is far behind the dead zone it is not refined to its end.
    """
    score, curve = per_row(fitted), CurvedFamily(STEEPEST / float(np.ptp(fitted.problem.u)))
    rivals = [linear, *_two_slopes(fitted, score), in_place_of(fitted, curve, np.zeros(1), score)]
    return max(rivals, key=lambda one: gain_over_linear(one, linear))


def _two_slopes(fitted: Fitted, score: float) -> Iterator[Fitted]:
    """The dead zone of width 0, begun at some places."""
    problem, at = fitted.problem, fitted.problem.eta_at
    free = np.eye(problem.size) if fitted.basis is None else fitted.basis
    others = free[:, ~free[at : at + 3].any(axis=0)]
    place, ratio = np.zeros(problem.size), np.zeros(problem.size)
    place[at : at + 2], ratio[at + 2] = 1.0, 1.0
    basis = np.column_stack([others, place, ratio])
    left, right, _ = fitted.actuator.tolist()
    for middle in (0.5 * (left + right), *np.quantile(problem.u, BENDS_AT).tolist()):
        theta = fitted.fit.theta.copy()
        theta[at : at + 2] = middle
        found = refined(problem, theta, basis, score, tied=True)
        theta, steep = found.fit.theta.copy(), float(found.actuator[2])
        if abs(steep) > BROKEN:
            theta[at + 2] = np.copysign(BROKEN, steep)
            broken = refined(problem, theta, basis[:, :-1], score, tied=True)
            found = replace(broken, basis=basis)  # the ratio is paid for
        yield found
