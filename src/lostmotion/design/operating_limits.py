"""What the operator allows."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.design.simulated_plant import Plant
from lostmotion.design.staircase import Staircase

Range = tuple[float, float]
EVERYTHING: Range = (-np.inf, np.inf)
NOISE_MARGIN = 3.0  # deviations of the noise between the predicted PV and its limits
LOOP_MARGIN = 1.0  # the same where the predicted PV has its noise already


@dataclass(frozen=True)
class Limits:
    """Limits of a test, in samples and engineering units.

    Parameters
    ----------
    levels : (float, float)
        Of the signal that is moved: OP in open loop, SP in closed loop.
    op, pv : (float, float)
        What OP and PV must not leave, noise included; infinite where free.
    hold, longest : int
        Fewest and most samples for which a level is kept.
    per_sample : float
        Largest move of the signal per sample.
    start : float
        Value of the signal before the test.
    """

    levels: Range
    op: Range
    pv: Range
    hold: int
    longest: int
    per_sample: float
    start: float

    def coarser(self, factor: int) -> Limits:
        """The same limits on a clock `factor` times slower; holds are rounded up."""
        hold = -(-self.hold // factor)
        longest = max(self.longest // factor, 2 * hold)
        return replace(self, hold=hold, longest=longest, per_sample=self.per_sample * factor)

    def tightened(self, pv: float, op: float) -> Limits:
        """With this much room kept at the limits of PV and OP."""
        pv_low, pv_high = self.pv
        op_low, op_high = self.op
        return replace(self, pv=(pv_low + pv, pv_high - pv), op=(op_low + op, op_high - op))

    def holds(self, stairs: Staircase) -> bool:
        """Whether levels and holds are allowed; the time on a ramp is not counted as holding."""
        low, high = self.levels
        if (stairs.levels < low).any() or (stairs.levels > high).any() or (stairs.lengths > self.longest).any():
            return False
        return bool((stairs.lengths - stairs.ramps(self.start, self.per_sample) >= self.hold).all())

    @property
    def watched(self) -> bool:
        """Whether OP or PV have limits that only a simulation can tell."""
        return self.pv != EVERYTHING or self.op != EVERYTHING

    def overshoot(self, plant: Plant, op: FloatArray, pv: FloatArray) -> tuple[float, float]:
        """How far the PV and OP of a trial go beyond their limits; negative or 0 where they keep them."""
        deviations = NOISE_MARGIN if plant.controller is None else LOOP_MARGIN
        return _beyond(pv, self.pv) + deviations * plant.noise_deviation, _beyond(op, self.op)

    def kept(self, plants: list[Plant], signal: FloatArray) -> bool:
        """Whether PV and OP keep their limits on all plants."""
        if not self.watched:
            return True
        return all(max(self.overshoot(plant, *plant.trial(signal))) <= 0.0 for plant in plants)


def _beyond(values: FloatArray, limits: Range) -> float:
    return max(float(values.max()) - limits[1], limits[0] - float(values.min()))
