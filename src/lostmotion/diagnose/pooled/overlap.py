"""Rows that two records of one loop share are counted once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from lostmotion.records import LoopRecord

RUN = 20  # rows of OP and PV in a row that are equal to the last digit: that is no chance
SHORTEST = 120  # rows of a rest worth keeping

Bools = npt.NDArray[np.bool_]


def without_repeats(records: Sequence[LoopRecord]) -> tuple[list[LoopRecord | None], list[int]]:
    """The records without rows that an earlier one holds already, and how many rows each has lost.

    Files of one loop are often cut from the same history, and evidence that is counted twice looks twice as sure. Of a
    record that loses rows the longest rest is kept; None where that is too short.
    """
    seen: set[bytes] = set()
    kept: list[LoopRecord | None] = []
    lost = []
    for record in records:
        keys = _keys(record)
        again = np.array([key in seen for key in keys], dtype=np.bool_)
        seen.update(key for key in keys if key)
        repeated = np.zeros(len(record), dtype=np.bool_)
        for row in np.flatnonzero(again):
            repeated[row : row + RUN] = True
        kept.append(_rest(record, repeated))
        lost.append(int(repeated.sum()))
    return kept, lost


def _keys(record: LoopRecord) -> list[bytes]:
    """Of the runs that begin at each row; empty where nothing moves, which is the same in every record."""
    pairs = np.column_stack([record.op, record.pv])
    moving = np.any(np.diff(pairs, axis=0) != 0.0, axis=1)
    starts = range(len(record) - RUN + 1)
    return [pairs[k : k + RUN].tobytes() if moving[k : k + RUN - 1].any() else b"" for k in starts]


def _rest(record: LoopRecord, repeated: Bools) -> LoopRecord | None:
    """Longest stretch that is not repeated."""
    if not repeated.any():
        return record
    edges = np.flatnonzero(np.diff(np.r_[True, repeated, True].astype(np.int8)))
    starts, stops = edges[::2], edges[1::2]
    if not starts.size:
        return None
    longest = int(np.argmax(stops - starts))
    start, stop = int(starts[longest]), int(stops[longest])
    return record.cut(start, stop) if stop - start >= SHORTEST else None
