"""A valve without a fault."""

from __future__ import annotations

from dataclasses import dataclass

from published_loops.valves.valve import ScannedStem


@dataclass(frozen=True)
class Sound:
    """The stem is where OP is."""

    label = "sound"
    kind = "none"
    size = 0.0
    jump = 0.0

    def stem(self, place: float, _seconds: float) -> ScannedStem:
        return _Stem(place)


class _Stem(ScannedStem):
    def follow(self, command: float) -> float:
        return command
