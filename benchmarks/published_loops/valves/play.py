"""Backlash: pushed by either flank (Hägglund 2007; Nordin and Gutman 2002)."""

from __future__ import annotations

from dataclasses import dataclass

from published_loops.valves.valve import ScannedStem, label_of


@dataclass(frozen=True)
class Play:
    """Full width of the play, % of OP."""

    width: float
    kind = "backlash"
    jump = 0.0

    @property
    def label(self) -> str:
        return label_of("play", self.width)

    @property
    def size(self) -> float:
        return self.width

    def stem(self, place: float, _seconds: float) -> ScannedStem:
        return _Stem(place, self.width / 2)


class _Stem(ScannedStem):
    def __init__(self, place: float, half: float) -> None:
        super().__init__(place)
        self.half = half

    def follow(self, command: float) -> float:
        return min(max(self.place, command - self.half), command + self.half)
