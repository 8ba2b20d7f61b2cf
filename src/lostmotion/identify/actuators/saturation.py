"""Saturation: the limits of an actuator."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.kind import Kind, Words, register
from lostmotion.identify.actuators.rate_limited import slow_valve
from lostmotion.identify.likelihood.family import Family, Grid
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.scaled import ScaledData
from lostmotion.kernels import saturation as kernel
from lostmotion.models import Saturation

LIMITS = (0.01, 0.03, 0.08, 0.15, 0.25, 0.35, 0.45)  # shares of the samples beyond a limit
FEWEST_VISITS = 2  # beyond a limit: one step or spike of OP says nothing of its shape
FINER = 0.03  # of the range of OP: how far about a limit it is looked for once more


@dataclass(frozen=True)
class SaturationFamily(Family):
    """Saturation; eta = low, high, each with samples beyond it or at the end of the range."""

    ends: tuple[float, float]
    kind: ClassVar[str] = "saturation"
    own: ClassVar[tuple[str, ...]] = ("low", "high")
    places: ClassVar[bool] = True

    def act(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """Clamped command."""
        kernel.sensitivities(u, eta[0], eta[1], x, dx[:2])

    def valid(self, eta: FloatArray) -> FloatArray:
        """Limits in order and inside the range of OP."""
        low, high = sorted((float(eta[0]), float(eta[1])))
        return np.array([max(low, self.ends[0]), min(high, self.ends[1])])

    def grid(self, u: FloatArray, span: float, rows: int) -> Grid:
        """Pairs of limits with a good many samples beyond one of them."""
        del rows
        shares = np.array(LIMITS)
        lows = [float(u.min()), *np.quantile(u, shares)]
        highs = [float(u.max()), *np.quantile(u, 1.0 - shares)]
        steps = FINER * span * np.linspace(-1, 1, 3)
        pairs = [np.array([low, high]) for low in lows for high in highs if low < high][1:]
        return pairs, lambda eta: [eta + np.array([down, up]) for down in steps for up in steps]


class SaturationKind(Kind):
    """An actuator at its limits; from one side it looks like a dead zone, which has more local maxima."""

    model = Saturation
    family = SaturationFamily
    evidence = "saturation"
    angular = "never"
    break_points = ("low", "high")
    anywhere = ("low", "high")
    looks_like = "dead zone"
    words = Words(
        unseen="OP moved freely between the limits that the search found; no saturation is seen.",
        plural="saturations",
        meanings={"low": "lower limit of the actuator", "high": "upper limit of the actuator"},
        advice=("The actuator is at its limit: check its range, its stops and the size of the valve.",),
    )

    def forms(self, data: ScaledData) -> list[Family]:
        """One, within the range of OP."""
        return [SaturationFamily((float(data.u.min()), float(data.u.max())))]

    def healthy(self, fitted: Fitted, linear: Fitted) -> Fitted:
        """A valve that is slow and meets no stop."""
        return slow_valve(fitted, linear)

    def meets(self, own: FloatArray, u: FloatArray) -> bool:
        """OP goes beyond one of the limits more than once."""
        return bool(np.isfinite(self.places_met(own, u)).any())

    def places_met(self, own: FloatArray, u: FloatArray) -> FloatArray:
        """Limits beyond which OP goes more than once."""
        low, high = own
        visits = [int(np.count_nonzero(np.diff(beyond, prepend=False) & beyond)) for beyond in (u < low, u > high)]
        return np.where(np.array(visits) >= FEWEST_VISITS, own, [-np.inf, np.inf])


SATURATION = register(SaturationKind())
