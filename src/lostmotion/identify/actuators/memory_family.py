"""Actuators with memory, as the likelihood sees them.

Memory begins anew at every segment: the valve rests somewhere inside its band, `rests` says where, as a share of half
the band off the first command. A stiff valve can stay there for hundreds of samples, so it is sought like the band. A
change of width that shifts a break-away by a sample makes x jump: the derivatives hold between such jumps, and
``kinks`` tells the optimiser that there are some.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import ClassVar

from lostmotion.arrays import IntArray
from lostmotion.identify.likelihood.family import Family
from lostmotion.identify.likelihood.problem import Problem

FIRST_RESTS = (0.0, -0.6, 0.6)  # of half the band, where a valve may begin, of a size that is held
SMALLEST, LARGEST = 0.01, 0.95  # of the range of OP: sizes that are sought


@dataclass(frozen=True)
class MemoryFamily(Family):
    """An actuator with memory whose first parameter, its size, lies in [0, widest]."""

    widest: float
    segments: IntArray = field(compare=False)
    kinks: ClassVar[bool] = True

    @property
    def resting(self) -> int:
        """Every segment begins at rest somewhere."""
        return len(self.segments)

    def begun(self) -> Iterator[tuple[int, int, float]]:
        """Start, stop and rest of every segment."""
        for index, (start, stop) in enumerate(self.segments.tolist()):
            yield start, stop, self.rests[index] if index < len(self.rests) else 0.0


def rests_of(problem: Problem) -> list[tuple[float, ...]]:
    """Places in the band where a valve of a given size may begin, the same in all segments."""
    return [(rest,) * len(problem.segments) for rest in FIRST_RESTS]
