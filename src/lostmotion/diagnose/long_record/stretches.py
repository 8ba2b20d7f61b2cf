"""Stretches of a long record that tell most of the valve, joined to one short record at its natural time scale."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.diagnose.control_error.rows import ScreenRows
from lostmotion.errors import DataError
from lostmotion.identify.data import collect
from lostmotion.identify.recording import Recording
from lostmotion.kernels.turns import turns
from lostmotion.records import LoopRecord, limits, prepare
from lostmotion.records.resample import pick
from lostmotion.records.sampling import Bools, runs

ROWS = 1500  # of a stretch after thinning
EACH = 2  # stretches to a look, the best of each half of the record: three of 800 named fewer faults in no less time
SHORT = 3200  # rows after thinning: a shorter record is looked at whole
PER_PERIOD = 250.0  # rows in a period of the swing: more are thinned; at 100 a fast process hides what the valve does
KNOWN = 0.9  # share of the rows of a stretch that must act
MOVE = 30.0  # turns of OP that a move of SP is worth: noise and drift, which also make turns, hide what the valve does
STEPPED = 0.05  # of the deviation of PV: a smaller change of SP is none


@dataclass(frozen=True)
class Look:
    """One short record to be diagnosed.

    Attributes
    ----------
    record : LoopRecord
        Stretches with gaps between.
    places : tuple of int
        First row of each in the record, best first.
    rows : int
        Of the record in each.
    """

    record: LoopRecord
    places: tuple[int, ...]
    rows: int


def thinning(period: float | None, dt: float) -> int:
    """Every so many-th row is enough for a swing of so many seconds."""
    return 1 if period is None else max(int(period / dt / PER_PERIOD), 1)


def looks(rows: ScreenRows, period: float | None) -> Iterator[Look]:
    """Records to be diagnosed, the most telling first; none where too little of the record acts.

    Parameters
    ----------
    rows : ScreenRows
    period : float, optional
        Seconds of the swing, or of the fastest motion above the noise.
    """
    factor = thinning(period, rows.record.dt)
    masked = _masked(rows, factor)
    if len(rows.record) <= SHORT * factor:
        whole = _thinned(masked, factor)
        if whole is not None:
            yield Look(whole, (0,), len(rows.record))
        return
    size = ROWS * factor
    starts = np.arange(0, len(rows.record) - size + 1, size // 2)
    scores = np.array([_score(rows, slice(start, start + size, factor)) for start in starts.tolist()])
    while chosen := _best_of_parts(starts, scores, size):
        taken = [int(starts[number]) for number in chosen]
        yield _joined(masked, taken, size, factor)
        for number in chosen:
            scores[np.abs(starts - starts[number]) < size] = -np.inf


def recording(rows: ScreenRows, period: float | None) -> Recording | None:
    """How the loop was recorded, from all of it at the pace of its looks; None: a look is at all of it.

    A stretch has few moves of SP: whether the loop settles between the rows it often leaves open, and the next one says
    something else; and it is too short to show that OP foretells PV. How a loop is recorded does not change from one to
    the next. Also None where the record is refused.
    """
    factor = thinning(period, rows.record.dt)
    whole = _thinned(_masked(rows, factor), factor) if len(rows.record) > SHORT * factor else None
    if whole is None:
        return None
    try:
        return Recording.of(collect(prepare(whole), None, None))
    except DataError:
        return None


def _score(rows: ScreenRows, part: slice) -> float:
    """Moves of SP and turns of OP in a stretch, times the range of OP; -inf where it does not act."""
    acting = rows.acting[part]
    if acting.mean() < KNOWN:
        return float("-inf")
    op, pv = rows.record.op[part][acting], rows.record.pv[part][acting]
    reach, spread = float(np.ptp(op)), float(pv.std())
    if reach == 0.0 or spread == 0.0:
        return float("-inf")
    score = float(turns(op, float(op.std()))[0])
    if rows.sp_fits and rows.record.sp is not None:
        moves = np.abs(np.diff(rows.record.sp[part][acting]))
        score += MOVE * float(np.count_nonzero(moves > STEPPED * spread))
    return (1.0 + score) * reach


def _best_of_parts(starts: IntArray, scores: FloatArray, size: int) -> list[int]:
    """Numbers of the best stretch of each part of the record, best first; a part without any is left out."""
    parts = np.array_split(np.arange(starts.size), EACH)
    found: list[int] = []
    for part in parts:
        free = [one for one in part.tolist() if all(abs(starts[one] - starts[other]) >= size for other in found)]
        if free and np.isfinite(scores[free]).any():
            found.append(free[int(np.argmax(scores[free]))])
    return sorted(found, key=lambda one: -scores[one])


def _joined(record: LoopRecord, places: list[int], size: int, factor: int) -> Look:
    """Stretches one behind the other in order of time, with gaps between them."""
    ordered = sorted(places)
    chosen = np.concatenate([np.arange(place, place + size, factor) for place in ordered])
    own = {int(np.searchsorted(chosen, gap)) for gap in record.gaps if any(p < gap < p + size for p in ordered)}
    length = chosen.size // len(ordered)
    between = {length * number for number in range(1, len(ordered))}
    signals = ("op", "pv", "sp", "position", "mode")
    parts: dict[str, Any] = {name: getattr(record, name) for name in signals}
    parts = {name: None if value is None else value[chosen] for name, value in parts.items()}
    gaps = tuple(sorted(row for row in own | between if 0 < row < chosen.size))
    joined = replace(record, **parts, dt=record.dt * factor, gaps=gaps, gap_seconds=(), start=record.moment(ordered[0]))
    return Look(joined, tuple(places), size)


def _masked(rows: ScreenRows, factor: int) -> LoopRecord:
    """The record with OP missing where the valve follows no controller for some time.

    Without a mode no row counts as manual here: `prepare` leaves out where OP is held.
    """
    aside = np.zeros(len(rows.record), dtype=np.bool_)
    if rows.modes_known:
        aside |= _long(rows.manual, factor)
    aside |= _long(rows.limited, factor)
    if not aside.any() or aside.all():
        return rows.record
    return replace(rows.record, op=np.where(aside, np.nan, rows.record.op))


def _long(flags: Bools, factor: int) -> Bools:
    """Rows in runs that prepare could not take for a turn, nor, after thinning, for scattered missing samples."""
    rows, least = np.zeros(flags.size, dtype=np.bool_), (limits.BRIDGE_ROWS + 1) * factor
    for start, length in zip(*runs(flags), strict=True):
        if length >= limits.FROZEN_RUN:
            rows[start : start + max(length, least)] = True
    return rows


def _thinned(record: LoopRecord, factor: int) -> LoopRecord | None:
    if factor == 1:
        return record
    if len(record) // factor < limits.SHORT:
        return None
    return replace(pick(record, factor, 0), gaps=tuple(sorted({max(gap // factor, 1) for gap in record.gaps})))
