"""A sticking valve as the likelihood sees it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.memory_family import MemoryFamily
from lostmotion.identify.likelihood.family import Family
from lostmotion.kernels import stiction as kernel
from lostmotion.models.stiction import CODES

STICTION_MODELS = ("he", "kano")  # Choudhury's never moves under noise inside its band
LARGEST_JUMP = 3.0  # bands: a slip beyond this is not a valve


@dataclass(frozen=True)
class StictionFamily(MemoryFamily):
    """Stiction; eta = band, jump with band in [0, widest] and jump in [0, 3 band]."""

    model: str = "kano"
    kind: ClassVar[str] = "stiction"
    own: ClassVar[tuple[str, ...]] = ("band", "jump")
    needles: ClassVar[bool] = True

    def act(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """Position from rest at the first command of each segment."""
        for start, stop, rest in self.begun():
            part, slopes = np.empty(stop - start), np.empty((2, stop - start))
            position = u[start] + 0.5 * rest * (eta[0] + eta[1])
            kernel.sensitivities(CODES[self.model], u[start:stop], eta[0], eta[1], position, part, slopes)
            x[start:stop], dx[:2, start:stop] = part, slopes

    def path(self, eta: FloatArray, u: FloatArray, x: FloatArray) -> None:
        """The position alone."""
        for start, stop, rest in self.begun():
            position = u[start] + 0.5 * rest * (eta[0] + eta[1])
            x[start:stop] = kernel.run(CODES[self.model], u[start:stop], eta[0], eta[1], position)

    def valid(self, eta: FloatArray) -> FloatArray:
        """Band and jump in their range."""
        band = min(max(eta[0], 0.0), self.widest)
        return np.array([band, min(max(eta[1], 0.0), LARGEST_JUMP * band)])

    @property
    def code(self) -> int:
        """Of the model, as the kernels know it."""
        return CODES[self.model]

    def as_other(self) -> StictionFamily:
        """The same family with the other model."""
        return replace(self, model=next(model for model in STICTION_MODELS if model != self.model))


@dataclass(frozen=True)
class RampFamily(StictionFamily):
    """He's valve that breaks away between the rows, while OP goes in a straight line from row to row.

    A slip that moves from one row to the next changes nothing at once: its likelihood has no needles. All slips are J
    long, which the gain of the process undoes: in a limit cycle J is known by its upper limit alone (friction pulls,
    J <= S), and the refinement leaves it where the profile has put it.
    """

    model: str = "he ramp"
    needles: ClassVar[bool] = False
    kinks: ClassVar[bool] = True

    def valid(self, eta: FloatArray) -> FloatArray:
        """A jump of no more than the band."""
        band, jump = super().valid(eta).tolist()
        return np.array([band, min(jump, band)])

    def act(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """Mean position from row to row, from rest at the first command of each segment."""
        for start, stop, rest in self.begun():
            part, slopes = np.empty(stop - start), np.empty((2, stop - start))
            position = u[start] + 0.5 * rest * (eta[0] + eta[1])
            kernel.sensitivities_on_ramp(u[start:stop], eta[0], eta[1], position, 0.5 * rest, part, slopes)
            x[start:stop], dx[0, start:stop] = part, slopes[0]
        dx[1] = 0.0


def own(family: Family) -> StictionFamily:
    """The family, known to be one of stiction.

    Raises
    ------
    TypeError
        It is another.
    """
    if not isinstance(family, StictionFamily):
        raise TypeError(f"expected a family of stiction, got one of {family.kind}; ask its own kind")
    return family
