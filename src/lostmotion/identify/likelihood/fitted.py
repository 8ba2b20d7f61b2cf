"""A problem and the maximum of its likelihood."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.likelihood.noise_order import Left
from lostmotion.identify.likelihood.plausible import plausible, slowest
from lostmotion.identify.likelihood.problem import Parts, Problem
from lostmotion.identify.likelihood.refinement import LocalFit


@dataclass(frozen=True)
class Fitted:
    """A problem and the maximum of its likelihood."""

    problem: Problem
    fit: LocalFit
    basis: FloatArray | None = None  # directions that were free; None: all
    rivals: tuple[tuple[FloatArray, float], ...] = ()  # other actuators that fit about as well, and by how much less
    dispersion: float = 1.0  # variance of the estimates over that with white residuals

    @cached_property
    def parts(self) -> Parts:
        """The parameters by what they mean."""
        return self.problem.parts(self.fit.theta)

    @property
    def actuator(self) -> FloatArray:
        """Parameters of the actuator alone, scaled."""
        return self.parts.eta[: len(self.problem.family.own)]

    @property
    def variance(self) -> float:
        """Residual variance, corrected for the parameters; of coloured residuals as large as would scatter them so."""
        return self.dispersion * self.fit.cost / max(self.problem.errors - self.free, 1)

    @property
    def free(self) -> int:
        """Free parameters, initial conditions included."""
        return self.fit.theta.size if self.basis is None else self.basis.shape[1]

    @property
    def parameters(self) -> int:
        """Free parameters without initial conditions, and what was sought beside them."""
        at, basis = self.problem.initial_at, self.basis
        shared = at if basis is None else int(np.count_nonzero(basis[:at].any(axis=0)))
        return shared + self.problem.family.sought

    @cached_property
    def possible(self) -> bool:
        """Whether a sampled process can have these poles, and be what is known of this one."""
        return plausible(self.parts.a) and self.problem.admissible(self.fit.theta)

    @cached_property
    def slowest(self) -> float:
        """Largest radius of the poles, beside that of an integrating process."""
        a = self.parts.a
        return slowest(1.0 + np.cumsum(a)[:-1] if self.problem.structure.integrating else a)

    def drifts(self, longest: int) -> bool:
        """Whether a pole is slower than the longest segment of the record: not seen to settle, but a drift."""
        return self.slowest > 1.0 - 1.0 / longest

    @cached_property
    def left(self) -> Left:
        """The output residual and its noise."""
        return Left(self.output_residual())

    def output_residual(self) -> list[FloatArray]:
        """Measured minus simulated output, from row `first` of each segment."""
        return self.problem.output_residual(self.fit.theta)
