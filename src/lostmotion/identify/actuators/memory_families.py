"""Actuators with memory, and saturation, as the likelihood sees them.

Memory begins anew at every segment: the valve rests somewhere inside its band, `rests` says where, as a share of half
the band off the first command. A stiff valve can stay there for hundreds of samples, so it is sought like the band. A
change of width that shifts a break-away by a sample makes x jump: the derivatives hold between such jumps, and
``kinks`` tells the optimiser that there are some.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray
from lostmotion.identify.likelihood.family import Family
from lostmotion.kernels import backlash, saturation, stiction
from lostmotion.models.stiction import CODES

LARGEST_JUMP = 3.0  # bands: a slip beyond this is not a valve


def _begun(segments: npt.NDArray[np.int64], rests: tuple[float, ...]) -> Iterator[tuple[int, int, float]]:
    """Start, stop and rest of every segment."""
    for index, (start, stop) in enumerate(segments.tolist()):
        yield start, stop, rests[index] if index < len(rests) else 0.0


@dataclass(frozen=True)
class BacklashFamily(Family):
    """Play; eta = width, in [0, widest]."""

    widest: float
    segments: npt.NDArray[np.int64] = field(compare=False)
    rests: tuple[float, ...] = ()
    kind: ClassVar[str] = "backlash"
    kinks: ClassVar[bool] = True
    own: ClassVar[tuple[str, ...]] = ("width",)

    def act(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """Play from rest at the first command of each segment."""
        for start, stop, rest in _begun(self.segments, self.rests):
            part, slopes = np.empty(stop - start), np.empty((2, stop - start))
            backlash.sensitivities(u[start:stop], eta[0], u[start] + 0.5 * rest * eta[0], part, slopes)
            x[start:stop], dx[0, start:stop] = part, slopes[0]

    def path(self, eta: FloatArray, u: FloatArray, x: FloatArray) -> None:
        """The play alone."""
        for start, stop, rest in _begun(self.segments, self.rests):
            x[start:stop] = backlash.run(u[start:stop], eta[0], u[start] + 0.5 * rest * eta[0])

    def valid(self, eta: FloatArray) -> FloatArray:
        """Width in its range."""
        return np.array([min(max(eta[0], 0.0), self.widest)])


@dataclass(frozen=True)
class StictionFamily(Family):
    """Stiction; eta = band, jump with band in [0, widest] and jump in [0, 3 band]."""

    widest: float
    segments: npt.NDArray[np.int64] = field(compare=False)
    rests: tuple[float, ...] = ()
    model: str = "kano"
    kind: ClassVar[str] = "stiction"
    kinks: ClassVar[bool] = True
    own: ClassVar[tuple[str, ...]] = ("band", "jump")

    def act(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """Position from rest at the first command of each segment."""
        for start, stop, rest in _begun(self.segments, self.rests):
            part, slopes = np.empty(stop - start), np.empty((2, stop - start))
            position = u[start] + 0.5 * rest * (eta[0] + eta[1])
            stiction.sensitivities(CODES[self.model], u[start:stop], eta[0], eta[1], position, part, slopes)
            x[start:stop], dx[:2, start:stop] = part, slopes

    def path(self, eta: FloatArray, u: FloatArray, x: FloatArray) -> None:
        """The position alone."""
        for start, stop, rest in _begun(self.segments, self.rests):
            position = u[start] + 0.5 * rest * (eta[0] + eta[1])
            x[start:stop] = stiction.run(CODES[self.model], u[start:stop], eta[0], eta[1], position)

    def valid(self, eta: FloatArray) -> FloatArray:
        """Band and jump in their range."""
        band = min(max(eta[0], 0.0), self.widest)
        return np.array([band, min(max(eta[1], 0.0), LARGEST_JUMP * band)])


@dataclass(frozen=True)
class SaturationFamily(Family):
    """Saturation; eta = low, high, each with samples beyond it or at the end of the range."""

    ends: tuple[float, float]
    kind: ClassVar[str] = "saturation"
    own: ClassVar[tuple[str, ...]] = ("low", "high")

    def act(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """Clamped command."""
        saturation.sensitivities(u, eta[0], eta[1], x, dx[:2])

    def valid(self, eta: FloatArray) -> FloatArray:
        """Limits in order and inside the range of OP."""
        low, high = sorted((float(eta[0]), float(eta[1])))
        return np.array([max(low, self.ends[0]), min(high, self.ends[1])])
