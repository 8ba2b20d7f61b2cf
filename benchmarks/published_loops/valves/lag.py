"""An actuator that needs time in front of a valve: a first-order lag, stepped within the row."""

from __future__ import annotations

import math
from dataclasses import dataclass

from published_loops.meters import Meter
from published_loops.valves.valve import Stem, Valve

STEPS = 20  # in a row


@dataclass(frozen=True)
class Behind:
    """A valve behind a lag in seconds; its size is that of the command behind the lag."""

    lag: float
    valve: Valve

    @property
    def label(self) -> str:
        return f"{self.valve.label}-lag-{self.lag:g}"

    @property
    def kind(self) -> str:
        return self.valve.kind

    @property
    def size(self) -> float:
        return self.valve.size

    @property
    def jump(self) -> float:
        return self.valve.jump

    def stem(self, place: float, seconds: float) -> Stem:
        share = 1 - math.exp(-seconds / STEPS / self.lag)
        return _Stem(self.valve.stem(place, seconds / STEPS), place, share)


class _Stem:
    def __init__(self, inner: Stem, place: float, share: float) -> None:
        self.inner, self.command, self.share = inner, place, share

    @property
    def meter(self) -> Meter:
        return self.inner.meter

    def move(self, op: float) -> float:
        total = 0.0
        for _ in range(STEPS):
            self.command += self.share * (op - self.command)
            total += self.inner.move(self.command)
        return total / STEPS
