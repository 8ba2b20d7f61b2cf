"""A valve that is slow: what a saturation must explain better than.

Large moves of OP are over before a slow valve has followed them, as if it had met a stop; but PV goes on moving while
OP is beyond it, and the same happens wherever in its range OP moves fast.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.in_place import in_place_of, placed, refined
from lostmotion.identify.likelihood.criterion import gain_over_linear, per_row
from lostmotion.identify.likelihood.family import Family
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.kernels import rate_limit as kernel

STARTS, FEW = (1, 2, 3, 4, 5, 6), (2, 4)  # rates to begin at, in powers of a half of the largest move of OP in a row
SLOWEST = 1e-6  # of the range of OP in a sample: a valve that moves at all


@dataclass(frozen=True)
class RateLimitedFamily(Family):
    """Follows OP by no more than a rate in each direction; own parameters = up, down, in a sample."""

    slowest: float
    kind: ClassVar[str] = "none"
    own: ClassVar[tuple[str, ...]] = ("up", "down")

    def act(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """The position and its derivatives."""
        up, down = self.valid(eta[:2]).tolist()
        kernel.sensitivities(u, up, down, x, dx[:2])

    def valid(self, eta: FloatArray) -> FloatArray:
        """It moves in both directions."""
        return np.maximum(eta, self.slowest)


def slow_valve(fitted: Fitted, linear: Fitted) -> Fitted:
    """The likelier of the linear model and a rate limit in the place of the actuator of a fit."""
    rivals = [in_place_of(fitted, *start, per_row(fitted)) for start in _starts(fitted, STARTS)]
    return max([linear, *rivals], key=lambda one: gain_over_linear(one, linear))


def slow_at_a_glance(fitted: Fitted, linear: Fitted) -> Fitted:
    """The same from the likelier of two rates, and only where it begins likelier than the linear model."""
    begun = min((placed(fitted, *start) for start in _starts(fitted, FEW)), key=per_row)
    if per_row(begun) >= per_row(linear):
        return linear
    found = refined(begun.problem, begun.fit.theta, begun.basis, per_row(fitted))
    return max(linear, found, key=lambda one: gain_over_linear(one, linear))


def _starts(fitted: Fitted, powers: tuple[int, ...]) -> list[tuple[RateLimitedFamily, FloatArray]]:
    u = fitted.problem.u
    largest, family = float(np.abs(np.diff(u)).max()), RateLimitedFamily(SLOWEST * float(np.ptp(u)))
    return [(family, np.full(2, largest * 0.5**power)) for power in powers]
