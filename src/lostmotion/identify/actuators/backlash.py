"""Backlash: the play that lies between a command and its valve."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.kind import Kind, Words, register
from lostmotion.identify.actuators.memory_family import LARGEST, SMALLEST, MemoryFamily, rests_of
from lostmotion.identify.likelihood.family import Family, Grid
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.problem import Problem
from lostmotion.identify.scaled import ScaledData
from lostmotion.kernels import backlash as kernel
from lostmotion.models import Backlash

FEWEST_TURNS = 2  # of the play: with one, a step of load does as well
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


class BacklashKind(Kind):
    """Play between command and valve."""

    model = Backlash
    family = BacklashFamily
    evidence = "memory"
    angular = "always"
    sticks = True
    searched = 2.5
    words = Words(
        wider="Backlash wider than",
        plural="backlashes",
        meanings={"width": "full width"},
        advice=(
            "Look for play in linkage, pins and feedback arm of the positioner.",
            "Until then a backlash compensator (`lostmotion simulate`, then `export`), or a positioner that sees the "
            "stem, takes it away.",
        ),
        advice_for_levels=("Behind a level a dead band makes the loop cycle for ever; a smaller integral gain helps.",),
    )

    def forms(self, data: ScaledData) -> list[Family]:
        """One, up to the range of OP."""
        return [BacklashFamily(float(np.ptp(data.u)), data.segments)]

    def of_size(self, problem: Problem, size: float) -> Iterator[tuple[Family, FloatArray]]:
        """From several places in the band."""
        for rests in rests_of(problem):
            yield BacklashFamily(size, problem.segments, rests=rests), np.array([size])

    def met(self, fitted: Fitted) -> bool:
        """The play is taken up in one direction, in the other, and again."""
        problem = fitted.problem
        x = np.empty(problem.u.size)
        problem.family.path(fitted.actuator, problem.u, x)
        turns = 0
        for start, stop in problem.segments.tolist():
            moves = np.sign(np.diff(x[start:stop]))
            turns += int(np.count_nonzero(np.diff(moves[moves != 0.0])))
        return turns >= FEWEST_TURNS


BACKLASH = register(BacklashKind())
