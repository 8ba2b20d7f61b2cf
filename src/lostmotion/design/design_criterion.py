"""What a test is worth: 95 % half-widths of the wanted parameters over all plausible plants."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.design.simulated_plant import Plant
from lostmotion.distributions import normal_quantile
from lostmotion.kernels import contrast as kernel

Z95 = normal_quantile(0.975)  # standard errors in the half-width of a 95 % interval
RATIO_PRIOR = 30.0  # deviation of the logarithm of the slope ratio before the test: as good as nothing
CONTRASTS = {"left": (1.0, 0.0), "right": (0.0, 1.0), "width": (-1.0, 1.0)}  # of left and right


@dataclass(frozen=True)
class Criterion:
    """Score of a test.

    Parameters
    ----------
    wanted : dict of float
        Half-width of the 95 % interval by name, in units of OP; 1 where only the smallest is asked for.
    reach : float
        Deviation of the break points before the test, in units of OP: finite, so that a test that says nothing about
        one of them still has a score. Wide beside every interval that is worth a test.
    blind : float
        Half-width that tells nothing, in units of OP.
    """

    wanted: dict[str, float]
    reach: float
    blind: float

    def half_widths(self, plant: Plant, op: FloatArray, pv: FloatArray) -> FloatArray:
        """95 % half-widths of the wanted parameters on one plant, shape (len(wanted),).

        Information is local: a level barely beyond a break point counts in full. It does not where the break point may
        as well lie beyond that level, so such a test is judged once more with the break points moved out by their own
        half-widths.
        """
        plant = plant.unsure
        contrasts = np.array([CONTRASTS[name] for name in ("left", "right", *self.wanted)])
        found = self._half_widths(plant, plant.theta, op, pv, contrasts)
        left, right = plant.zone.left, plant.zone.right
        farther = np.minimum(found[:2], self.blind)
        outer = ((op < left) & (op >= left - farther[0])) | ((op > right) & (op <= right + farther[1]))
        if outer.any():
            eta = plant.structure.na + plant.structure.nb + 2
            theta = plant.theta.copy()
            theta[eta : eta + 2] += farther * [-1.0, 1.0]
            found = np.maximum(found, self._half_widths(plant, theta, op, pv, contrasts))
        return found[2:]

    def _half_widths(
        self, plant: Plant, theta: FloatArray, op: FloatArray, pv: FloatArray, contrasts: FloatArray
    ) -> FloatArray:
        s = plant.structure
        prior = np.array([self.reach**-2, self.reach**-2, RATIO_PRIOR**-2])
        variances = kernel.variances(
            theta, s.na, s.nb, s.noise_order, s.delay, s.integrating, op, pv, plant.noise.variance, plant.free,
            prior, contrasts,
        )  # fmt: skip
        return np.asarray(Z95 * np.sqrt(variances))

    def over(self, table: FloatArray) -> FloatArray:
        """Half-widths over plants (rows) as one number for each wanted parameter: their mean.

        In it a half-width counts as no more than `blind`: a plant that is missed costs much, but one on which no test
        within the limits can tell anything does not drown the others.
        """
        return np.asarray(np.mean(table / (1.0 + table / self.blind), axis=0))

    def table(self, plants: list[Plant], signal: FloatArray) -> FloatArray:
        """Half-widths of a test, shape (plants, wanted)."""
        trials = [(signal, signal) if plant.controller is None else plant.trial(signal) for plant in plants]
        return np.array([self.half_widths(plant, *trial) for plant, trial in zip(plants, trials, strict=True)])

    def score(self, table: FloatArray) -> float:
        """Largest of the half-widths over the wanted ones: the score that the search minimises."""
        return float(np.max(self.over(table) / self.goals))

    @property
    def goals(self) -> FloatArray:
        """Wanted half-widths, shape (len(wanted),)."""
        return np.array(list(self.wanted.values()))
