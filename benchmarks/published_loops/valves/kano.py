"""S and J with a memory of where the stem stopped (Kano, Maruta, Kugemoto and Shimizu 2004)."""

from __future__ import annotations

from dataclasses import dataclass

from published_loops.valves.valve import ScannedStem, label_of, sticking_kind


@dataclass(frozen=True)
class Kano:
    """S, dead band and stick band, and J, slip jump, % of OP; J > S: the stem overshoots."""

    size: float
    jump: float

    @property
    def label(self) -> str:
        return label_of("kano", self.size, self.jump)

    @property
    def kind(self) -> str:
        return sticking_kind(self.jump)

    def stem(self, place: float, _seconds: float) -> ScannedStem:
        return _Stem(place, self.size, self.jump)


class _Stem(ScannedStem):
    """It came from below: (S - J) / 2 behind the command."""

    def __init__(self, place: float, size: float, jump: float) -> None:
        super().__init__(place - (size - jump) / 2)
        self.before = place
        self.size, self.jump = size, jump
        self.stands, self.stopped_at, self.way = True, place, 1.0
        self.last_move = 0.0  # of the command, other than none

    def follow(self, command: float) -> float:
        moved = command - self.before
        if not self.stands and moved * self.last_move <= 0:
            self.stands, self.stopped_at = True, self.before
        if self.stands:
            onward = self.way * (command - self.stopped_at)
            if -onward > self.size:
                self.way, self.stands = -self.way, False
            elif onward > self.jump:
                self.stands = False
        if moved != 0:
            self.last_move = moved
        return self.place if self.stands else command - self.way * (self.size - self.jump) / 2
