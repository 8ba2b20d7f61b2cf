"""Which of the loops that swing together is the source: what speaks for each, and whether that is enough."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.audit.groups.swinging import Swinging
from lostmotion.store.rows import AssessmentRow, Stage

LEAST_SURE = 0.6  # share of the odds that a source must have to be named
LEAST_LEAD = 2.0  # odds over the next
CERTAIN = 0.97  # what a verdict can at most be worth
BLAMED = 0.75  # probability from which on a valve is blamed; of less sure verdicts every second one is a neighbour's
BY_BLAME = 1.0  # log odds of such a verdict beside its own: neighbours that are carried along get none
OUTSIDE = 1.2  # log odds that it is none of them: nor do harmonics alone name a loop
BY_TUNING = 0.6  # of its log odds: what a swing reaches can look as near the limit of stability as its source
NOT_SEEN = -1.0  # of one in which a diagnosis sees nothing that could make it swing
NO_OWN = -1.5  # of a loop that swings only because it is carried along: it has no period of its own
DISTURBED = -1.5  # of one whose diagnosis says that it is disturbed
USUAL_HARMONICS, LEAST_HARMONICS = 0.03, 0.005  # over the power of the oscillation, of one that has passed a process
BY_HARMONICS, MOST_BY_HARMONICS = 0.8, 1.6
BY_NONLINEARITY, MOST_NONLINEARITY = 0.4, 3.0  # per unit above 1, the limit of the statistic
BY_POWER = 2.0  # per unit of the share of the variance
STEADY, WANDERS = 0.1, 0.4  # spread of an amplitude: noise builds up none below; of a loop that rings it is about 0.5
BY_PURITY, MOST_PURITY = 2.0, 8.0  # of a loop that rings: log odds per log odds of the share of the variance
USUAL_REGULAR = 20.0  # of loops that ring: their median in simulated plants


RINGING = "it rings like a loop that hardly settles: its amplitude comes and goes"


@dataclass(frozen=True)
class Suspect:
    """One loop of a group.

    Attributes
    ----------
    loop : Swinging
    likeness : float
    score : float
        Log odds of being the source, up to a constant.
    why : tuple of str
        What speaks for it most.
    spoken : bool
        Whether a diagnosis says that its valve or its tuning makes it swing.
    """

    loop: Swinging
    likeness: float
    score: float
    why: tuple[str, ...]
    spoken: bool


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


def suspect(loop: Swinging, likeness: float, period: float, own: bool) -> Suspect:
    """Weigh what the rows say of one loop; `own`: it swings with a period of its own."""
    nonlinear = _nonlinearity(loop)
    if own and _rings(loop, nonlinear):
        return Suspect(loop, likeness, _purity(loop), (RINGING,), True)
    verdict, said = _verdict(loop)
    harmonics = loop.harmonics(period)
    by_form = BY_HARMONICS * float(np.log((harmonics + LEAST_HARMONICS) / USUAL_HARMONICS))
    coupled = 0.0 if nonlinear is None else float(np.clip(nonlinear - 1.0, -1.0, MOST_NONLINEARITY))
    score = verdict
    if own and not any(row.kind == "tuning" for row in loop.rows):  # a linear loop that hardly settles makes neither
        form = loop.power * float(np.clip(by_form, -MOST_BY_HARMONICS, MOST_BY_HARMONICS))  # the rest is noise
        score += form + BY_NONLINEARITY * coupled
    score += BY_POWER * loop.power if own else NO_OWN
    why = [said] if said else []
    if by_form > 0.0 and own:
        why.append(f"harmonics are {100.0 * harmonics:.0f} % of its oscillation")
    if nonlinear is not None and nonlinear > 1.0:
        why.append("its phases are coupled")
    return Suspect(loop, likeness, score, tuple(why), bool(said))


def _rings(loop: Swinging, nonlinear: float | None) -> bool:
    """Whether a loop swings as a linear one that hardly settles: noise builds its amplitude up and takes it away.

    A limit cycle and what is forced from outside keep their amplitude.
    """
    valve = any(row.kind == "actuator" for row in loop.rows)
    return not valve and (loop.spread or 0.0) >= WANDERS and (nonlinear is None or nonlinear < 1.0)


def _purity(loop: Swinging) -> float:
    """Log odds of a loop that rings: on every way noise is added, so the source swings purest and most regularly."""
    power = float(np.clip(loop.power, 0.01, 0.99))
    regular = float(np.median([row.regularity or 1.0 for row in loop.rows]))
    found = BY_PURITY * np.log(power / (1.0 - power)) + np.log(regular / USUAL_REGULAR)
    return float(np.clip(found, -MOST_PURITY, MOST_PURITY))


def name(suspects: Sequence[Suspect]) -> Named:
    """The likely source, where one stands out; a valve is blamed only where a diagnosis of it says so."""
    order = sorted(suspects, key=lambda one: (-one.score, one.loop.tag))
    odds = _odds(np.array([one.score for one in order]))
    first = order[0]
    second = order[1] if len(order) > 1 else None
    if first.spoken and odds[0] >= LEAST_SURE and (second is None or odds[0] >= LEAST_LEAD * odds[1]):
        return Named(first.loop.tag, float(odds[0]), f"{first.loop.tag}: {'; '.join(first.why)}")
    outside = 1.0 - float(odds.sum())
    if outside >= LEAST_SURE:
        return Named("", None, "cannot tell: no loop of them looks like the source; it may come from outside")
    if second is None or odds[0] >= LEAST_LEAD * odds[1]:
        return Named(
            "", None, f"cannot tell: {first.loop.tag} is the most suspect, but no diagnosis speaks for it enough"
        )
    return Named("", None, f"cannot tell: {first.loop.tag} and {second.loop.tag} are too close")


def _odds(scores: FloatArray) -> FloatArray:
    """Shares of the odds, the outside among them."""
    most = max(float(scores.max()), OUTSIDE)
    raised = np.exp(scores - most)
    return np.asarray(raised / (raised.sum() + np.exp(OUTSIDE - most)))


def _verdict(loop: Swinging) -> tuple[float, str]:
    """Log odds that the diagnoses of a loop give, the strongest of its windows; and their words."""
    found = [_of_row(row, loop.spread) for row in loop.rows if row.stage is Stage.ASSESSED]
    return max(found, key=lambda one: abs(one[0])) if found else (0.0, "")


def _of_row(row: AssessmentRow, spread: float | None) -> tuple[float, str]:
    if row.kind == "actuator":
        sure = row.confidence if row.probability is None else row.probability
        if (sure or 0.0) < BLAMED:
            return _log_odds(sure), ""
        return _log_odds(sure) + BY_BLAME, f"{row.verdict} of its valve (probability {100.0 * (sure or 0.5):.0f} %)"
    if row.kind == "tuning" and (spread is None or spread < STEADY):
        return NOT_SEEN, ""  # a swing of that form, but nothing shows that the loop itself makes it
    if row.kind == "tuning":
        said = f"its tuning makes it swing (confidence {100.0 * (row.confidence or 0.5):.0f} %)"
        return BY_TUNING * _log_odds(row.confidence), said
    if row.kind == "disturbance":
        return DISTURBED, ""
    return (NOT_SEEN if row.probability is None else min(_log_odds(row.probability), 0.0)), ""


def _log_odds(probability: float | None) -> float:
    sure = float(np.clip(0.5 if probability is None else probability, 1.0 - CERTAIN, CERTAIN))
    return float(np.log(sure / (1.0 - sure)))


def _nonlinearity(loop: Swinging) -> float | None:
    known = [value for one in loop.spectra for value in (one.nonlinearity, one.op_nonlinearity) if value is not None]
    return max(known) if known else None
