"""Backlash as the likelihood sees it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.memory_family import LARGEST, SMALLEST, MemoryFamily
from lostmotion.identify.likelihood.family import Grid
from lostmotion.kernels import backlash as kernel

GRID, ZOOM = 18, 6  # widths, and steps to either side between two of them: its likelihood has broad hills


@dataclass(frozen=True)
class BacklashFamily(MemoryFamily):
    """Play; eta = width, in [0, widest]."""

    kind: ClassVar[str] = "backlash"
    own: ClassVar[tuple[str, ...]] = ("width",)

    def act(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """Play from rest at the first command of each segment."""
        width = float(eta[0])
        for start, stop, rest in self.begun():
            slopes = np.empty((2, stop - start))
            kernel.sensitivities(u[start:stop], width, float(u[start]) + 0.5 * rest * width, x[start:stop], slopes)
            dx[0, start:stop] = slopes[0]

    def path(self, eta: FloatArray, u: FloatArray, x: FloatArray) -> None:
        """The play alone."""
        for start, stop, rest in self.begun():
            x[start:stop] = kernel.run(u[start:stop], eta[0], u[start] + 0.5 * rest * eta[0])

    def valid(self, eta: FloatArray) -> FloatArray:
        """Width in its range."""
        return np.array([min(max(eta[0], 0.0), self.widest)])

    def grid(self, u: FloatArray, span: float, rows: int) -> Grid:
        """Widths from a hundredth of the range to nearly all of it."""
        del u, rows
        widths = span * np.geomspace(SMALLEST, LARGEST, GRID)
        ratio = (widths[1] / widths[0]) ** np.linspace(-1, 1, 2 * ZOOM + 1)
        return [np.array([width]) for width in widths], lambda eta: [np.array([eta[0] * step]) for step in ratio]
