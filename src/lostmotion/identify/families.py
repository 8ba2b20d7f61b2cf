"""What the likelihood needs to know about a kind of actuator: eta -> x, dx/deta, and the valid set of eta."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from lostmotion.kernels import dead_zone as kernel
from lostmotion.models._arguments import FloatArray

LARGEST_SLOPE_RATIO = 50.0  # beyond this one side carries no signal: it is a one-sided actuator


class Family(Protocol):
    """One kind of actuator, with right slope (or only slope) 1: the gain stays in the linear part."""

    kind: ClassVar[str]
    names: ClassVar[tuple[str, ...]]

    def evaluate(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """Fill x (n,) and dx/deta (len(names), n) for the command u (n,)."""

    def project(self, eta: FloatArray) -> FloatArray:
        """Nearest valid eta."""


@dataclass(frozen=True)
class LinearFamily:
    """No fault: x = u."""

    kind: ClassVar[str] = "none"
    names: ClassVar[tuple[str, ...]] = ()

    def evaluate(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:  # noqa: ARG002
        """Copy u."""
        x[:] = u

    def project(self, eta: FloatArray) -> FloatArray:
        """Nothing to project."""
        return eta


@dataclass(frozen=True)
class DeadZoneFamily:
    """Dead zone; eta = left, right, log(left_slope / right_slope).

    `low` and `high` keep both break points where at least a few samples lie beyond them: outside, the
    likelihood is flat.
    """

    low: float
    high: float
    kind: ClassVar[str] = "dead zone"
    names: ClassVar[tuple[str, ...]] = ("left", "right", "log_ratio")

    def evaluate(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """Dead zone with right slope 1 and its derivatives."""
        kernel.sensitivities(u, eta[0], eta[1], eta[2], x, dx)

    def project(self, eta: FloatArray) -> FloatArray:
        """Order the break points (a negative width becomes zero at its middle) and keep them inside the data."""
        left, right, log_ratio = eta
        if left > right:
            left = right = 0.5 * (left + right)
        limit = np.log(LARGEST_SLOPE_RATIO)
        return np.array(
            [
                min(max(left, self.low), self.high),
                min(max(right, self.low), self.high),
                min(max(log_ratio, -limit), limit),
            ]
        )
