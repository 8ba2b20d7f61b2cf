"""Rows of the store from the diagnosis of a record alone, without a screen: as an audit would have them."""

from __future__ import annotations

import math
from datetime import datetime
from typing import Any

import numpy as np

from lostmotion.audit.assess import trace
from lostmotion.audit.assess.said import finite, said
from lostmotion.diagnose.diagnosis import Diagnosis
from lostmotion.diagnose.shown_rows import shown_rows
from lostmotion.plant import PlantLoop
from lostmotion.store.rows import AssessmentRow, Stage, TraceRow


def row_of(loop: PlantLoop, window_start: datetime, window_end: datetime, diagnosis: Diagnosis) -> AssessmentRow:
    """What a diagnosis says of a loop in a window; label, split and priority are left to who ranks."""
    record, performance, swing = diagnosis.record, diagnosis.performance, diagnosis.measured.pv
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
        period=finite(swing.period * record.dt),
        regularity=finite(swing.regularity),
        power=finite(swing.share),
        **_said(diagnosis),
    )


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
