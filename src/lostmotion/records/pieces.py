"""Pieces of a record between the rows that are left out, and the repairs that are allowed."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from lostmotion.records import limits
from lostmotion.records.prepared import where
from lostmotion.records.record import LoopRecord
from lostmotion.records.sampling import Bools, runs
from lostmotion.records.span import beyond, of_other_units

Rows = list[tuple[int, int]]


def bridge(record: LoopRecord) -> tuple[LoopRecord, list[str]]:
    """Fill a few missing rows of what holds its value: OP between equal neighbours, and SP, which moves seldom.

    Examples
    --------
    >>> record = LoopRecord([1.0, np.nan, 1.0, np.nan, 2.0], [0.0] * 5, dt=1.0)
    >>> bridged, said = bridge(record)
    >>> bridged.op.tolist(), said
    ([1.0, 1.0, 1.0, nan, 2.0], ['OP is missing in 1 row between equal values and was held there.'])
    >>> bridge(LoopRecord([1.0] * 4, [0.0] * 4, [np.nan, 3.0, np.nan, 4.0], dt=1.0))[0].sp.tolist()
    [3.0, 3.0, 3.0, 4.0]
    """
    record, said = _with_held_sp(record)
    op = record.op.copy()
    filled = 0
    for start, length in zip(*runs(np.isnan(op)), strict=True):
        stop = start + length
        inside = start > 0 and stop < len(op) and not any(start <= gap <= stop for gap in record.gaps)
        if inside and length <= limits.BRIDGE_ROWS and op[start - 1] == op[stop]:
            op[start:stop] = op[stop]
            filled += int(length)
    if not filled:
        return record, said
    return replace(record, op=op), [f"OP is missing in {_rows(filled)} between equal values and was held there.", *said]


def _with_held_sp(record: LoopRecord) -> tuple[LoopRecord, list[str]]:
    """Record whose SP is the last one before in short runs where it is missing; where none is before, the next."""
    if record.sp is None or not np.isnan(record.sp).any():
        return record, []
    sp = record.sp.copy()
    begins = {0, *record.gaps}
    for start, length in zip(*runs(np.isnan(sp)), strict=True):
        stop = start + length
        if length > limits.BRIDGE_ROWS or any(start < gap <= stop for gap in record.gaps):
            continue
        if start not in begins:
            sp[start:stop] = sp[start - 1]
        elif stop < len(sp):
            sp[start:stop] = sp[stop]
    alone = np.isnan(record.sp) & ~np.isnan(sp) & ~record.missing  # the others count as missing samples
    said = [f"SP is missing in {_rows(int(alone.sum()))} and was held there."] if alone.any() else []
    return replace(record, sp=sp), said


def _rows(count: int) -> str:
    return f"{count} row{'s' if count > 1 else ''}"


def clip_to_span(record: LoopRecord) -> tuple[LoopRecord, list[str]]:
    """Take OP that is recorded outside its span as the limit: the actuator ends there.

    A span of other units than those of OP is no limit: OP stays as it is, and goes on without it.

    Examples
    --------
    >>> record, said = clip_to_span(LoopRecord([-3.0, 20.0, 104.0], [0.0] * 3, dt=1.0, op_span=(0, 100)))
    >>> record.op.tolist()
    [0.0, 20.0, 100.0]
    """
    outside = beyond(record.op, record.op_span)
    if not outside.any() or record.op_span is None:
        return record, []
    low, high = record.op_span
    if of_other_units(record.op, record.op_span):
        return with_own_span(record), [f"The span of OP, {low:g} .. {high:g}, is one of other units, and was left out."]
    first = int(np.flatnonzero(outside)[0])
    said = (
        f"OP is recorded outside its span {low:g} .. {high:g} in {int(outside.sum())} rows, first in "
        f"{where(first, first + 1, record.dt)}; the limit was taken there, where the actuator ends."
    )
    return replace(record, op=np.clip(record.op, low, high)), [said]


def with_own_span(record: LoopRecord) -> LoopRecord:
    """The record without a span of OP that is one of other units."""
    return replace(record, op_span=None) if of_other_units(record.op, record.op_span) else record


def longest_side(count: int, joints: tuple[int, ...]) -> Bools:
    """Rows that are not in the longest of the recordings glued together at `joints`; shape (count,).

    Examples
    --------
    >>> longest_side(5, (3,))
    array([False, False, False,  True,  True])
    """
    edges = [0, *joints, count]
    start, stop = max(pairwise(edges), key=lambda pair: pair[1] - pair[0])
    outside = np.ones(count, dtype=np.bool_)
    outside[start:stop] = False
    return outside


def pieces(usable: Bools, gaps: tuple[int, ...], shortest: int) -> Rows:
    """Runs of usable rows between gaps that are long enough, as (start, stop).

    A short piece costs more than it brings: the search can look back no further than the shortest piece allows, in
    all of them. So pieces are dropped up to the longest threshold that keeps 80 % of the rows.

    Examples
    --------
    >>> usable = np.ones(1000, dtype=bool)
    >>> usable[[100, 500]] = False
    >>> pieces(usable, (560,), 60)
    [(101, 500), (560, 1000)]
    """
    edges = np.zeros(len(usable), dtype=np.bool_)
    edges[[gap for gap in gaps if 0 < gap < len(usable)]] = True
    found: Rows = []
    for start, length in zip(*runs(usable), strict=True):
        inside = np.flatnonzero(edges[start + 1 : start + length]) + start + 1
        found += [(int(one), int(other)) for one, other in pairwise([start, *inside, start + length])]
    found = [pair for pair in found if pair[1] - pair[0] >= shortest]
    total = sum(stop - start for start, stop in found)
    for length in limits.LONG_PIECES:
        long = [pair for pair in found if pair[1] - pair[0] >= length]
        if sum(stop - start for start, stop in long) >= limits.LONG_KEEP * total:
            return long
    return found
