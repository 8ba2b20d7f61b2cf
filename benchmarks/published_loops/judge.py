"""What was said of a loop, beside the truth."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

import lostmotion as lm
from published_loops.closed_loop import HIGHEST, LOWEST
from published_loops.loops import PublishedLoop

STICKING = ("backlash", "stiction")
LOST_MOTION = ("dead zone", *STICKING)
FAULTS = (*LOST_MOTION, "saturation")
CANNOT_TELL, REFUSED = "cannot tell", "refused"
NEAR = 0.15  # of the true size
AT_ITS_END = 0.1  # share of rows with OP at an end from which "saturation" of a sound valve is no accusation


@dataclass(frozen=True)
class Judged:
    """A loop and its verdict; sizes in % of OP, NaN where there is none."""

    name: str
    paper: str
    model: str
    course: str
    kind: str
    size: float
    jump: float
    turns: int
    reason: str  # why the record cannot tell; empty where it can
    at_end: float  # share of rows with OP at an end of its range
    verdict: str  # or "refused"
    confidence: float = math.nan
    said: float = math.nan
    interval: tuple[float, float] = (math.nan, math.nan)
    cleared: bool = False
    bound: float = math.inf  # largest size of the true kind that is said to be possible
    why: str = ""

    @property
    def faulty(self) -> bool:
        return self.kind != "none"

    @property
    def counted(self) -> bool:
        """Whether the record can tell what is there."""
        return not self.reason

    @property
    def named(self) -> bool:
        """Whether a fault of the actuator is named: of a sound valve with OP at its end, "saturation" is none."""
        if self.verdict == "saturation" and not self.faulty:
            return self.at_end < AT_ITS_END
        return self.verdict in FAULTS

    @property
    def accused(self) -> bool:
        return not self.faulty and self.named

    @property
    def open(self) -> bool:
        return self.verdict in (CANNOT_TELL, REFUSED)

    @property
    def called_sound(self) -> bool:
        """By its verdict, whatever size is left open beside it."""
        return not self.named and not self.open

    @property
    def right_kind(self) -> bool:
        return self.faulty and self.verdict == self.kind

    @property
    def sized(self) -> bool:
        """Whether a size is given to a lost motion that is there."""
        return self.faulty and self.verdict in LOST_MOTION and math.isfinite(self.said)

    @property
    def near(self) -> bool:
        return self.sized and abs(self.said - self.size) <= NEAR * self.size

    @property
    def held(self) -> bool:
        return self.sized and self.interval[0] <= self.size <= self.interval[1]

    @property
    def hidden(self) -> bool:
        """Whether the true size is said to be excluded."""
        return self.faulty and not self.named and self.bound < self.size

    @property
    def cause_is_right(self) -> bool:
        """Whether a claim is right about a fault or none."""
        return self.named is self.faulty


def judged(loop: PublishedLoop, said: lm.Diagnosis | None) -> Judged:
    """The loop beside what was said; None: refused."""
    truth, op = loop.truth, loop.recorded.op
    facts: dict[str, Any] = {
        "name": loop.case.name,
        "paper": loop.case.plant.paper,
        "model": type(loop.case.valve).__name__,
        "course": loop.case.course.words,
        "kind": truth.kind,
        "size": truth.size,
        "jump": truth.jump,
        "turns": truth.turns,
        "reason": truth.reason,
        "at_end": float(np.mean((op <= LOWEST) | (op >= HIGHEST))),
    }
    if said is None:
        return Judged(**facts, verdict=REFUSED)
    bound = said.excluded.get(truth.kind, math.inf) if said.verdict not in FAULTS else math.inf
    return Judged(
        **facts,
        verdict=said.verdict,
        confidence=said.confidence,
        said=said.size,
        interval=(said.interval[0], said.interval[1]),
        cleared=said.cleared,
        bound=bound,
        why=said.why,
    )
