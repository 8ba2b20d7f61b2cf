"""What the likelihood needs to know about a kind of actuator: eta -> x, dx/deta, and the valid set of eta."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar, Self

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.kernels import dead_zone as kernel

LARGEST_SLOPE_RATIO = 50.0  # beyond this one side carries no signal: it is a one-sided actuator


@dataclass(frozen=True)
class Loads:
    """What acts on the process beside the actuator, up to its size.

    Attributes
    ----------
    shapes : ndarray, shape (m, n)
        Known courses, in the input of the process.
    events : tuple of Swing or Step
        What they stand for; the time of each was sought and counts as a parameter.
    """

    shapes: FloatArray
    events: tuple[Swing | Step, ...]

    def kept(self, index: list[int]) -> Loads | None:
        """Only some of the events, all their shapes; None where none is left."""
        ends = np.cumsum([len(event.names) for event in self.events])
        rows = [row for i in index for row in range(ends[i] - len(self.events[i].names), ends[i])]
        return Loads(self.shapes[rows], tuple(self.events[i] for i in index)) if index else None

    def joined(self, other: Loads | None) -> Loads:
        """Both."""
        if other is None:
            return self
        return Loads(np.concatenate([self.shapes, other.shapes]), (*self.events, *other.events))


@dataclass(frozen=True)
class Swing:
    """A periodic load; period in samples."""

    period: float
    names: ClassVar[tuple[str, ...]] = ("sine", "cosine")

    def to_dict(self) -> dict[str, float]:
        """JSON-ready."""
        return {"period": self.period}


@dataclass(frozen=True)
class Step:
    """A load that changes once, at a row of the data."""

    row: int
    names: ClassVar[tuple[str, ...]] = ("step",)

    def to_dict(self) -> dict[str, float]:
        """JSON-ready."""
        return {"step_at": self.row}


@dataclass(frozen=True)
class Family(ABC):
    """One kind of actuator, with right slope (or only slope) 1: the gain stays in the linear part.

    eta = its own parameters, then the sizes of what else acts on the process: with `load` a constant, what an
    integrating process must be given to stand still (outflow of a tank; a self-regulating one has its offset for
    that), and then `loads`.
    """

    load: bool = field(default=False, kw_only=True)
    loads: Loads | None = field(default=None, kw_only=True, compare=False, repr=False)
    kind: ClassVar[str] = "none"
    kinks: ClassVar[bool] = False  # x jumps where eta moves: gradients alone do not end at the maximum
    own: ClassVar[tuple[str, ...]] = ()  # names of the actuator's parameters

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of eta."""
        others = () if self.loads is None else tuple(name for event in self.loads.events for name in event.names)
        return (*self.own, *(("load",) if self.load else ()), *others)

    @property
    def sought(self) -> int:
        """Parameters that are not in eta: the times of the loads."""
        return 0 if self.loads is None else len(self.loads.events)

    def with_load(self, load: bool) -> Self:
        """The same family with or without a constant load."""
        return replace(self, load=load)

    def with_loads(self, loads: Loads | None) -> Self:
        """The same family with other loads."""
        return replace(self, loads=loads)

    def evaluate(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """Fill x (n,) and dx/deta (len(names), n) for the command u (n,)."""
        at = len(self.own)
        self.act(eta[:at], u, x, dx[:at])
        if self.load:
            x += eta[at]
            dx[at] = 1.0
            at += 1
        if self.loads is not None:
            x += eta[at:] @ self.loads.shapes
            dx[at:] = self.loads.shapes

    def path(self, eta: FloatArray, u: FloatArray, x: FloatArray) -> None:
        """Fill x (n,) for the actuator alone, without derivatives where that is cheaper."""
        self.act(eta, u, x, np.empty((len(self.own), u.size)))

    def project(self, eta: FloatArray) -> FloatArray:
        """Nearest valid eta."""
        at = len(self.own)
        return np.concatenate([self.valid(eta[:at]), eta[at:]])

    @abstractmethod
    def act(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """Fill x (n,) and its derivatives for the actuator alone."""

    def valid(self, eta: FloatArray) -> FloatArray:
        """Nearest valid parameters of the actuator alone."""
        return eta


@dataclass(frozen=True)
class LinearFamily(Family):
    """No fault: x = u."""

    def act(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """Copy u."""
        del eta, dx
        x[:] = u


@dataclass(frozen=True)
class DeadZoneFamily(Family):
    """Dead zone; own parameters = left, right, log(left_slope / right_slope).

    `low` and `high` keep both break points where at least a few samples lie beyond them: outside, the
    likelihood is flat.
    """

    low: float
    high: float
    kind: ClassVar[str] = "dead zone"
    own: ClassVar[tuple[str, ...]] = ("left", "right", "log_ratio")

    def act(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """Dead zone with right slope 1 and its derivatives."""
        kernel.sensitivities(u, eta[0], eta[1], eta[2], x, dx)

    def valid(self, eta: FloatArray) -> FloatArray:
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
