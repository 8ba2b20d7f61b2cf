"""Scaled data: what the likelihood works on, and the way back to engineering units."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

from lostmotion.arrays import FloatArray, IntArray


class Signals(Protocol):
    """Command, output and segments, in whatever units.

    Attributes
    ----------
    u, y : ndarray, shape (n,)
        Segments one after the other.
    segments : ndarray, shape (s, 2)
        Start and stop rows.
    """

    @property
    def u(self) -> FloatArray:
        """Command."""

    @property
    def y(self) -> FloatArray:
        """Output."""

    @property
    def segments(self) -> IntArray:
        """Start and stop rows."""


class Recorded(Signals, Protocol):
    """The same with what the set point tells of the controller."""

    @property
    def against_pv(self) -> float:
        """Which way the controller moves OP, in standard errors, by moves of the set point; 0: they do not tell."""

    @property
    def of_past_rows(self) -> bool:
        """Whether OP is an exact function of PV of the rows before."""


@dataclass(frozen=True)
class Scaling:
    """u = u_centre + u_scale * scaled, y likewise."""

    u_centre: float = 0.0
    u_scale: float = 1.0
    y_centre: float = 0.0
    y_scale: float = 1.0


@dataclass(frozen=True)
class ScaledData:
    """u and y near 0 and of deviation 1, the segments, and the scaling that made them so.

    `against_pv`: which way the controller moves OP, in standard errors, by moves of the set point (``against_pv``).
    `of_past_rows`: whether PV of the same row does nothing to OP (``of_past_rows``).
    """

    u: FloatArray
    y: FloatArray
    segments: IntArray
    scaling: Scaling = field(default_factory=Scaling)
    against_pv: float = 0.0
    of_past_rows: bool = False

    @classmethod
    def of(cls, signals: Recorded, scaling: Scaling) -> ScaledData:
        """Signals in engineering units, scaled."""
        return cls(
            (signals.u - scaling.u_centre) / scaling.u_scale,
            (signals.y - scaling.y_centre) / scaling.y_scale,
            signals.segments,
            scaling,
            signals.against_pv,
            signals.of_past_rows,
        )

    @property
    def shortest(self) -> int:
        """Samples of the shortest segment."""
        return int((self.segments[:, 1] - self.segments[:, 0]).min())

    @property
    def longest(self) -> int:
        """Samples of the longest segment."""
        return int((self.segments[:, 1] - self.segments[:, 0]).max())
