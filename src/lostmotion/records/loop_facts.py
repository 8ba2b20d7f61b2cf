"""What is known about the loop: its mode, how much it was excited, where OP was at a limit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.records.limits import (
    FINE_STEP,
    FLAT_SHARE,
    MOVING_SHARE,
    REVERSAL_SIZE,
    SATURATED_RUN,
    SPAN_MARGIN,
)
from lostmotion.records.modes import rows_of
from lostmotion.records.record import LoopRecord
from lostmotion.records.sampling import Bools, runs
from lostmotion.records.signal_facts import SignalFacts

AT_ONCE = 64  # rows of a swing that are looked at together


@dataclass(frozen=True)
class LoopFacts:
    """Behaviour of the loop.

    Parameters
    ----------
    mode : str
        What SP and OP look like, in words.
    op_reversals : int
        Turning points of OP larger than a tenth of its 5-95 % amplitude.
    sp_moves : int, optional
        Rows in which SP differs from the row before; None: no SP.
    refresh_rows : float
        Rows per row in which OP or PV changes; 1 where something changes in each. Larger: the record is
        faster than the scan behind it, or both are quantised.
    longest_frozen : int
        Samples in the longest run in which neither OP nor PV changes.
    saturated_low, saturated_high : float
        Share of samples in which the controller holds OP at its lower and upper limit: that of the span where it is
        known, else the extreme of the record if OP stands there for 5 samples or more.
    """

    mode: str
    op_reversals: int
    sp_moves: int | None
    refresh_rows: float
    longest_frozen: int
    saturated_low: float
    saturated_high: float


def describe_loop(record: LoopRecord, op: SignalFacts) -> LoopFacts:
    """Describe mode, excitation and saturation.

    Examples
    --------
    >>> from lostmotion.records.signal_facts import describe_signal
    >>> record = LoopRecord([0, 1, 2, 1, 0, 1], [0, 0, 1, 2, 1, 0], sp=[1] * 6, dt=1.0)
    >>> facts = describe_loop(record, describe_signal("OP", record.op, np.ones(5, dtype=bool)))
    >>> facts.mode, facts.op_reversals
    ('automatic, SP constant', 2)
    """
    moves = sp_moves(record.sp)
    low, high = saturation(record, op)
    refresh, frozen = _refresh(record)
    return LoopFacts(
        mode=_mode(op, moves, len(record)),
        op_reversals=reversals(record.op, REVERSAL_SIZE * op.amplitude),
        sp_moves=moves,
        refresh_rows=refresh,
        longest_frozen=frozen,
        saturated_low=low,
        saturated_high=high,
    )


def _refresh(record: LoopRecord) -> tuple[float, int]:
    still = (np.diff(record.op) == 0) & (np.diff(record.pv) == 0)
    known = ~record.missing[1:] & ~record.missing[:-1]
    changes = int(np.sum(known & ~still))
    return float(np.sum(known)) / max(changes, 1), int(runs(still)[1].max(initial=0)) + 1


def sp_moves(sp: FloatArray | None) -> int | None:
    """Rows in which SP differs from the row before by more than float rounding; None without SP."""
    if sp is None:
        return None
    known = sp[~np.isnan(sp)]
    if not len(known):
        return None
    smallest = FINE_STEP * max(float(np.ptp(known)), float(np.abs(known).max()))
    return int(np.sum(np.abs(np.diff(known)) > smallest))


def reversals(values: FloatArray, size: float) -> int:
    """Count turning points between swings larger than a size.

    Examples
    --------
    >>> reversals(np.array([0.0, 5.0, 4.9, 6.0, 1.0, 3.0]), 1.0)
    2
    """
    known = values[~np.isnan(values)]
    if not len(known):
        return 0
    count, direction = 0, 0
    extreme = low = high = float("nan")
    starts = np.arange(0, len(known), AT_ONCE)
    bounds = zip(*(ends.reduceat(known, starts).tolist() for ends in (np.minimum, np.maximum)), strict=True)
    for start, (lowest, highest) in zip(starts.tolist(), bounds, strict=True):
        farthest, nearest = (highest, lowest) if direction > 0 else (-lowest, -highest)
        if direction and max(extreme * direction, farthest) - nearest <= size:  # no turn can be among these rows
            extreme = direction * max(extreme * direction, farthest)
            continue
        for value in known[start : start + AT_ONCE].tolist():
            if direction == 0:
                low = value if low != low else min(low, value)  # noqa: PLR0124  (NaN before the first)
                high = value if high != high else max(high, value)  # noqa: PLR0124
                if high - low > size:
                    direction = 1 if value == high else -1
                    extreme = value
            elif (value - extreme) * direction > 0:
                extreme = value
            elif (extreme - value) * direction > size:
                count, direction, extreme = count + 1, -direction, value
    return count


def saturation(record: LoopRecord, facts: SignalFacts) -> tuple[float, float]:
    """Share of samples in which the controller holds OP at the lower and the upper limit.

    Without a span, a signal that stands still most of the time (steps by hand) has no limits that show. Where somebody
    holds OP by hand, as the mode says, that is no limit.

    Parameters
    ----------
    record : LoopRecord
    facts : SignalFacts
        Of its OP.

    Examples
    --------
    >>> from lostmotion.records.signal_facts import describe_signal
    >>> op = np.r_[np.linspace(0, 9, 10), np.full(10, 9.0)]
    >>> record = LoopRecord(op, op, dt=1.0, op_span=(0, 9))
    >>> saturation(record, describe_signal("OP", op, np.ones(19, dtype=bool)))
    (0.05, 0.55)
    """
    values, span, acts = record.op, record.op_span, rows_of("automatic", record.mode)
    if facts.constant:
        return 0.0, 0.0
    if acts is not None:
        values = np.where(acts, values, np.nan)
    if span is not None:
        margin = SPAN_MARGIN * (span[1] - span[0])
        return _share(values <= span[0] + margin), _share(values >= span[1] - margin)
    margin = FINE_STEP * (facts.high - facts.low)
    low, high = _long(values <= facts.low + margin), _long(values >= facts.high - margin)
    elsewhere = facts.flat_share - low - high
    return (0.0, 0.0) if elsewhere > FLAT_SHARE * (1 - low - high) else (low, high)


def _share(flags: Bools) -> float:
    return float(np.mean(flags))


def _long(flags: Bools) -> float:
    lengths = runs(flags)[1]
    return float(lengths[lengths >= SATURATED_RUN].sum() / len(flags))


def _mode(op: SignalFacts, moves: int | None, samples: int) -> str:
    if op.constant:
        return "manual: OP constant"
    if moves is None:
        return "open loop in steps, or no SP recorded" if op.flat_share > FLAT_SHARE else "no SP recorded"
    if moves == 0:
        return "automatic, SP constant"
    if moves > MOVING_SHARE * samples:
        return "cascade: SP moves all the time"
    return f"automatic, SP moved {moves} times" if moves > 1 else "automatic, SP moved once"
