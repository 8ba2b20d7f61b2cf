"""What keeps a likely verdict from being said: the first objection that applies makes it "cannot tell"."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from lostmotion.diagnose.features import CARRIES, Measured
from lostmotion.diagnose.form_alone import without_proof
from lostmotion.diagnose.shown import ONE_SIGNAL, not_deniable, not_shown
from lostmotion.errors import Status
from lostmotion.identify import HammersteinFit
from lostmotion.identify.actuators.kind import NO_FAULT, faults

SWINGS = "other oscillation"


@dataclass(frozen=True)
class Case:
    """A verdict as the evidence would have it.

    Attributes
    ----------
    verdict : str
    fit : HammersteinFit
    measured : Measured
    accused : bool
        Whether a fault of the actuator is likelier than none.
    sticking : float
        Log-odds of a valve that sticks against none.
    level : bool
        Whether the process answers as a level.
    fed_back : bool
        Whether PV foretells all that moves OP.
    """

    verdict: str
    fit: HammersteinFit
    measured: Measured
    accused: bool
    sticking: float
    level: bool
    fed_back: bool

    @property
    def sticks(self) -> bool:
        """Whether the verdict is a valve that sticks."""
        return sticks(self.verdict)

    @property
    def unforetold(self) -> bool:
        """Whether no valve that sticks foretells PV better."""
        return self.measured.features.memory == 0.0


@dataclass(frozen=True)
class Objection:
    """Why a verdict is not said, in words, and the size in units of OP that the record would have to exclude."""

    why: str
    limit: float


def objection(case: Case) -> Objection | None:
    """The first that applies; None: the verdict is said."""
    for of_a_size, look in OBJECTIONS:
        if why := look(case):
            carried = CARRIES * float(np.ptp(case.fit.data.u))
            return Objection(why, case.fit.parameters.get("width", carried) if of_a_size else carried)
    return None


def sticks(verdict: str) -> bool:
    """Whether a verdict is a kind with a memory."""
    return any(kind.sticks for kind in faults() if kind.name == verdict)


def _undecided(case: Case) -> str:
    if case.verdict != "cannot tell":
        return ""
    if case.fit.status is Status.SAME_SIGNAL:
        return ONE_SIGNAL
    if case.fit.status is Status.CANNOT_TELL:
        return "OP hardly moves PV, or the feedback is an exact function of it"
    return "what speaks for a fault of the actuator and what speaks against one weigh about the same"


def _half_shown(case: Case) -> str:
    """Neither named nor denied; of a dead zone whose ends are vague the largest size is known, which may clear it."""
    if case.measured.negligible:
        return ""
    clears = case.verdict == NO_FAULT and case.fit.status is not Status.WIDE
    return not_shown(case.fit) if clears or case.verdict == case.fit.kind.name else ""


def _too_likely(case: Case) -> str:
    denied = case.verdict in (NO_FAULT, SWINGS) and not case.measured.negligible
    return not_deniable(case.fit) if denied else ""


def _beside_a_swing(case: Case) -> str:
    sticks_so = case.fit.kind.sticks and not case.measured.negligible
    if case.verdict != SWINGS or not case.measured.driven or not sticks_so:
        return ""
    return f"the swing comes from outside, but beside it a {case.fit.kind.name} fits best, by too little to be named"


def _by_its_wave(case: Case) -> str:
    if not case.sticks or not case.unforetold or (case.sticking >= 0.0 and case.level):
        return ""
    seems = "the wave looks as if the valve stuck, but" if case.sticking >= 0.0 else f"{_fits_best(case)}, and"
    return f"{seems} no valve that sticks foretells PV better"


def _fits_best(case: Case) -> str:
    name = case.fit.kind.name
    fits = "a valve without lost motion" if name == NO_FAULT else f"a {name}"
    return f"{fits} fits best, which makes no such wave"


def _by_form_alone(case: Case) -> str:
    return without_proof(case.verdict, case.measured, case.level, case.fed_back)


def _two_faults(case: Case) -> str:
    if not case.accused or case.sticking <= 0.0 or not case.unforetold or case.sticks:
        return ""
    return f"the likelihood is for a {case.verdict}, the wave for a valve that sticks, and each would do by itself"


# in order, and whether it is about the size that was found
OBJECTIONS: tuple[tuple[bool, Callable[[Case], str]], ...] = (
    (True, _undecided),
    (True, _half_shown),
    (True, _too_likely),
    (False, _beside_a_swing),
    (False, _by_its_wave),
    (False, _by_form_alone),
    (False, _two_faults),
)
