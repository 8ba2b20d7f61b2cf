"""Values that stand still: a recording that stopped, a sensor that stuck, an OP that is held by hand.

Live signals repeat values too, the more the coarser their resolution. A stand-still counts only where the rate of
repetitions in the rest of the record makes its length incredible.
"""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.records import limits
from lostmotion.records.record import LoopRecord
from lostmotion.records.sampling import Bools, neighbours, runs


def stopped(record: LoopRecord) -> Bools:
    """Rows in which neither OP nor PV moves because the recording stopped; shape (n,).

    Runs that are hardly interrupted belong together. An OP that is moved in steps rests for long by nature, and so does
    the PV of a servo in a test; then nothing is said.

    Examples
    --------
    >>> op, pv = np.random.default_rng(0).normal(size=(2, 400))
    >>> op[100:140] = pv[100:140] = 0.3
    >>> int(stopped(LoopRecord(op, pv, dt=1.0)).sum())
    39
    """
    follows = neighbours(record)
    op_still, pv_still = (np.diff(signal) == 0 for signal in (record.op, record.pv))
    still = op_still & pv_still & follows
    rows = np.zeros(len(record), dtype=np.bool_)
    if not (is_live(op_still & follows) and is_live(pv_still & follows)):
        return rows
    starts, lengths = runs(_joined(still))
    least = max(limits.FROZEN_RUN - 1, improbable_run(still))
    for start, length in zip(starts, lengths, strict=True):
        if length >= least:
            rows[start + 1 : start + length + 1] = True  # the first row is the last true value
    return rows


def stuck(record: LoopRecord) -> Bools:
    """Rows in which PV stands still though its noise is visible in the rest of the record; shape (n,).

    Without visible noise a PV that rests may be lost motion, and nothing is said.

    Examples
    --------
    >>> op, pv = np.random.default_rng(0).normal(size=(2, 400))
    >>> pv[100:140] = 0.3
    >>> int(stuck(LoopRecord(op, pv, dt=1.0)).sum())
    39
    """
    follows = neighbours(record)
    still = (np.diff(record.pv) == 0) & follows
    rows = np.zeros(len(record), dtype=np.bool_)
    live = is_live((np.diff(record.op) == 0) & follows) and is_live(still)
    if not (live and noise_is_visible(record.pv)):
        return rows
    starts, lengths = runs(still)
    least = max(limits.FROZEN_RUN - 1, improbable_run(still))
    for start, length in zip(starts, lengths, strict=True):
        if length >= least:
            rows[start + 1 : start + length + 1] = True
    return rows


def held_op(record: LoopRecord) -> Bools:
    """Rows in which OP stands still for long while PV moves: manual, or an OP that is not recorded; shape (n,).

    Holds that follow each other at different levels are a test by hand, the best of data, and are not meant;
    neither is OP at its highest or lowest value, where it is at a limit.

    Examples
    --------
    >>> op, pv = np.random.default_rng(0).normal(size=(2, 400))
    >>> op[100:200] = 0.3
    >>> int(held_op(LoopRecord(op, pv, dt=1.0)).sum())
    99
    """
    op, pv = record.op, record.pv
    still = (np.diff(op) == 0) & neighbours(record)
    rows = np.zeros(len(op), dtype=np.bool_)
    if np.isnan(op).all() or not is_live(still):
        return rows
    starts, lengths = runs(still)
    least = max(limits.HELD_OP_RUN - 1, improbable_run(still))
    extremes = (np.nanmin(op), np.nanmax(op))
    for start, length in zip(starts, lengths, strict=True):
        if length < least or op[start] in extremes or _in_a_test(start, length, starts, lengths):
            continue
        if np.any(np.diff(pv[start : start + length + 1]) != 0):
            rows[start + 1 : start + length + 1] = True
    return rows


def is_live(still: Bools) -> bool:
    """Whether a signal moves in most rows, its long stand-stills aside.

    Examples
    --------
    >>> is_live(np.r_[np.zeros(50, dtype=bool), np.ones(500, dtype=bool)]), is_live(np.ones(50, dtype=bool))
    (True, False)
    """
    return rate(still) < 1.0 - limits.LIVE_SHARE


def improbable_run(still: Bools) -> int:
    """Length of a run that chance does not make, given how often shorter ones occur.

    Examples
    --------
    >>> improbable_run(np.arange(1000) % 2 == 0)
    20
    """
    share = rate(still)
    if share <= 0.0:
        return limits.SHORT_STILL
    if share >= 1.0:
        return len(still) + 1
    return max(int(np.ceil(np.log(limits.CHANCE / len(still)) / np.log(share))), limits.SHORT_STILL)


def noise_is_visible(values: FloatArray) -> bool:
    """Whether successive moves of a signal turn back so often that noise makes them.

    Examples
    --------
    >>> noise_is_visible(np.random.default_rng(0).normal(size=200)), noise_is_visible(np.sin(np.arange(200) / 9))
    (True, False)
    """
    moves = np.diff(values)
    moves = moves[~np.isnan(moves) & (moves != 0)]
    return len(moves) > 2 and float(np.mean(moves[1:] * moves[:-1] < 0)) > limits.VISIBLE_NOISE


def rate(still: Bools) -> float:
    """Share of repeated values where the signal is live: runs of 8 and more aside; 1 where it never is."""
    lengths = runs(still)[1]
    long = lengths >= limits.SHORT_STILL
    moving = len(still) - int(lengths[long].sum())
    # every move between long runs would count as live; a signal that only steps has hardly any
    if moving <= int(long.sum()) + 1:
        return 1.0
    return float(lengths[~long].sum() / moving)


def _joined(still: Bools) -> Bools:
    """Join runs of some length that only a few moving rows separate."""
    starts, lengths = runs(still)
    long = lengths >= limits.SHORT_STILL
    joined = still.copy()
    ends = (starts + lengths)[long]
    for stop, start in zip(ends[:-1], starts[long][1:], strict=True):
        if start - stop <= limits.JOIN_ROWS:
            joined[stop:start] = True
    return joined


def _in_a_test(start: int, length: int, starts: np.ndarray, lengths: np.ndarray) -> bool:
    """Whether another hold of some length ends or begins next to this one."""
    long = lengths >= limits.HELD_OP_RUN // 3
    before = np.abs(starts + lengths - start) <= limits.TEST_ROWS
    after = np.abs(starts - (start + length)) <= limits.TEST_ROWS
    return bool(np.any(long & (before | after) & (starts != start)))
