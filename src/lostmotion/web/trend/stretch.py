"""A stretch of a record as a browser draws it: smallest and largest value of each pixel, so that no spike is lost."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.errors import ParameterError
from lostmotion.records import LoopRecord
from lostmotion.web.trend.columns import Columns
from lostmotion.web.trend.pyramid import Pyramid, Rows

WIDEST = 4000  # pixels that are drawn apart


def trend_of(record: LoopRecord | Columns, start: int, stop: int, width: int) -> dict[str, Any]:
    """Rows start to stop (exclusive) for a picture of so many pixels, JSON-ready.

    Parameters
    ----------
    record : LoopRecord or Columns
        Columns that were kept are answered from the extremes of their blocks, however long they are.
    start, stop : int
        Rows; cut to the record.
    width : int
        Pixels, 1 to 4000.

    Returns
    -------
    dict
        "t": seconds from the first row of the record, one for each value, without what gaps left out; "sp" .. "op":
        values, None where missing; "start", "stop", "rows", "dt"; "finest": every row is there; "shaded": stretches
        (from, to, what) of "manual", "missing" and "at a limit" in seconds; "gaps": (where, seconds that are missing
        or None) of each gap, those of a pixel together; "from", "to": moments of the first and last row as ISO text,
        None where they are not known.

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
    columns = record if isinstance(record, Columns) else Columns.of(record)
    first, last = rows_between(columns, start, stop)
    if not 1 <= width <= WIDEST:
        raise ParameterError.expected(f"1 to {WIDEST} pixels", width, "give the width of the picture")
    dt, finest = columns.dt, last - first <= 2 * width
    found: dict[str, Any] = {"start": first, "stop": last, "rows": len(columns), "dt": dt, "finest": finest}
    found |= {"from": _moment(columns, first), "to": _moment(columns, last - 1)}
    edges, block = _pixels(columns, first, last, width)
    places = np.arange(first, last) if finest else np.column_stack([edges[:-1], (edges[:-1] + edges[1:]) // 2]).ravel()
    found["t"] = (places * dt).tolist()
    for name, signal in columns.signals.items():
        drawn = signal.values[first:last] if finest else _drawn(signal, edges, block)
        found[name] = [None if one != one else one for one in drawn.tolist()]  # noqa: PLR0124  NaN
    pixel = max((last - first) // width, 1)
    found["shaded"] = [
        (low * dt, high * dt, what)
        for what, rows in columns.shaded.items()
        for low, high in _joined(rows, first, last, pixel)
    ]
    found["gaps"] = list(_gaps(columns, first, last, pixel))
    return found


def rows_between(columns: Columns, start: int, stop: int) -> tuple[int, int]:
    """Rows that are there.

    Raises
    ------
    ParameterError
        None lies between them.
    """
    first, last = max(start, 0), min(stop, len(columns))
    if last <= first:
        raise ParameterError.expected("rows of the record", f"{start} to {stop}", f"it has {len(columns)}")
    return first, last


def _moment(columns: Columns, row: int) -> str | None:
    moment = columns.moment(row)
    return None if moment is None else moment.isoformat()


def _pixels(columns: Columns, first: int, last: int, width: int) -> tuple[Rows, int]:
    """First row of each pixel and the end; those inside at the edges of blocks, if there are blocks."""
    edges = np.linspace(first, last, width + 1).astype(np.int64)
    block = next(iter(columns.signals.values())).block_of((last - first) / width)
    if block > 1:
        edges[1:-1] = (edges[1:-1] + block // 2) // block * block
    return edges, block


def _drawn(signal: Pyramid, edges: Rows, block: int) -> FloatArray:
    """Smallest and largest of each pixel, in the order in which they come; NaN where nothing is known."""
    low, high = signal.extremes(edges, block).T
    rising = signal.values[edges[:-1]] <= signal.values[edges[1:] - 1]
    return np.column_stack([np.where(rising, low, high), np.where(rising, high, low)]).ravel()


def _joined(rows: Rows, first: int, last: int, pixel: int) -> list[tuple[int, int]]:
    """Stretches between two rows; those closer than a pixel are one."""
    begin, end = np.searchsorted(rows[:, 1], first, side="right"), np.searchsorted(rows[:, 0], last, side="left")
    inside = np.clip(rows[begin:end], first, last)
    if not inside.size:
        return []
    apart = inside[1:, 0] - inside[:-1, 1] >= pixel
    starts, stops = inside[np.r_[True, apart], 0], inside[np.r_[apart, True], 1]
    return list(zip(starts.tolist(), stops.tolist(), strict=True))


def _gaps(columns: Columns, first: int, last: int, pixel: int) -> Iterator[tuple[float, float | None]]:
    begin, end = (int(np.searchsorted(columns.gaps, one, side="right")) for one in (first, last - 1))
    lost, place, seconds = columns.facts["gap_seconds"], None, 0.0
    for number in range(begin, end):
        row = int(columns.gaps[number])
        if place is not None and row - place >= pixel:
            yield place * columns.dt, seconds if lost else None
            place = None
        if place is None:
            place, seconds = row, 0.0
        seconds += lost[number] if lost else 0.0
    if place is not None:
        yield place * columns.dt, seconds if lost else None
