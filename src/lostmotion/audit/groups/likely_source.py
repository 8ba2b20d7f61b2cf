"""Which of the loops that swing together is the source: what speaks for each, and whether that is enough."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.audit.groups.swinging import Swinging
from lostmotion.audit.measurement import stuck
from lostmotion.diagnose.control_error.amplitude import STEADY, WANDERS
from lostmotion.store.rows import AssessmentRow, Stage

# Share of the odds that a source must have to be named; of 89 groups of plants left out 80 are found, none wrong (0.6:
# 81 and 1), and as many where masters are no source at all; 79 where a master counts as any other loop.
LEAST_SURE = 0.65
LEAST_LEAD = 2.0  # odds over the next
CERTAIN = 0.97  # what a verdict can at most be worth
MOST_PURITY, PUREST = 16.0, 0.999  # log odds; share of the variance, of which no more is known
USUAL_REGULAR = 20.0  # of loops that ring: their median in simulated plants
COUPLED = 1.0, 3.0  # limit of the statistic of coupled phases, and what counts beyond it

# Log odds of being the source per unit of `facts`; of none of them (from outside) per unit of `facts_of_outside`.
# Fitted by benchmarks/audit/group_weights.py on simulated plants that decide nothing else.
WEIGHTS = {
    "valve": 1.94, "valve named": 0.98, "tuning": 1.01, "no fault named": 0.48, "purity": 1.20, "share": 0.55,
    "carried along": -0.73,
}  # fmt: skip
OUTSIDE = {"always": 0.08, "coupled phases": 0.90, "steady amplitude": 1.16}

RINGING = "it rings like a loop that hardly settles: its amplitude comes and goes"


@dataclass(frozen=True)
class Suspect:
    """One loop of a group.

    Attributes
    ----------
    loop : Swinging
    likeness : float
    own : bool
        Whether it swings with a period of its own.
    facts : dict of str to float
        What speaks for it or against, by the names of WEIGHTS.
    why : str
        What its diagnosis or its form says in words; empty: neither says that its valve or its tuning makes it swing.
    """

    loop: Swinging
    likeness: float
    own: bool
    facts: dict[str, float]
    why: str

    @property
    def score(self) -> float:
        """Log odds of being the source, up to a constant."""
        return sum(WEIGHTS[name] * value for name, value in self.facts.items())

    @property
    def rings(self) -> bool:
        """Whether it swings as a linear loop that hardly settles."""
        return "purity" in self.facts


@dataclass(frozen=True)
class Named:
    """Who it was.

    Attributes
    ----------
    tag : str
        Empty: cannot tell.
    confidence : float or None
    why : str
    """

    tag: str
    confidence: float | None
    why: str


def suspect(loop: Swinging, likeness: float, own: bool, master: bool = False) -> Suspect:
    """Weigh what the rows say of one loop; `own`: it swings with a period of its own; `master`: it has no valve.

    Notes
    -----
    A master that does not ring is carried along: nothing of its own can make it swing. Harmonics and coupled phases of
    a loop do not count for it: in simulated plants they tell nothing of the source that a diagnosis has not said,
    because a swing that comes from outside has them as well.
    """
    if own and _rings(loop):
        return Suspect(loop, likeness, own, {"purity": _purity(loop)}, RINGING)
    facts, why = _of_verdicts(loop)
    how = {"share": 2.0 * loop.power - 1.0} if own and not master else {"carried along": 1.0}
    return Suspect(loop, likeness, own, facts | how, why)


def facts_of_outside(suspects: Sequence[Suspect]) -> dict[str, float]:
    """What speaks for a source that is none of them, by the names of OUTSIDE.

    Something that is not linear and keeps its amplitude makes the swing; the more so, the more sure a verdict must be
    that blames a valve of the group.
    """
    own = [one for one in suspects if one.own]
    known = [value for one in own if not one.rings and (value := _nonlinearity(one.loop)) is not None]
    limit, most = COUPLED
    return {
        "always": 1.0,
        "coupled phases": float(np.clip(max(known) - limit, -limit, most)) if known else 0.0,
        "steady amplitude": float(any((one.loop.spread or np.inf) < STEADY for one in own)),
    }


def _rings(loop: Swinging) -> bool:
    """Whether a loop swings as a linear one that hardly settles: noise builds its amplitude up and takes it away.

    A limit cycle and what is forced from outside keep their amplitude, or their period varies with it. Where the period
    does not, coupled phases are those of a swing so wide that the characteristic of the valve bends it.
    """
    valve = any(row.kind == "actuator" for row in loop.rows)
    return not valve and _wanders(loop) == 1.0 and (not _coupled(loop) or _regular(loop) >= USUAL_REGULAR)


def _purity(loop: Swinging) -> float:
    """Log odds of a loop that rings: on every way noise is added, so the source swings purest and most regularly."""
    power = float(np.clip(loop.power, 1.0 - PUREST, PUREST))
    found = 2.0 * np.log(power / (1.0 - power)) + np.log(_regular(loop) / USUAL_REGULAR)
    return float(np.clip(found, -MOST_PURITY, MOST_PURITY))


def _regular(loop: Swinging) -> float:
    """Regularity of its period, median of the windows."""
    return float(np.median([row.regularity or 1.0 for row in loop.rows]))


def name(suspects: Sequence[Suspect]) -> Named:
    """The likely source, where one stands out; a valve is blamed only where a diagnosis of it says so."""
    order = sorted(suspects, key=lambda one: (-one.score, one.loop.tag))
    outside = sum(OUTSIDE[name] * value for name, value in facts_of_outside(order).items())
    odds = odds_of(np.array([one.score for one in order]), outside)
    first = order[0]
    second = order[1] if len(order) > 1 else None
    if stands_out(odds, bool(first.why)):
        return Named(first.loop.tag, float(odds[0]), f"{first.loop.tag}: {first.why}")
    if 1.0 - float(odds.sum()) >= LEAST_SURE:
        return Named("", None, "cannot tell: no loop of them looks like the source; it may come from outside")
    if second is not None and _close(odds):
        return Named("", None, f"cannot tell: {first.loop.tag} and {second.loop.tag} are too close")
    return Named("", None, f"cannot tell: {first.loop.tag} is the most suspect, but no diagnosis speaks for it enough")


def stands_out(odds: FloatArray, spoken: bool) -> bool:
    """Whether the first of these shares, the largest first, is named; `spoken`: something in words speaks for it."""
    return bool(spoken and odds[0] >= LEAST_SURE and not _close(odds))


def _close(odds: FloatArray) -> bool:
    return bool(odds.size > 1 and odds[0] < LEAST_LEAD * odds[1])


def odds_of(scores: FloatArray, outside: float) -> FloatArray:
    """Share of each in the odds; what is left is the outside's."""
    most = max(float(scores.max()), outside)
    raised = np.exp(scores - most)
    return np.asarray(raised / (raised.sum() + np.exp(outside - most)))


def _of_verdicts(loop: Swinging) -> tuple[dict[str, float], str]:
    """What the diagnoses of a loop say, the strongest of its windows; and their words."""
    wanders = 0.0 if _coupled(loop) else _wanders(loop)
    told = [row for row in loop.rows if row.stage is Stage.ASSESSED and not stuck(row)]  # of a PV that moved
    found = [_of_row(row, wanders) for row in told]
    return max(found, key=lambda one: sum(map(abs, one[0].values()))) if found else ({}, "")


def _coupled(loop: Swinging) -> bool:
    """Whether something that is not linear ties its phases."""
    nonlinear = _nonlinearity(loop)
    return nonlinear is not None and nonlinear >= COUPLED[0]


def _wanders(loop: Swinging) -> float:
    """How far its amplitude comes and goes: 0 steady, 1 as that of a loop that rings."""
    spread = loop.spread or 0.0
    return min(spread / WANDERS, 1.0) if spread >= STEADY else 0.0


def _of_row(row: AssessmentRow, wanders: float) -> tuple[dict[str, float], str]:
    if row.kind == "actuator":
        sure = row.confidence if row.probability is None else row.probability
        said = f"{row.verdict} of its valve (probability {100.0 * (sure or 0.5):.0f} %)"
        return {"valve": _log_odds(sure), "valve named": 1.0}, said
    if row.kind == "tuning" and wanders:  # noise builds up a swing of a linear loop, and takes it away
        said = f"its tuning makes it swing (confidence {100.0 * (row.confidence or 0.5):.0f} %)"
        return {"tuning": wanders * _log_odds(row.confidence)}, said
    return ({} if row.probability is None else {"no fault named": _log_odds(row.probability)}), ""


def _log_odds(probability: float | None) -> float:
    sure = float(np.clip(0.5 if probability is None else probability, 1.0 - CERTAIN, CERTAIN))
    return float(np.log(sure / (1.0 - sure)))


def _nonlinearity(loop: Swinging) -> float | None:
    known = [value for one in loop.spectra for value in (one.nonlinearity, one.op_nonlinearity) if value is not None]
    return max(known) if known else None
