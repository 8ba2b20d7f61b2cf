"""A telling stretch as a small picture with the actuator that was fitted: for pages without the raw data."""

from __future__ import annotations

import json
from datetime import datetime
from typing import Any

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.audit.assess.said import finite
from lostmotion.diagnose.diagnosis import Diagnosis
from lostmotion.records import LoopRecord
from lostmotion.records.outline import outline
from lostmotion.store.rows import TraceRow

MOST_POINTS = 1200  # of a signal


def trace_of(tag: str, window_start: datetime, start: float, part: LoopRecord, found: Diagnosis) -> TraceRow:
    """Picture of a part of a record.

    Parameters
    ----------
    start : float
        Seconds from the start of the window to that of the part.
    part : LoopRecord
    found : Diagnosis
        Whose actuator is drawn.
    """
    sp = part.sp if part.sp is not None and np.isfinite(part.sp).any() else None
    return TraceRow(
        tag=tag,
        window_start=window_start,
        start=start,
        seconds=len(part) * part.dt,
        sp=b"" if sp is None else _points(sp),
        pv=_points(part.pv),
        op=_points(part.op),
        model=model_of(found),
    )


def _points(values: FloatArray) -> bytes:
    """Little-endian float32."""
    return values[outline(values, MOST_POINTS)].astype("<f4").tobytes()


def model_of(found: Diagnosis) -> str:
    """Fitted actuator as JSON: its parameters, their 95 % intervals, and where OP was; "" where the verdict is another.

    Keys: "actuator" (``to_dict()`` of the model), "size" (name of the parameter), "intervals" by parameter,
    "fit_percent", "gain" (static, of the process), "op" (lowest and highest of what was diagnosed), units.
    """
    fit, record = found.fit, found.record
    if fit.kind.name != found.verdict or fit.kind.name == "none":
        return ""
    ends: dict[str, tuple[float, float]] = {
        name: fit.interval(name) for name in ("left", "right") if name in fit.parameters
    }
    if fit.kind.size is not None:
        ends[fit.kind.size] = found.interval
    data: dict[str, Any] = {
        "actuator": fit.nonlinearity.to_dict(),
        "size": fit.kind.size,
        "intervals": {name: [finite(end) for end in both] for name, both in ends.items()},
        "fit_percent": finite(fit.fit_percent),
        "gain": finite(fit.linear.gain),
        "op": [finite(float(np.nanmin(record.op))), finite(float(np.nanmax(record.op)))],
        "op_unit": record.op_unit,
        "pv_unit": record.pv_unit,
    }
    return json.dumps(data, sort_keys=True, allow_nan=False)
