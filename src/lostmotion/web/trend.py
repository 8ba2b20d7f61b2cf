"""A stretch of a record as a browser draws it: smallest and largest value of each pixel, so that no spike is lost."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.errors import ParameterError
from lostmotion.records import LoopRecord
from lostmotion.records.modes import rows_of

WIDEST = 4000  # pixels that are drawn apart
SIGNALS = ("sp", "pv", "op", "position")


def trend_of(record: LoopRecord, start: int, stop: int, width: int) -> dict[str, Any]:
    """Rows start to stop (exclusive) for a picture of so many pixels, JSON-ready.

    Parameters
    ----------
    record : LoopRecord
    start, stop : int
        Rows; cut to the record.
    width : int
        Pixels, 1 to 4000.

    Returns
    -------
    dict
        "t": seconds from the first row of the record, one for each value; "sp" .. "op": values, None where missing;
        "start", "stop", "rows", "dt"; "finest": every row is there; "shaded": stretches (from, to, what) of "manual",
        "missing" and "at a limit" in seconds.

    Raises
    ------
    ParameterError
        The width is none, or nothing lies between the rows.

    Examples
    --------
    >>> record = LoopRecord(op=range(1000), pv=[0.0] * 1000, dt=2.0)
    >>> trend_of(record, 0, 1000, 2)["op"], trend_of(record, 10, 13, 100)["t"]
    ([0.0, 499.0, 500.0, 999.0], [20.0, 22.0, 24.0])
    """
    if not 1 <= width <= WIDEST:
        raise ParameterError.expected(f"1 to {WIDEST} pixels", width, "give the width of the picture")
    first, last = max(start, 0), min(stop, len(record))
    if last <= first:
        raise ParameterError.expected("rows of the record", f"{start} to {stop}", f"it has {len(record)}")
    finest = last - first <= 2 * width
    edges = np.arange(first, last + 1) if finest else np.linspace(first, last, width + 1).astype(np.int64)
    found: dict[str, Any] = {"start": first, "stop": last, "rows": len(record), "dt": record.dt, "finest": finest}
    places = edges[:-1] if finest else np.column_stack([edges[:-1], (edges[:-1] + edges[1:]) // 2]).ravel()
    found["t"] = (places * record.dt).tolist()
    for name in SIGNALS:
        values = getattr(record, name)
        if values is not None:
            drawn = values[first:last] if finest else _extremes(values[first:last], edges - first)
            found[name] = [None if one != one else one for one in drawn.tolist()]  # noqa: PLR0124  NaN
    found["shaded"] = [
        (low * record.dt, high * record.dt, what) for low, high, what in _shaded(record, first, last, width)
    ]
    return found


def _extremes(values: FloatArray, edges: Any) -> FloatArray:
    """Smallest and largest of each stretch, in the order in which they come; NaN where nothing is known."""
    low = np.fmin.reduceat(values, edges[:-1])
    high = np.fmax.reduceat(values, edges[:-1])
    rising = values[edges[:-1]] <= values[edges[1:] - 1]
    return np.column_stack([np.where(rising, low, high), np.where(rising, high, low)]).ravel()


def _shaded(record: LoopRecord, first: int, last: int, width: int) -> Iterator[tuple[int, int, str]]:
    """Stretches that a diagnosis does not use; those closer than a pixel are one."""
    pixel = max((last - first) // width, 1)
    automatic = rows_of("automatic", record.mode)
    kinds = {"missing": record.missing[first:last]}
    if automatic is not None:
        kinds["manual"] = ~automatic[first:last]
    if record.op_span is not None:
        low, high = record.op_span
        margin = 1e-3 * (high - low)
        op = record.op[first:last]
        kinds["at a limit"] = (op <= low + margin) | (op >= high - margin)
    for what, rows in kinds.items():
        edges = np.flatnonzero(np.diff(np.concatenate([[False], rows, [False]]).astype(np.int8)))
        start = stop = None
        for low_row, high_row in edges.reshape(-1, 2).tolist():
            if stop is not None and low_row - stop < pixel:
                stop = high_row
                continue
            if start is not None and stop is not None:
                yield first + start, first + stop, what
            start, stop = low_row, high_row
        if start is not None and stop is not None:
            yield first + start, first + stop, what
