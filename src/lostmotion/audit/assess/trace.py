"""The most telling stretch of a window as a small picture: for pages without the raw data."""

from __future__ import annotations

import json
from datetime import datetime

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.diagnosis import Diagnosis
from lostmotion.records import LoopRecord
from lostmotion.store.rows import TraceRow

POINTS = 1200


def trace_of(
    tag: str, window_start: datetime, record: LoopRecord, place: int, rows: int, found: Diagnosis | None
) -> TraceRow:
    """Rows `place` .. `place + rows` of the record of a window.

    Parameters
    ----------
    record : LoopRecord
        Of the window.
    place, rows : int
        First row of the stretch, and how many.
    found : Diagnosis or None
        Whose actuator is drawn.
    """
    part = slice(place, min(place + rows, len(record)))
    sp = b"" if record.sp is None else packed(record.sp[part])
    length = (part.stop - part.start) * record.dt
    model = "" if found is None else model_of(found, record)
    return TraceRow(
        tag, window_start, place * record.dt, length, sp, packed(record.pv[part]), packed(record.op[part]), model
    )


def packed(values: FloatArray) -> bytes:
    """Up to 1,200 little-endian float32; of a longer signal smallest and largest of each part, as they came."""
    return envelope(values).astype("<f4").tobytes()


def envelope(values: FloatArray) -> FloatArray:
    """The signal itself, or smallest and largest of 600 parts of it in the order in which they came.

    Examples
    --------
    >>> values = np.sin(np.arange(10_000) / 50.0)
    >>> short = envelope(values)
    >>> short.size, bool(short.max() == values.max())
    (1200, True)
    """
    if values.size <= POINTS:
        return values
    edges = np.linspace(0, values.size, POINTS // 2 + 1).astype(np.int64)
    size = int(np.diff(edges).max())
    rows = np.minimum(edges[:-1, None] + np.arange(size), np.maximum(edges[1:, None] - 1, 0))
    parts = values[rows]
    low = np.argmin(np.where(np.isfinite(parts), parts, np.inf), axis=1)
    high = np.argmax(np.where(np.isfinite(parts), parts, -np.inf), axis=1)
    order = np.sort(np.stack([low, high], axis=1), axis=1)
    return np.take_along_axis(parts, order, axis=1).ravel()


def model_of(found: Diagnosis, record: LoopRecord) -> str:
    """JSON: `actuator` as it describes itself, `size` the name of its size, `intervals` (95 %), units; "" if none."""
    fit = found.fit
    actuator = fit.model.nonlinearity.to_dict()
    names = [name for name in fit.parameters if name in actuator or name == fit.kind.size]
    said = {
        "actuator": actuator,
        "size": fit.kind.size,
        "intervals": {name: [_plain(end) for end in fit.interval(name)] for name in names},
        "op_unit": record.op_unit,
        "pv_unit": record.pv_unit,
    }
    return json.dumps(said, sort_keys=True)


def _plain(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
