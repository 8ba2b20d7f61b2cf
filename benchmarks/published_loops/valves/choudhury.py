"""S and J by the flow chart of Choudhury, Thornhill and Shah 2005.

The stick band is counted from the last turn of the command, also where the stem has not moved since the turn before: a
command with noise keeps such a stem longer than S. Kano's chart was made for that.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from published_loops.valves.valve import ScannedStem, label_of, sticking_kind


@dataclass(frozen=True)
class Choudhury:
    """S, dead band and stick band, and J, slip jump, % of OP."""

    size: float
    jump: float

    @property
    def label(self) -> str:
        return label_of("choudhury", self.size, self.jump)

    @property
    def kind(self) -> str:
        return sticking_kind(self.jump)

    def stem(self, place: float, _seconds: float) -> ScannedStem:
        return _Stem(place, self.size, self.jump)


class _Stem(ScannedStem):
    def __init__(self, place: float, size: float, jump: float) -> None:
        super().__init__(place)
        self.size, self.jump = size, jump
        self.from_here = place  # command from which the band is counted: x_ss
        self.rested = False  # the command stood: I = 1
        self.way = 0.0

    def follow(self, command: float) -> float:
        way = float(np.sign(command - self.before))
        if way == 0.0:
            if not self.rested:
                self.rested, self.from_here = True, self.before
            return self.place
        if way == -self.way:
            self.from_here, self.rested = self.before, False
        self.way = way
        gone = abs(command - self.from_here)
        if self.rested:
            if gone <= self.jump:
                return self.place
            self.rested, self.from_here = False, command - 2.0 * way * self.size  # it slides from now on
        elif gone <= self.size:
            return self.place
        return command - way * (self.size - self.jump) / 2
