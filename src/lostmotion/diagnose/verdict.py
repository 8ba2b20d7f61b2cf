"""From features to a verdict: whether it is the actuator by calibrated log-odds, then which fault by likelihood."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.diagnose.features import Features, Measured
from lostmotion.diagnose.loop_stability import LoopStability
from lostmotion.diagnose.objections import SWINGS, Case, objection, sticks
from lostmotion.diagnose.weights import CONSTANTS, NAMES, OF_STICKING, WEIGHTS
from lostmotion.errors import Status
from lostmotion.identify import HammersteinFit
from lostmotion.identify.actuators.kind import NO_FAULT, faults

SURE = 0.5  # least probability of a fault: in calm simulated loops no alarm is above it (docs/diagnosis.md)
CLEARED = 0.55  # least probability of none
CLEAR = 3.0  # of log-likelihood, by which backlash must beat stiction in a loop that looks as if the valve slipped
TRIANGLE = 0.1  # He's index above 0.6, the published limit
LIMITED = 0.1  # share of the time with OP at a limit, from which on that is what is wrong
MOSTLY = 0.5  # of the time with OP at a limit: what is left does not show a valve that sticks
OUTSIDE = 0.5  # share of the moves of OP that PV does not explain, from which on PV is not what OP controls


@dataclass(frozen=True)
class Verdict:
    """What is wrong, where it comes from, and how probable that is.

    Attributes
    ----------
    verdict, kind : str
        As in Diagnosis.
    confidence : float
        Probability of a fault of the actuator, or of none, whichever the verdict says; of a dead zone or a saturation
        times that of the kind.
    probabilities : dict of float
        Of "none" and "actuator".
    contributions : dict of (float, float)
        Value of each feature and what it adds to the log-odds of a fault.
    why : str
        Why it cannot be told, where the record leaves open what the verdict would deny.
    limit : float
        Where `why` is said: the size in units of OP that the record would have to exclude.
    advice : tuple of str
        What would tell, where that is no test of the valve.
    """

    verdict: str
    kind: str
    confidence: float
    probabilities: dict[str, float]
    contributions: dict[str, tuple[float, float]]
    why: str = ""
    limit: float = float("nan")
    advice: tuple[str, ...] = ()


def fault_probability(features: Features) -> float:
    """Probability that the actuator is at fault."""
    sticking, other = log_odds(features)
    return float(1.0 - 1.0 / (1.0 + np.exp(sticking) + np.exp(other)))


def log_odds(features: Features) -> tuple[float, float]:
    """Of a valve that sticks, and of another fault of the actuator, both against none."""
    parts = np.array(WEIGHTS) * features.values()
    return float(CONSTANTS[0] + parts[OF_STICKING].sum()), float(CONSTANTS[1] + parts[~OF_STICKING].sum())


def _contributions(features: Features) -> dict[str, tuple[float, float]]:
    """Value and weight of all features of the likelier fault, and of those of the other that are there."""
    sticking, other = log_odds(features)
    counts = [bool(mine) == (sticking >= other) for mine in OF_STICKING]
    values = zip(NAMES, features.values().tolist(), WEIGHTS, counts, strict=True)
    return {name: (value, weight * value if mine else 0.0) for name, value, weight, mine in values if mine or value}


def decide(
    fit: HammersteinFit,
    measured: Measured,
    stability: LoopStability | None,
    quantised: bool,
    limited: float,
    fed_back: bool = False,
) -> Verdict:
    """Verdict of one loop.

    Parameters
    ----------
    fit : HammersteinFit
    measured : Measured
    stability : LoopStability or None
    quantised : bool
        Whether PV moves in coarse steps.
    limited : float
        Share of the rows with OP at a limit.
    fed_back : bool
        Whether nothing but PV moves OP: the roots of the loop are then those of the swing, whoever makes it.
    """
    features = measured.features
    chance = fault_probability(features)
    parts = _contributions(features)
    sticking, other = log_odds(features)
    if chance > SURE:
        verdict, kind = _fault(fit, measured, sticking > other), "actuator"
    elif chance < 1.0 - CLEARED:
        verdict, kind = _no_fault(fit, measured, stability, quantised, fed_back)
    else:
        verdict, kind = "cannot tell", "unknown"
    level = _answers_as_a_level(fit, measured)
    found = objection(Case(verdict, fit, measured, chance > SURE, sticking, level, fed_back))
    why, limit = "", float("nan")
    if found is not None:
        verdict, kind, why, limit = "cannot tell", "unknown", found.why, found.limit
    sure = max(chance, 1.0 - chance) * (_among_kinds(fit) if verdict == fit.kind.name else 1.0)
    if limits_decide(verdict, limited):
        # that OP stands there is seen; whose fault that is, is not, and what else may be wrong speaks for no limit
        sure = max(sure, SURE) if verdict == "saturation" else SURE
        verdict, kind, why = "saturation", "actuator", ""
    probabilities = {"none": 1.0 - chance, "actuator": chance}
    return Verdict(verdict, kind, sure, probabilities, parts, why, limit)


def limits_decide(verdict: str, limited: float) -> bool:
    """Whether OP is at a limit for so large a share of the time that this is what is wrong, whatever else was said."""
    return limited > (MOSTLY if sticks(verdict) else LIMITED)


def _no_fault(
    fit: HammersteinFit, measured: Measured, stability: LoopStability | None, quantised: bool, fed_back: bool
) -> tuple[str, str]:
    own = stability is not None and stability.unexplained < OUTSIDE  # else OP is moved from outside, not by this loop
    if measured.swings and measured.driven:
        return SWINGS, "set point" if measured.commanded else "disturbance"
    if not measured.swings or stability is None or not own:
        silent = fit.status in (Status.CANNOT_TELL, Status.SAME_SIGNAL)
        return ("cannot tell", "unknown") if silent else ("none", "none")
    if quantised:
        return SWINGS, "sensor"
    if fed_back:
        return SWINGS, "unknown"
    return SWINGS, "tuning" if stability.explains(measured.period) else "disturbance"


def _fault(fit: HammersteinFit, measured: Measured, sticking_likelier: bool) -> str:
    """Kind of the fault.

    The likelihood names it, among the kinds that stick or the others, whichever are likelier by all evidence, but for
    what cannot be in a loop with a PI controller that swings by itself. A dead zone only lowers the gain of a
    self-regulating loop: it lets a tight loop swing near its critical frequency, as a sine, but makes no triangles and
    squares; a level it lets swing in any shape (the paper's tank). Neither does a saturation, anywhere. And a dead band
    alone does not make a self-regulating loop swing for ever (its describing function does not meet the response of the
    loop; Choudhury, Thornhill and Shah, 2005): where such a loop does, and the likelihood does not say clearly that the
    valve never slips, it slips.
    """
    best = fit.kind
    swings = measured.swings and not measured.driven
    angular = swings and measured.features.shape > TRIANGLE
    level = _answers_as_a_level(fit, measured)
    likelihoods = fit.kinds.likelihoods if fit.kinds is not None else {}
    sticking = max(likelihoods.get(kind.name, 0.0) for kind in faults() if kind.sticks)
    possible = not angular or best.angular == "always" or (best.angular == "level" and (level or sticking <= 0.0))
    if best.name != NO_FAULT and not best.sticks and possible and not sticking_likelier:
        return best.name
    ahead = likelihoods.get("backlash", 0.0) - likelihoods.get("stiction", 0.0)
    if angular and not level:
        return "backlash" if ahead > CLEAR else "stiction"
    if best.sticks:
        return best.name
    return "backlash" if ahead > 0.0 else "stiction"


def _among_kinds(fit: HammersteinFit) -> float:
    """Probability of a kind that does not stick among the kinds; backlash and stiction are one fault of two names."""
    compared = fit.kinds
    if compared is None or fit.kind.sticks or NO_FAULT in (compared.best, compared.runner_up):
        return 1.0
    return compared.confidence if compared.best == fit.kind.name else 1.0


def _answers_as_a_level(fit: HammersteinFit, measured: Measured) -> bool:
    """Whether the process integrates, or lags so far behind the swing that it answers as an integrator does."""
    slowest = float(np.abs(fit.linear.poles).max(initial=0.0))
    return measured.integrating or slowest >= 1.0 or fit.linear.slowest_lag(within=1.0) > measured.period
