"""Rows of the store from a diagnosis: the assessment, and the picture of what it was seen in."""

from __future__ import annotations

import json
import math
from datetime import datetime
from typing import Any

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.diagnosis import Diagnosis
from lostmotion.diagnose.op_span import op_span
from lostmotion.diagnose.shown_rows import shown_rows
from lostmotion.plant import PlantLoop
from lostmotion.records import LoopRecord
from lostmotion.records.outline import outline
from lostmotion.store.rows import AssessmentRow, Stage, TraceRow

MOST_POINTS = 1200  # of a signal in a trace


def row_of(loop: PlantLoop, window_start: datetime, window_end: datetime, diagnosis: Diagnosis) -> AssessmentRow:
    """What a diagnosis says of a loop in a window; label, split and priority are left to who ranks.

    An excluded size is inf where a valve that never moves would look the same. `indices` hold "op_span" (units of OP),
    "op_span_known" (0: % are of the range seen), "tolerance" (units of OP), "integrating" and every index by name.
    """
    record, performance = diagnosis.record, diagnosis.performance
    span, swing = op_span(record), diagnosis.measured.pv
    percent = span.percent
    low, high = diagnosis.interval
    largest = max(diagnosis.excluded.values(), default=math.nan)
    return AssessmentRow(
        tag=loop.tag,
        window_start=window_start,
        window_end=window_end,
        fingerprint=record.fingerprint,
        stamp=loop.stamp,
        stage=Stage.ASSESSED,
        status=diagnosis.fit.status.name,
        verdict=diagnosis.verdict,
        kind=diagnosis.kind,
        size=_known(diagnosis.size),
        low=_known(low),
        high=_known(high),
        size_percent=_known(diagnosis.size_percent),
        excluded_dead_zone=_open_size(diagnosis, "dead zone"),
        excluded_backlash=_open_size(diagnosis, "backlash"),
        excluded_stiction=_open_size(diagnosis, "stiction"),
        excluded_percent=None if math.isnan(largest) else largest / percent,
        confidence=diagnosis.confidence,
        probability=diagnosis.probabilities.get("actuator"),
        severity=diagnosis.severity,
        performance=performance.audit_class,
        rows=len(record),
        dt=record.dt,
        manual=performance.manual,
        limited=performance.limited,
        missing=float(record.missing.mean()),
        travel=_known(performance.travel),
        reversals=_known(performance.reversals),
        variability=_variability(diagnosis),
        harris=_known(performance.harris[0]),
        period=_known(swing.period * record.dt),
        regularity=_known(swing.regularity),
        power=_known(swing.share),
        why=diagnosis.why,
        advice=diagnosis.advice,
        evidence=tuple((item.name, item.value, item.weight) for item in diagnosis.evidence),
        indices=_indices(diagnosis, 100.0 * percent, known=span.known),
    )


def trace_of(loop: PlantLoop, window_start: datetime, diagnosis: Diagnosis) -> TraceRow:
    """The stretch that shows the verdict best, and the actuator that was fitted."""
    rows, first = shown_rows(diagnosis)
    record = diagnosis.record
    at, began = record.moment(first), record.moment(0)
    start = first * record.dt if at is None or began is None else (at - began).total_seconds()
    sp = rows.sp if rows.sp is not None and np.isfinite(rows.sp).any() else None
    return TraceRow(
        tag=loop.tag,
        window_start=window_start,
        start=start,
        seconds=len(rows) * rows.dt,
        sp=b"" if sp is None else _points(sp),
        pv=_points(rows.pv),
        op=_points(rows.op),
        model=_model(diagnosis, rows),
    )


def _known(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _open_size(diagnosis: Diagnosis, kind: str) -> float | None:
    size = diagnosis.excluded.get(kind, math.nan)
    return None if math.isnan(size) else float(size)


def _variability(diagnosis: Diagnosis) -> float | None:
    """Deviation of the error of control in % of the span of PV, of its own range where no span is known."""
    record = diagnosis.record
    low, high = record.pv_span or (float(np.nanmin(record.pv)), float(np.nanmax(record.pv)))
    return _known(100.0 * math.sqrt(diagnosis.performance.variance) / (high - low)) if high > low else None


def _indices(diagnosis: Diagnosis, width: float, known: bool) -> dict[str, float]:
    """All that is a finite number."""
    stability = diagnosis.stability
    found: dict[str, float] = {
        **diagnosis.measured.indices,
        "op_span": width,
        "op_span_known": float(known),
        "tolerance": diagnosis.tolerance,
        "integrating": float(diagnosis.measured.integrating),
        "harris_worst": diagnosis.performance.harris[1],
    }
    if stability is not None:
        found |= {"damping": stability.damping, "closed_loop_period": stability.period * diagnosis.record.dt}
    return {name: float(value) for name, value in found.items() if math.isfinite(value)}


def _points(values: FloatArray) -> bytes:
    """Little-endian float32."""
    return values[outline(values, MOST_POINTS)].astype("<f4").tobytes()


def _model(diagnosis: Diagnosis, rows: LoopRecord) -> str:
    """Fitted actuator as JSON: its parameters, their 95 % intervals, and where OP was; "" where the verdict is another.

    Keys: "actuator" (``to_dict()`` of the model), "size" (name of the parameter), "intervals" by parameter,
    "fit_percent", "gain" (static, of the process), "op" (lowest and highest of the whole record).
    """
    fit = diagnosis.fit
    if fit.kind.name != diagnosis.verdict or fit.kind.name == "none":
        return ""
    names = [name for name in ("left", "right", fit.kind.size) if name in fit.parameters]
    intervals = {str(name): [_known(end) for end in fit.interval(str(name))] for name in names}
    data: dict[str, Any] = {
        "actuator": fit.nonlinearity.to_dict(),
        "size": fit.kind.size,
        "intervals": intervals,
        "fit_percent": _known(fit.fit_percent),
        "gain": _known(fit.linear.gain),
        "op": [_known(float(np.nanmin(diagnosis.record.op))), _known(float(np.nanmax(diagnosis.record.op)))],
        "op_unit": rows.op_unit,
        "pv_unit": rows.pv_unit,
    }
    return json.dumps(data, allow_nan=False)
