"""From the summed evidence of many records to a verdict."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

from lostmotion.diagnose.features import is_negligible
from lostmotion.diagnose.op_span import SOUND, OpSpan
from lostmotion.diagnose.pooled.evidence import Evidence
from lostmotion.identify.actuators.kind import NO_FAULT

PRIOR = -1.0  # log-odds of a fault before any evidence, as in the diagnosis of one record
SURE = 0.55  # least probability of a verdict, as there
SEVERAL = 3  # records from which on one of them may not carry the verdict
HALF = 0.5  # of a difference between kinds counts: each is the best of many places (as in a single record)


@dataclass(frozen=True)
class PooledVerdict:
    """What all records say together.

    Attributes
    ----------
    verdict, kind : str
        As in Diagnosis.
    likeliest : str
        Kind of fault with the most evidence, named or not.
    probabilities : dict of float
        Of "none" and "actuator".
    kind_confidence : float
        Probability of `likeliest` among the kinds.
    excluded : dict of float
        Largest size of every kind that all records together do not exclude, units of OP; empty where a fault is named.
    carried_by : int or None
        Record (of those heard) without which the verdict would be another.
    why : str
        Why it cannot be told.
    """

    verdict: str
    kind: str
    likeliest: str
    probabilities: dict[str, float]
    kind_confidence: float
    excluded: dict[str, float]
    carried_by: int | None
    why: str = ""

    @property
    def confidence(self) -> float:
        """Of the more probable of fault and none."""
        return max(self.probabilities.values())


def weigh(evidence: Evidence, limit: float, span: OpSpan, swing: str) -> PooledVerdict:
    """Verdict on the actuator.

    Parameters
    ----------
    evidence : Evidence
    limit : float
        Lost motion that does not matter, units of OP.
    span : OpSpan
    swing : str
        Where most records swing and are not said to do so because of the actuator: where it comes from; else "".
    """
    totals = evidence.totals()
    chance, likeliest, named = _chance(totals), _likeliest(totals), _named(totals)
    sure = _among_kinds(totals, likeliest)
    others = [_named(evidence.totals(without=number)) for number in range(evidence.records)]
    alone = [number for number, other in enumerate(others) if other != named]
    carried = max(alone, key=lambda number: abs(evidence.gains(likeliest)[number]), default=None)
    excluded = {name: one.largest() for name, one in evidence.sized.items()}
    largest = evidence.sized[named].largest_known if named in evidence.sized else np.inf
    if is_negligible(largest, SOUND * limit, evidence.swing):
        excluded[named] = largest
        chance, named = _probability(PRIOR), NO_FAULT  # what a sound valve has is no evidence of a fault
    probabilities = {NO_FAULT: 1.0 - chance, "actuator": chance}
    if named in totals and named != NO_FAULT:
        doubt = _doubt(totals, likeliest, sure, carried is not None and evidence.records >= SEVERAL)
        verdict, kind = ("cannot tell", "unknown") if doubt else (named, "actuator")
        return PooledVerdict(verdict, kind, likeliest, probabilities, sure, {}, carried, doubt)
    worst = max(excluded, key=lambda name: excluded[name])
    if named == NO_FAULT and excluded[worst] < limit:
        verdict, kind = ("other oscillation", swing) if swing else (NO_FAULT, "none")
        return PooledVerdict(verdict, kind, likeliest, probabilities, sure, excluded, carried)
    why = _why(named, likeliest, worst, excluded[worst], limit, span)
    return PooledVerdict("cannot tell", "unknown", likeliest, probabilities, sure, excluded, carried, why)


def _doubt(totals: dict[str, float], likeliest: str, sure: float, carried: bool) -> str:
    """Why a fault that is probable is not named; "" where it is."""
    if sure < SURE:
        others = (name for name in totals if name not in (NO_FAULT, likeliest))
        other = max(others, key=lambda name: totals[name])
        return f"the records together speak for {likeliest} or {other}, and do not tell these apart"
    return "one record carries the evidence, the others do not bear it out" if carried else ""


def _named(totals: dict[str, float]) -> str:
    """A kind of fault, "none", or "" where neither is probable enough."""
    chance = _chance(totals)
    if chance > SURE:
        return _likeliest(totals)
    return NO_FAULT if chance < 1.0 - SURE else ""


def _chance(totals: dict[str, float]) -> float:
    """Probability of a fault of any kind."""
    faults = [value for name, value in totals.items() if name != NO_FAULT]
    return _probability(PRIOR + float(logsumexp(faults)) - float(np.log(len(faults))))


def _probability(odds: float) -> float:
    return float(1.0 / (1.0 + np.exp(-np.clip(odds, -700.0, 700.0))))


def _likeliest(totals: dict[str, float]) -> str:
    return max((name for name in totals if name != NO_FAULT), key=lambda name: totals[name])


def _among_kinds(totals: dict[str, float], kind: str) -> float:
    values = HALF * np.array([value for name, value in totals.items() if name != NO_FAULT])
    return float(np.exp(HALF * totals[kind] - logsumexp(values)))


def _why(named: str, likeliest: str, worst: str, size: float, limit: float, span: OpSpan) -> str:
    if named != NO_FAULT:
        return f"the records together speak for {likeliest}, but not clearly enough"
    said = f"up to {size / span.percent:.2g} % {span.words}" if np.isfinite(size) else "of any size"
    return f"{worst} {said} is not excluded by all records together; the tolerance is {limit / span.percent:.2g} %"
