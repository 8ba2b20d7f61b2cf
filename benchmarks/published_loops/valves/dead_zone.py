"""Dead zone without memory (Tao and Kokotovic 1996): inside it nothing moves, outside its half is lost."""

from __future__ import annotations

import math
from dataclasses import dataclass

from published_loops.meters import Crossings
from published_loops.valves.valve import ScannedStem, label_of


@dataclass(frozen=True)
class DeadZone:
    """Full width of the zone, % of OP; its middle is where the loop starts."""

    width: float
    kind = "dead zone"
    jump = 0.0

    @property
    def label(self) -> str:
        return label_of("deadzone", self.width)

    @property
    def size(self) -> float:
        return self.width

    def stem(self, place: float, _seconds: float) -> ScannedStem:
        return _Stem(place, self.width / 2)


class _Stem(ScannedStem):
    def __init__(self, place: float, half: float) -> None:
        super().__init__(place, Crossings(place))
        self.middle, self.half = place, half

    def follow(self, command: float) -> float:
        away = command - self.middle
        return self.middle if abs(away) <= self.half else command - math.copysign(self.half, away)
