"""Backlash: the play that lies between a command and its valve."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.actuator_lag import Lag
from lostmotion.identify.actuators.backlash_family import BacklashFamily
from lostmotion.identify.actuators.kind import Kind, Words, register
from lostmotion.identify.actuators.lagged_backlash import backlash_lag
from lostmotion.identify.actuators.memory_family import rests_of
from lostmotion.identify.likelihood.family import Family
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.problem import Problem
from lostmotion.identify.scaled import ScaledData
from lostmotion.models import Backlash

FEWEST_TURNS = 2  # of the play: with one, a step of load does as well


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

    def lag(self, fitted: Fitted) -> Lag:
        """With the pole free beside the width."""
        return backlash_lag(fitted)

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
