"""Static and dynamic friction as thresholds of a balance of forces: S = fS + fD, J = fS - fD.

He, Wang, Pottmann and Qin 2007: the stem sticks anew after each move. Chen, Tan and Huang 2008: it slides on until the
command stands or turns.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from published_loops.valves.valve import ScannedStem, label_of, sticking_kind


@dataclass(frozen=True)
class He:
    """Static and dynamic band, each % of OP."""

    static: float
    dynamic: float
    model = "he"
    slides = False

    @property
    def label(self) -> str:
        return label_of(self.model, self.static, self.dynamic)

    @property
    def kind(self) -> str:
        return sticking_kind(self.jump)

    @property
    def size(self) -> float:
        return self.static + self.dynamic

    @property
    def jump(self) -> float:
        return self.static - self.dynamic

    def stem(self, place: float, _seconds: float) -> ScannedStem:
        return (_SlidingStem if self.slides else _Stem)(place, self.static, self.dynamic)


@dataclass(frozen=True)
class Chen(He):
    """As `He`, and slides on."""

    model = "chen"
    slides = True


class _Stem(ScannedStem):
    def __init__(self, place: float, static: float, dynamic: float) -> None:
        super().__init__(place)
        self.static, self.dynamic = static, dynamic
        self.residual = 0.0  # force that the stem has not answered, over the spring

    def follow(self, command: float) -> float:
        force = self.residual + command - self.before
        if abs(force) <= self.static:
            self.residual = force
            return self.place
        self.residual = math.copysign(self.dynamic, force)
        return self.place + force - self.residual


class _SlidingStem(_Stem):
    way = 0.0  # 0: it sticks

    def follow(self, command: float) -> float:
        if (command - self.before) * self.way > 0:
            return self.place + command - self.before
        place = super().follow(command)
        self.way = math.copysign(1.0, place - self.place) if place != self.place else 0.0
        return place
