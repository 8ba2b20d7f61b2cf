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
    """u and y near 0 and of deviation 1, the segments, the scaling that made them so, and what they were made of."""

    u: FloatArray
    y: FloatArray
    segments: IntArray
    scaling: Scaling = field(default_factory=Scaling)
    recorded: Recorded | None = None

    @classmethod
    def of(cls, signals: Recorded, scaling: Scaling) -> ScaledData:
        """Signals in engineering units, scaled."""
        return cls(
            (signals.u - scaling.u_centre) / scaling.u_scale,
            (signals.y - scaling.y_centre) / scaling.y_scale,
            signals.segments,
            scaling,
            signals,
        )

    @property
    def against_pv(self) -> float:
        """Of what was recorded; 0 where that is not known."""
        return 0.0 if self.recorded is None else self.recorded.against_pv

    @property
    def of_past_rows(self) -> bool:
        """Of what was recorded; False where that is not known."""
        return self.recorded is not None and self.recorded.of_past_rows

    @property
    def shortest(self) -> int:
        """Samples of the shortest segment."""
        return int((self.segments[:, 1] - self.segments[:, 0]).min())

    @property
    def longest(self) -> int:
        """Samples of the longest segment."""
        return int((self.segments[:, 1] - self.segments[:, 0]).max())
