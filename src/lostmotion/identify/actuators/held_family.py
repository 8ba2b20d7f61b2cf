"""An actuator that is held: the likelihood beside it has no more directions than are free."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.likelihood.family import Family


@dataclass(frozen=True)
class HeldFamily(Family):
    """An actuator with all its parameters held."""

    actuator: Family
    at: FloatArray = field(compare=False)
    kind: ClassVar[str] = "held"
    own: ClassVar[tuple[str, ...]] = ()

    def act(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """The actuator where it is held."""
        del eta, dx
        self.actuator.path(self.at, u, x)


@dataclass(frozen=True)
class SlidingFamily(HeldFamily):
    """An actuator that moves in one direction of its parameters only."""

    slide: FloatArray = field(compare=False)
    own: ClassVar[tuple[str, ...]] = ("slide",)

    def act(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """The actuator where it has slid to."""
        slopes = np.empty((self.slide.size, u.size))
        self.actuator.act(self.slid(eta), u, x, slopes)
        np.dot(self.slide, slopes, out=dx[0])

    def slid(self, eta: FloatArray) -> FloatArray:
        """Parameters of the actuator itself."""
        return np.asarray(self.at + eta[0] * self.slide)
