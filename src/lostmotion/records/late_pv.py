"""PV in later rows than those in which the controller saw it.

A historian that polls PV and OP by turns, or stamps them where they arrive, moves one against the other. Where PV comes
late, OP foretells it although no valve has moved: the controller has seen what the row will show. The best process is
then the inverse of the controller, sizes are excluded that are there, and faults are not found. PV that comes early is
no more than a longer delay.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.records.record import LoopRecord

SHIFTS = (1, 2)  # rows by which PV may be late
REACH = 5  # rows beside one that are looked at
MOST_ROWS, FEWEST_ROWS = 5000, 200
UNEXPLAINED = 0.01  # of the moves of OP: where PV of the same row leaves less over, it is what the controller saw
# What PV of another row leaves over of that. Of 460 loops of an independent simulation 14 had PV a row late; seven are
# below it (0.05 at most; the others were compressed or filtered as well), and no other loop (0.16 at least); of 136
# real records none (0.5 at least)
PLAINLY = 0.1
# What is left over without an integral part, of that with one. In a record without noise the inverse of the process
# explains OP by later rows of PV exactly, and has none
INTEGRAL = 1.15


def rows_late(stretches: Sequence[LoopRecord]) -> tuple[int, str]:
    """Rows by which PV is recorded later than the controller saw it, and what is to be said of it; 0 where it is not.

    A PI controller with a filter is fitted to the moves of OP, with PV of the same row and of others.

    Parameters
    ----------
    stretches : sequence of LoopRecord
        Pieces in which nothing is missing.

    Examples
    --------
    >>> pv, op = np.random.default_rng(1).normal(size=1000).cumsum() / 10.0, np.zeros(1000)
    >>> for now in range(1, 1000):
    ...     op[now] = op[now - 1] - 0.8 * (pv[now] - pv[now - 1]) - 0.1 * pv[now]
    >>> rows_late([LoopRecord(op[1:], pv[1:], dt=1.0)])[0], rows_late([LoopRecord(op[1:], pv[:-1], dt=1.0)])[0]
    (0, 1)
    """
    used = _longest(stretches)
    before = _left_over(used, 0)[0]
    for late in SHIFTS if before > UNEXPLAINED else ():
        after, without_integral = _left_over(used, late)
        if after < PLAINLY * before and without_integral > INTEGRAL * after:
            rows = f"{late} row{'s' if late > 1 else ''} later"
            return late, (
                f"PV is recorded {rows} than the controller saw it: as it is, a PI controller leaves"
                f" {100 * before:.2g} % of the moves of OP over, and moved by that {100 * after:.2g} %. It was moved;"
                " delays count from there."
            )
    return 0, ""


def moved(record: LoopRecord, late: int) -> LoopRecord:
    """The record with PV in the rows in which the controller saw it; at ends and gaps it is missing."""
    pv = np.full(len(record), np.nan)
    for start, stop in zip((0, *record.gaps), (*record.gaps, len(record)), strict=True):
        pv[start : max(stop - late, start)] = record.pv[start + late : stop]
    return replace(record, pv=pv)


def _longest(stretches: Sequence[LoopRecord]) -> list[LoopRecord]:
    """So many rows of the longest; none where they are too few."""
    found, left = [], MOST_ROWS
    for piece in sorted(stretches, key=len, reverse=True):
        if left > 0 and len(piece) > 2 * REACH:
            found.append(piece if len(piece) <= left else piece.cut(0, max(left, 2 * REACH + 1)))
            left -= len(piece)
    return found if MOST_ROWS - left >= FEWEST_ROWS else []


def _left_over(stretches: Sequence[LoopRecord], late: int) -> tuple[float, float]:
    """Share of the moves of OP that a PI controller with a filter leaves over, and one without an integral part.

    0 where OP does not move, or there are no rows.
    """
    if not stretches:
        return 0.0, 0.0
    with_sp = all(piece.sp is not None and bool(np.isfinite(piece.sp).all()) for piece in stretches)
    parts = [_regression(piece, late, with_sp) for piece in stretches]
    moves = np.concatenate([target for _, _, target in parts])
    total = float(np.sum((moves - moves.mean()) ** 2))
    if total == 0.0:
        return 0.0, 0.0
    others, levels = np.vstack([part[0] for part in parts]), np.vstack([part[1] for part in parts])
    levels = levels - levels.mean(axis=0)
    return _rest(np.hstack([others, levels]), moves) / total, _rest(others, moves) / total


def _regression(piece: LoopRecord, late: int, with_sp: bool) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Of a stretch what the moves of OP may be made of, (n, k) and levels (n, m), and the moves (n,)."""
    now = np.arange(REACH, len(piece) - REACH)
    op, pv, then = piece.op, piece.pv, now + late
    others = [np.ones(now.size), op[now - 1] - op[now - 2], pv[then] - pv[then - 1], pv[then - 1] - pv[then - 2]]
    levels = [pv[then]]
    if with_sp and piece.sp is not None:
        others.append(piece.sp[now] - piece.sp[now - 1])
        levels.append(piece.sp[now])
    return np.column_stack(others), np.column_stack(levels), op[now] - op[now - 1]


def _rest(known: FloatArray, target: FloatArray) -> float:
    """Sum of squares that a regression leaves over."""
    left = target - known @ np.linalg.lstsq(known, target, rcond=None)[0]
    return float(left @ left)
