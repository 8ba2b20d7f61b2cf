"""Rows of the store from the diagnosis of a record alone, without a screen: as an audit would have them."""

from __future__ import annotations

import math
from datetime import datetime
from typing import Any

import numpy as np

from lostmotion.audit.assess import trace
from lostmotion.audit.assess.said import finite, said
from lostmotion.audit.rules import RULES, Rule
from lostmotion.diagnose.control_error.amplitude import ErrorOscillation
from lostmotion.diagnose.diagnosis import Diagnosis
from lostmotion.diagnose.shown_rows import shown_rows
from lostmotion.plant import PlantLoop
from lostmotion.store.rows import AssessmentRow, Stage, TraceRow


def row_of(loop: PlantLoop, window_start: datetime, window_end: datetime, diagnosis: Diagnosis) -> AssessmentRow:
    """What a diagnosis says of a loop in a window; label, split and priority are left to who ranks."""
    record, performance, swing = diagnosis.record, diagnosis.performance, _oscillation(diagnosis)
    rule = _rule(diagnosis)
    return AssessmentRow(
        tag=loop.tag,
        window_start=window_start,
        window_end=window_end,
        fingerprint=diagnosis.fingerprint,
        stamp=loop.stamp,
        stage=Stage.ASSESSED,
        performance=performance.audit_class,
        rows=len(record),
        dt=record.dt,
        manual=performance.manual,
        limited=performance.limited,
        missing=float(record.missing.mean()),
        travel=finite(performance.travel),
        reversals=finite(performance.reversals),
        variability=_variability(diagnosis),
        harris=finite(performance.harris[0]),
        period=finite(swing.period),
        regularity=finite(swing.regularity),
        power=finite(swing.power),
        rule="" if rule is None else rule.name,
        priority_reason="" if rule is None else f"{rule.opening}; {diagnosis.why}".removesuffix("; "),
        **_said(diagnosis),
    )


def _oscillation(diagnosis: Diagnosis) -> ErrorOscillation:
    """That of the error of control, as an audit screens it; of PV where the whole record was not looked at for it."""
    if diagnosis.error_oscillation is not None:
        return diagnosis.error_oscillation
    pv = diagnosis.measured.pv
    return ErrorOscillation(pv.period * diagnosis.record.dt, pv.regularity, pv.share)


def _rule(diagnosis: Diagnosis) -> Rule | None:
    """The rule of an audit that says where the oscillation comes from; None: the diagnosis says it."""
    return next((rule for rule in RULES.values() if diagnosis.source and rule.where == diagnosis.source), None)


def _said(diagnosis: Diagnosis) -> dict[str, Any]:
    found = said(diagnosis)
    return found | {"indices": {**found["indices"], "pv_span_known": float(diagnosis.record.pv_span is not None)}}


def trace_of(loop: PlantLoop, window_start: datetime, diagnosis: Diagnosis) -> TraceRow:
    """The stretch that shows the verdict best, and the actuator that was fitted."""
    rows, first = shown_rows(diagnosis)
    record = diagnosis.record
    at, began = record.moment(first), record.moment(0)
    start = first * record.dt if at is None or began is None else (at - began).total_seconds()
    return trace.trace_of(loop.tag, window_start, start, rows, diagnosis)


def _variability(diagnosis: Diagnosis) -> float | None:
    """Deviation of the error of control in % of the span of PV, of its own range where no span is known."""
    record = diagnosis.record
    low, high = record.pv_span or (float(np.nanmin(record.pv)), float(np.nanmax(record.pv)))
    return finite(100.0 * math.sqrt(diagnosis.performance.variance) / (high - low)) if high > low else None
