"""What a diagnosis says, as fields of a row: one mapping, of a window of an audit and of a record alone."""

from __future__ import annotations

import math
from typing import Any

from lostmotion.compensate.gate import closed
from lostmotion.diagnose.diagnosis import Diagnosis
from lostmotion.diagnose.evidence_words import balance
from lostmotion.diagnose.loop_stability import EXACT
from lostmotion.diagnose.op_span import op_span

SIZED = ("dead zone", "backlash", "stiction")


def said(found: Diagnosis) -> dict[str, Any]:
    """Verdict with its size, sizes left open, confidence, reasons and numbers; what is not known is None.

    A size that is left open is inf where a valve that never moves would look the same. `indices` hold "op_span" (units
    of OP), "op_span_known" (0: % are of the range seen, or of one of several spans that OP may have, which then is
    "op_span_assumed"), "tolerance" (units of OP), "closed_loop", "integrating", "gate_open" (1: the gate and the study
    let this fit pass), "log_odds" (all that the lines of evidence add up to), and every index by its name, as far as
    they are finite.
    """
    low, high = found.interval
    return {
        "status": found.fit.status.name,
        "verdict": found.verdict,
        "kind": found.kind,
        "size": finite(found.size),
        "low": finite(low),
        "high": finite(high),
        "size_percent": finite(found.size_percent),
        **_left_open(found),
        "confidence": finite(found.confidence),
        "probability": finite(found.probabilities.get("actuator", math.nan)),
        "severity": found.severity,
        "why": found.why,
        "advice": found.advice,
        "evidence": tuple((item.name, _number(item.value), _number(item.weight)) for item in found.evidence),
        "indices": _indices(found),
    }


def _left_open(found: Diagnosis) -> dict[str, float | None]:
    """Largest size of each kind that is not excluded; none where a fault is named: its interval says more."""
    sizes = {} if found.kind == "actuator" else found.excluded
    each = {f"excluded_{name.replace(' ', '_')}": _open(sizes.get(name)) for name in SIZED}
    largest = _open(max(sizes.values(), default=None))
    return each | {"excluded_percent": None if largest is None else largest / op_span(found.record).percent}


def _open(size: float | None) -> float | None:
    return None if size is None or math.isnan(size) else float(size)


def _gate_open(found: Diagnosis) -> bool:
    """Whether `lostmotion simulate` takes the fit: its gate is open, and a PI explains the moves of OP."""
    if found.verdict not in SIZED or found.stability is None or found.stability.unexplained >= EXACT:
        return False
    return closed(found.fit.facts, found) is None


def _indices(found: Diagnosis) -> dict[str, float]:
    """All that is a finite number."""
    span, stability = op_span(found.record), found.stability
    known: dict[str, float] = {
        **found.measured.indices,
        "op_span": 100.0 * span.percent,
        "op_span_known": float(span.known),
        "tolerance": found.tolerance,
        "closed_loop": float(found.fit.evidence.closed_loop),
        "integrating": float(found.measured.integrating),
        "harris_worst": found.performance.harris[1],
        "fit_percent": found.fit.fit_percent,
        "gate_open": float(_gate_open(found)),
        "log_odds": balance(found.probabilities, ()).total,
    }
    if stability is not None:
        known |= {"damping": stability.damping, "closed_loop_period": stability.period * found.record.dt}
    if span.others:
        known["op_span_assumed"] = 100.0 * span.percent
    return {name: float(value) for name, value in known.items() if math.isfinite(value)}


def finite(value: float) -> float | None:
    """The number, or None where it is none."""
    return float(value) if math.isfinite(value) else None


def _number(value: float) -> float:
    """What a line of evidence can hold: 0 for what is not known."""
    return float(value) if math.isfinite(value) else 0.0
