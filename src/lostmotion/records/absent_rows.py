"""Rows that a regular clock shows to be absent: they are missing samples, as empty cells are."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.records import limits
from lostmotion.records.record import LoopRecord

OFF_GRID = 0.1  # sampling times, at most, by which any gap differs from whole rows; a clock that jitters has no grid


def with_absent_rows(record: LoopRecord) -> LoopRecord:
    """Record whose gaps of a few rows are rows of missing samples; longer gaps stay.

    Parameters
    ----------
    record : LoopRecord
        With `gap_seconds`; without, or where these are no whole sampling times, it is returned as it is.

    Examples
    --------
    >>> record = LoopRecord([1, 2, 5, 9], [3, 4, 7, 9], dt=2.0, gaps=(2, 3), gap_seconds=(4.0, 60.0))
    >>> whole = with_absent_rows(record)
    >>> whole.pv, whole.gaps, whole.gap_seconds
    (array([ 3.,  4., nan, nan,  7.,  9.]), (5,), (60.0,))
    """
    lost = np.array(record.gap_seconds) / record.dt
    absent = np.round(lost).astype(np.int64)
    short = (absent >= 1) & (absent <= limits.BRIDGE_ROWS)
    if not short.any() or (np.abs(lost - absent) > OFF_GRID).any():
        return record
    gaps, count = np.array(record.gaps), int(absent[short].sum())
    rows = np.repeat(np.arange(len(record)), np.bincount(gaps[short] - 1, absent[short], len(record)).astype(int) + 1)
    first = np.r_[True, np.diff(rows) > 0]
    signals: dict[str, Any] = {
        name: None if getattr(record, name) is None else np.where(first, getattr(record, name)[rows], np.nan)
        for name in ("op", "pv", "sp", "position")
    }
    return replace(
        record,
        **signals,
        mode=None if record.mode is None else record.mode[rows],
        gaps=tuple((gaps + np.cumsum(absent * short))[~short].tolist()),
        gap_seconds=_of_long_gaps(np.array(record.gap_seconds) - absent * short * record.dt, short),
        notes=(
            *record.notes,
            f"{count} row{'s' if count > 1 else ''} of the regular clock {'are' if count > 1 else 'is'} absent; "
            f"{'they count as missing samples' if count > 1 else 'it counts as a missing sample'}.",
        ),
    )


def _of_long_gaps(seconds: FloatArray, short: np.ndarray[Any, np.dtype[np.bool_]]) -> tuple[float, ...]:
    """Seconds of the gaps that stay, with what rounding left of the others before them."""
    total = np.cumsum(seconds)[~short]
    return tuple(np.round(np.diff(total, prepend=0.0), 4).tolist())
