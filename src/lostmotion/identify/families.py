"""What the likelihood needs to know about a kind of actuator: eta -> x, dx/deta, and the valid set of eta."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, Protocol

import numpy as np

from lostmotion.kernels import dead_zone as kernel
from lostmotion.models._arguments import FloatArray

LARGEST_SLOPE_RATIO = 50.0  # beyond this one side carries no signal: it is a one-sided actuator


class Family(Protocol):
    """One kind of actuator, with right slope (or only slope) 1: the gain stays in the linear part."""

    kind: ClassVar[str]
    kinks: ClassVar[bool]  # x jumps where eta moves: gradients alone do not end at the maximum

    @property
    def load(self) -> bool:
        """Whether eta ends with a constant load."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of eta."""

    def with_load(self, load: bool) -> Family:
        """The same family with or without a load."""

    def evaluate(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """Fill x (n,) and dx/deta (len(names), n) for the command u (n,)."""

    def project(self, eta: FloatArray) -> FloatArray:
        """Nearest valid eta."""


@dataclass(frozen=True)
class LinearFamily:
    """No fault: x = u, plus a constant load where asked for."""

    load: bool = False
    kind: ClassVar[str] = "none"
    kinks: ClassVar[bool] = False

    @property
    def names(self) -> tuple[str, ...]:
        """Names of eta."""
        return ("load",) if self.load else ()

    def with_load(self, load: bool) -> Family:
        """The same with or without a load."""
        return replace(self, load=load)

    def evaluate(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """Copy u."""
        x[:] = u
        if self.load:
            x += eta[0]
            dx[0] = 1.0

    def project(self, eta: FloatArray) -> FloatArray:
        """Nothing to project."""
        return eta


@dataclass(frozen=True)
class DeadZoneFamily:
    """Dead zone; eta = left, right, log(left_slope / right_slope).

    `low` and `high` keep both break points where at least a few samples lie beyond them: outside, the
    likelihood is flat. With `load` a constant is added behind the actuator: what an integrating process must be
    given to stand still (outflow of a tank); a self-regulating one has its offset for that.
    """

    low: float
    high: float
    load: bool = False
    kind: ClassVar[str] = "dead zone"
    kinks: ClassVar[bool] = False

    @property
    def names(self) -> tuple[str, ...]:
        """Names of eta."""
        return ("left", "right", "log_ratio", "load") if self.load else ("left", "right", "log_ratio")

    def with_load(self, load: bool) -> Family:
        """The same with or without a load."""
        return replace(self, load=load)

    def evaluate(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """Dead zone with right slope 1 and its derivatives."""
        kernel.sensitivities(u, eta[0], eta[1], eta[2], x, dx[:3])
        if self.load:
            x += eta[3]
            dx[3] = 1.0

    def project(self, eta: FloatArray) -> FloatArray:
        """Order the break points (a negative width becomes zero at its middle) and keep them inside the data."""
        left, right, log_ratio = eta[:3]
        if left > right:
            left = right = 0.5 * (left + right)
        limit = np.log(LARGEST_SLOPE_RATIO)
        return np.array(
            [
                min(max(left, self.low), self.high),
                min(max(right, self.low), self.high),
                min(max(log_ratio, -limit), limit),
                *eta[3:],
            ]
        )
