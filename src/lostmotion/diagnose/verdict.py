"""From features to a verdict: calibrated log-odds, then what physics and the likelihood say about the kind."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.diagnose.controller import LoopStability
from lostmotion.diagnose.features import Features, Measured
from lostmotion.diagnose.weights import CLASSES, NAMES, WEIGHTS
from lostmotion.errors import Status
from lostmotion.identify import HammersteinFit

SURE = 0.6  # least probability of a verdict
FAULTS = ("dead zone", "backlash", "stiction", "saturation")
LIMITED = 0.1  # share of the time with OP at a limit, from which on that is what is wrong
CLEAR = 3.0  # of log density, by which stiction must beat backlash where both are possible


@dataclass(frozen=True)
class Verdict:
    """What is wrong, where it comes from, and how probable that is.

    Attributes
    ----------
    verdict, kind : str
        As in Diagnosis.
    confidence : float
    probabilities : dict of float
        Of CLASSES.
    contributions : dict of (float, float)
        Value of each feature and what it adds to the log-odds of the most probable fault against none.
    """

    verdict: str
    kind: str
    confidence: float
    probabilities: dict[str, float]
    contributions: dict[str, tuple[float, float]]


def probabilities(features: Features) -> dict[str, float]:
    """Softmax of the calibrated log-odds of CLASSES."""
    scores = WEIGHTS @ np.append(1.0, features.values())
    scores = np.exp(scores - scores.max())
    return dict(zip(CLASSES, (scores / scores.sum()).tolist(), strict=True))


def decide(
    fit: HammersteinFit, measured: Measured, stability: LoopStability | None, quantised: bool, limited: float
) -> Verdict:
    """Verdict of one loop; `limited` is the share of the rows with OP at a limit."""
    found = probabilities(measured.features)
    best = max(found, key=lambda name: found[name])
    fault = max((name for name in found if name != "none"), key=lambda name: found[name])
    row = WEIGHTS[CLASSES.index(fault)] - WEIGHTS[CLASSES.index("none")]
    values = measured.features.values()
    parts = {name: (float(values[i]), float(row[i + 1] * values[i])) for i, name in enumerate(NAMES)}
    verdict, kind = _name(best, found[best], fit, measured, stability, quantised)
    if verdict not in FAULTS and limited > LIMITED:
        verdict, kind = "saturation", "actuator"  # seen in OP itself: the controller stands at a limit
    return Verdict(verdict, kind, found[best], found, parts)


def _name(
    best: str,
    probability: float,
    fit: HammersteinFit,
    measured: Measured,
    stability: LoopStability | None,
    quantised: bool,
) -> tuple[str, str]:
    swings = measured.features.oscillating > 0.0
    if probability < SURE:
        return "cannot tell", "unknown"
    if best == "none":
        if swings:
            return "other oscillation", _other(measured, stability, quantised)
        silent = fit.status is Status.CANNOT_TELL
        return ("cannot tell", "unknown") if silent else ("none", "none")
    return (_sticking(fit, measured, swings) if best == "sticking" else best), "actuator"


def _other(measured: Measured, stability: LoopStability | None, quantised: bool) -> str:
    if quantised:
        return "sensor"
    if stability is None:
        return "unknown"
    return "tuning" if stability.explains(measured.period) else "disturbance"


def _sticking(fit: HammersteinFit, measured: Measured, swings: bool) -> str:
    """Stiction or backlash.

    A dead band alone does not make a self-regulating loop with a PI controller swing for ever (its describing
    function does not meet the loop's response; Choudhury, Thornhill and Shah, 2005): where such a loop does, the
    valve slips.
    """
    gains = fit.kinds.gains if fit.kinds is not None else {}
    if swings and not measured.integrating:
        return "stiction"
    if "stiction" not in gains:
        return "backlash" if "backlash" in gains else "stiction"
    return "stiction" if gains["stiction"] - gains.get("backlash", -np.inf) > CLEAR else "backlash"
