"""What the measured position adds to a diagnosis: the actuator is seen, where PV shows it through the process only."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np

from lostmotion.actuator import ActuatorResponse, actuator_response
from lostmotion.actuator.response import SEEN_CONFIDENCE
from lostmotion.diagnose.advice import advise
from lostmotion.diagnose.diagnosis import Diagnosis
from lostmotion.diagnose.op_span import op_span
from lostmotion.records import LoopRecord

Found = TypeVar("Found", bound=Diagnosis)
OUTVOTED = ("none", "cannot tell", "other oscillation")  # verdicts from PV that name no fault of the actuator


def judged_by_position(found: Found, record: LoopRecord) -> Found:
    """The diagnosis with `actuator`, and with its kind as the verdict where PV names no fault.

    A fault that PV names stays the verdict: it may lie behind the position transmitter, in a loose linkage.
    """
    if record.position is None or not np.isfinite(record.position).any():
        return found
    response = actuator_response(record)
    found = replace(found, actuator=response)
    return _with_verdict(found, response) if _matters(found, response) else found


def _matters(found: Diagnosis, response: ActuatorResponse) -> bool:
    """Whether the position shows a fault larger than the tolerance, and PV none."""
    fault = response.status.identified and response.kind != "none"
    return fault and found.verdict in OUTVOTED and response.interval[0] > found.tolerance


def _with_verdict(found: Found, response: ActuatorResponse) -> Found:
    span = op_span(found.record)
    severity = span.severity_of(response.kind, "actuator", response.dead_band)
    return replace(
        found,
        verdict=response.kind,
        kind="actuator",
        severity=severity,
        size=response.dead_band,
        interval=response.interval,
        size_percent=response.dead_band / span.percent,
        confidence=SEEN_CONFIDENCE,
        probabilities={"none": 1.0 - SEEN_CONFIDENCE, "actuator": SEEN_CONFIDENCE},
        advice=advise(response.kind, "actuator", severity, found.measured.integrating, found.measured.swings),
        notes=(*found.notes, f"The verdict is that of the measured position; from PV alone it was: {found.verdict}."),
        excluded={},
        why="",
        source="",
    )
