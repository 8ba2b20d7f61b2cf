"""Rows of a window by what they are good for: known, in automatic, OP at a limit, standing still."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.op_span import OpSpan, op_span
from lostmotion.records import LoopRecord, limits
from lostmotion.records.modes import Kind, rows_of
from lostmotion.records.record import StringArray
from lostmotion.records.sampling import Bools, neighbours, runs
from lostmotion.records.standstill import held_op, improbable_run, is_live, stopped, stuck

FAR = 2.0  # times the range of OP elsewhere
CREPT = 0.25  # of the usual range of OP: what integral action goes while PV stands near SP
ALIVE, SPREAD = 5, 0.5  # changes of OP, and the share of the time between them, after which its recording went on
MOST = 0.5  # of the time
USUAL = (0.02, 0.98)  # quantiles of OP: where it comes back from having run away is neither


@dataclass(frozen=True, eq=False)
class ScreenRows:
    """A window and its kinds of rows, each found once.

    Attributes
    ----------
    record : LoopRecord
        With spans and type as the loop list has them.
    """

    record: LoopRecord

    @cached_property
    def known(self) -> Bools:
        """OP and PV are there."""
        return np.asarray(~self.record.missing)

    @cached_property
    def standing(self) -> Bools:
        """Nothing was recorded there, or PV stuck."""
        return np.asarray(self.stopped | self.stuck)

    @cached_property
    def stopped(self) -> Bools:
        """The recording stopped: neither OP nor PV moves, nor has OP crept on while PV stood still."""
        return np.asarray(stopped(self.record) & ~_crept_on(self.record, self.stuck))

    @cached_property
    def stuck(self) -> Bools:
        """PV stands still, though its noise is seen elsewhere, or OP runs away from all that it is elsewhere."""
        return np.asarray(stuck(self.record) | _left_behind(self.record))

    @cached_property
    def modes_known(self) -> bool:
        """Whether a mode was recorded that means something."""
        return _mode_rows("automatic", self.record.mode) is not None

    @cached_property
    def manual(self) -> Bools:
        """Not in automatic; without a mode: OP is held for long while PV moves, or all the time."""
        automatic = _mode_rows("automatic", self.record.mode)
        if automatic is not None:
            return ~automatic
        known = self.record.op[self.known]
        if known.size and float(np.ptp(known)) == 0.0:
            return np.ones(len(self.record), dtype=np.bool_)
        return np.asarray(held_op(self.record) & ~self.standing)

    @cached_property
    def span(self) -> OpSpan | None:
        """Span of OP; None where OP is all missing."""
        return op_span(self.record) if bool(np.isfinite(self.record.op).any()) else None

    @cached_property
    def limited(self) -> Bools:
        """OP is at a limit: an end of a given span, or the extreme of the window where a live OP stands there.

        Controllers have output limits inside the span.
        """
        op, span = self.record.op, self.record.op_span
        known = op[np.isfinite(op)]
        if not known.size or float(np.ptp(known)) == 0.0:
            return np.zeros(len(op), dtype=np.bool_)
        margin = limits.FINE_STEP * float(np.ptp(known))
        ends = _in_long_runs(op <= known.min() + margin) | _in_long_runs(op >= known.max() - margin)
        still = (np.diff(op) == 0) & ~ends[1:]
        if float(np.mean(ends)) < limits.SATURATED_SHARE or not is_live(still[~ends[1:]]):
            ends = np.zeros(len(op), dtype=np.bool_)
        if span is None:
            return ends
        margin = limits.SPAN_MARGIN * (span[1] - span[0])
        return np.asarray(ends | (op <= span[0] + margin) | (op >= span[1] - margin))

    @cached_property
    def live(self) -> Bools:
        """Known, in automatic, and recorded."""
        return np.asarray(self.known & ~self.manual & ~self.standing)

    @cached_property
    def acting(self) -> Bools:
        """Live, and OP not at a limit: where the valve follows a controller."""
        return np.asarray(self.live & ~self.limited)

    def share(self, rows: Bools) -> float:
        """Of all rows."""
        return float(np.mean(rows))

    @cached_property
    def error(self) -> FloatArray:
        """Error of control (PV less SP; PV less its mean where SP is not known) in the live rows, NaN elsewhere."""
        record = self.record
        target = record.sp if record.sp is not None and self.sp_fits else np.zeros(1)
        error = np.where(self.live, record.pv - target, np.nan)
        known = error[np.isfinite(error)]
        return error - float(known.mean()) if known.size else error

    @cached_property
    def sp_fits(self) -> bool:
        """Whether SP is there and in the unit of PV: they come near each other while OP is free."""
        return self.record.sp is not None and not self.sp_apart

    @cached_property
    def sp_apart(self) -> bool:
        """SP and PV are nowhere near each other though the controller acts."""
        record = self.record
        if record.sp is None or not self.acting.any():
            return False
        pv, sp = record.pv[self.acting], record.sp[self.acting]
        apart = np.abs(pv - sp)
        if not np.isfinite(apart).any():
            return False
        reach = float(np.ptp(pv)) + float(np.nanmax(sp) - np.nanmin(sp))
        return bool(np.nanmin(apart) > reach + limits.SMALL_AMPLITUDE * float(np.abs(pv).max()))


def _crept_on(record: LoopRecord, standing: Bools) -> Bools:
    """Rows in which PV stands still for so long that OP has gone far, be it by a step in hundreds of rows; shape (n,).

    Or in which OP changed again and again: a recording that stops holds both. A PV that stands most of the time does so
    for its resolution.
    """
    rows = np.zeros(len(record), dtype=np.bool_)
    known = record.op[np.isfinite(record.op)]
    if not 0.0 < float(np.mean(standing)) <= MOST or not known.size:
        return rows
    reach = CREPT * float(np.subtract(*np.quantile(known, USUAL[::-1])))
    for start, length in zip(*(found.tolist() for found in runs(standing)), strict=True):
        part = record.op[start : start + length]
        part = part[np.isfinite(part)]
        far = bool(part.size) and 0.0 < reach <= float(np.ptp(part))
        if far or _went_on(part):
            rows[start : start + length] = True
    return rows


def _went_on(op: FloatArray) -> bool:
    """Whether OP changed in rows spread over these."""
    changes = np.flatnonzero(np.diff(op))
    return len(changes) >= ALIVE and int(changes[-1] - changes[0]) > SPREAD * len(op)


def _left_behind(record: LoopRecord) -> Bools:
    """Rows in which PV stands still for longer than chance makes while OP moves far; shape (n,).

    As long as OP stays where it is elsewhere, a PV without noise may rest in a lost motion.
    """
    still = (np.diff(record.pv) == 0) & neighbours(record)
    rows = np.zeros(len(record), dtype=np.bool_)
    if not is_live(still):
        return rows
    starts, lengths = runs(still)
    long = lengths >= max(limits.FROZEN_RUN - 1, improbable_run(still))
    inside = np.zeros(len(record), dtype=np.bool_)
    for start, length in zip(starts[long].tolist(), lengths[long].tolist(), strict=True):
        inside[start : start + length + 1] = True
    rest = record.op[~inside & np.isfinite(record.op)]
    if not inside.any() or not rest.size:
        return rows
    reach = FAR * float(np.subtract(*np.quantile(rest, USUAL[::-1])))
    for start, length in zip(starts[long].tolist(), lengths[long].tolist(), strict=True):
        part = record.op[start : start + length + 1]
        known = part[np.isfinite(part)]
        if known.size and float(np.ptp(known)) > reach:
            rows[start + 1 : start + length + 1] = True
    return rows


def _mode_rows(kind: Kind, mode: StringArray | None) -> Bools | None:
    """As `rows_of`, for a mode that changes seldom: a sort of all its words takes longer than the rest."""
    if mode is None:
        return None
    starts = np.r_[0, np.flatnonzero(mode[1:] != mode[:-1]) + 1]
    found = rows_of(kind, mode[starts])
    return None if found is None else np.repeat(found, np.diff(np.r_[starts, len(mode)]))


def _in_long_runs(flags: Bools) -> Bools:
    """Rows in runs that last longer than a turning point."""
    starts, lengths = runs(flags)
    long = lengths >= limits.SATURATED_RUN
    rows = np.zeros(flags.size + 1, dtype=np.int64)
    rows[starts[long]] += 1
    rows[(starts + lengths)[long]] -= 1
    return np.asarray(np.cumsum(rows)[:-1] > 0)
