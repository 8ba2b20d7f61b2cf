"""One parameter (Stenman, Gustafsson and Forsman 2003): the stem stands until OP is d away, then is where OP is."""

from __future__ import annotations

from dataclasses import dataclass

from published_loops.valves.valve import ScannedStem, label_of


@dataclass(frozen=True)
class Stenman:
    """Threshold d, % of OP: S = J = d."""

    threshold: float
    kind = "stiction"

    @property
    def label(self) -> str:
        return label_of("stenman", self.threshold)

    @property
    def size(self) -> float:
        return self.threshold

    @property
    def jump(self) -> float:
        return self.threshold

    def stem(self, place: float, _seconds: float) -> ScannedStem:
        return _Stem(place, self.threshold)


class _Stem(ScannedStem):
    def __init__(self, place: float, threshold: float) -> None:
        super().__init__(place)
        self.threshold = threshold

    def follow(self, command: float) -> float:
        return command if abs(command - self.place) > self.threshold else self.place
