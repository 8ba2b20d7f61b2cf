"""What was said of a loop, beside the truth."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import lostmotion as lm
from one_ingredient.loops import Loop

LOST_MOTION = ("dead zone", "backlash", "stiction")
STICKING = ("backlash", "stiction")
FAULTS = (*LOST_MOTION, "saturation")
AT_ITS_LIMIT = ("clamped",)  # ingredients in which OP stands at an end of its span: a saturation, as the product has it
MET_OFTEN = 3  # times that OP goes through a fault which can be found
LEEWAY = 0.9  # of the truth: a bound below that is wrong

CANNOT_TELL, REFUSED = "cannot tell", "refused"
OF_SOUND = SAID_SOUND, _, LIMIT, ACCUSED, _ = (
    "said to be sound",
    CANNOT_TELL,
    "at its limit",
    "accused",
    REFUSED,
)
OF_FAULTY = RIGHT, OTHER_STICKING, OTHER_FAULT, CALLED_SOUND, _, _ = (
    "right",
    "the other sticking kind",
    "another fault",
    "called sound, or another oscillation",
    CANNOT_TELL,
    REFUSED,
)


@dataclass(frozen=True)
class Judged:
    """A loop and its verdict; sizes in % of OP, NaN where there is none."""

    ingredient: str
    seed: int
    kind: str  # of the fault that is there, or "none"
    friction: str  # rule of a sticking valve
    size: float
    met: int  # how often OP goes through the fault
    verdict: str  # or "refused"
    confidence: float = math.nan
    interval: tuple[float, float] = (math.nan, math.nan)
    excluded: dict[str, float] = field(default_factory=dict)
    cleared: bool = False

    @property
    def faulty(self) -> bool:
        """Whether there is a fault."""
        return self.kind != "none"

    @property
    def findable(self) -> bool:
        """Whether the fault is met often enough to be counted."""
        return self.met >= MET_OFTEN

    @property
    def judgement(self) -> str:
        """One of `OF_SOUND` or of `OF_FAULTY`."""
        if self.verdict in (REFUSED, CANNOT_TELL):
            return self.verdict
        if not self.faulty:
            if self.verdict not in FAULTS:
                return SAID_SOUND
            return LIMIT if self.verdict == "saturation" and self.ingredient in AT_ITS_LIMIT else ACCUSED
        if self.verdict == self.kind:
            return RIGHT
        if self.verdict not in FAULTS:
            return CALLED_SOUND
        return OTHER_STICKING if {self.verdict, self.kind} <= set(STICKING) else OTHER_FAULT

    @property
    def wrongly_cleared(self) -> bool:
        """Whether a faulty valve is cleared."""
        return self.faulty and self.cleared

    @property
    def sized(self) -> bool:
        """Whether an interval is given for a lost motion that is there."""
        known = self.kind in LOST_MOTION and self.verdict in LOST_MOTION
        return known and math.isfinite(self.interval[0]) and math.isfinite(self.interval[1])

    @property
    def held(self) -> bool:
        """Whether the interval holds the size."""
        return self.interval[0] <= self.size <= self.interval[1]

    @property
    def bound(self) -> float:
        """Largest size of the true kind that is said to be possible; infinite where nothing is said."""
        return self.excluded.get(self.kind, math.inf) if self.verdict not in FAULTS else math.inf

    @property
    def bounded(self) -> bool:
        """Whether such a bound is given for a lost motion that is there."""
        return self.kind in LOST_MOTION and math.isfinite(self.bound)

    @property
    def hidden(self) -> bool:
        """Whether the truth is above the bound."""
        return self.bounded and self.bound < self.size

    @property
    def well_hidden(self) -> bool:
        """Whether it is so by more than a tenth."""
        return self.bounded and self.bound < LEEWAY * self.size


def judged(loop: Loop, said: lm.Diagnosis | None) -> Judged:
    """The loop beside what was said; None: refused."""
    case = loop.case
    size = case.size if case.kind in LOST_MOTION else math.nan
    friction = case.friction if case.kind == "stiction" else ""
    truth = (loop.ingredient, loop.seed, case.kind, friction, size, loop.met)
    if said is None:
        return Judged(*truth, REFUSED)
    percent = loop.recording.percent
    interval = (said.interval[0] / percent, said.interval[1] / percent)
    excluded = {kind: bound / percent for kind, bound in said.excluded.items()}
    return Judged(*truth, said.verdict, said.confidence, interval, excluded, said.cleared)
