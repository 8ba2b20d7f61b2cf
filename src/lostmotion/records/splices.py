"""Two recordings glued together: OP and PV jump in one row and stay there, and nothing in the loop commanded it."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.records import limits
from lostmotion.records.record import LoopRecord
from lostmotion.records.sampling import neighbours

SIDE = 10  # rows on either side whose medians must differ as well
ABOUT = 50  # rows on either side: what the signals run through there anyway is no jump
ANSWER = 3  # rows within which PV of a process that is faster than its rows answers
ALIKE = 2.0  # ratio of two answers that are the same one: PV overshoots, or has not arrived yet
NOISE_ROWS, OTHER_NOISE = 200, 2.0  # rows on either side whose usual moves are compared, and their ratio
LIKE_IT = 0.3  # of the move at the jump: moves elsewhere that are large enough to see the answer of PV


def splices(record: LoopRecord) -> tuple[int, ...]:
    """Rows before which another recording ends: OP and PV both jump there, far and for good.

    A wild sample comes back. A step of SP or OP moves PV in the same row only where the process is faster than the
    rows: then PV answers other such steps of the record as fast, and a lone step of SP to which PV goes is believed.

    Examples
    --------
    >>> op, pv = np.random.default_rng(0).normal(size=(2, 400))
    >>> op[250:] += 90.0
    >>> pv[250:] -= 70.0
    >>> splices(LoopRecord(op, pv, dt=1.0))
    (250,)
    """
    follows = neighbours(record)
    far = np.ones(len(record) - 1, dtype=np.bool_)
    for signal in (record.op, record.pv):
        moves = np.where(follows, np.abs(np.diff(signal)), 0.0)
        moving = moves[moves > 0]
        if not len(moving):
            return ()
        far &= moves > limits.SPLICE_SIZE * float(np.median(moving))
    rows = (int(row) + 1 for row in np.flatnonzero(far))
    return tuple(row for row in rows if _stays(record, row) and _apart(record, row) and _foreign(record, row))


def _stays(record: LoopRecord, row: int) -> bool:
    """Whether both signals stay on the other side of the jump."""
    for signal in (record.op, record.pv):
        before, after = signal[max(row - SIDE, 0) : row], signal[row : row + SIDE]
        jump = abs(float(signal[row] - signal[row - 1]))
        if not abs(float(np.nanmedian(after) - np.nanmedian(before))) > 0.5 * jump:
            return False
    return True


def _apart(record: LoopRecord, row: int) -> bool:
    """Whether both signals jump farther than they run in the rows about it: of an archive most moves are tiny."""
    for signal in (record.op, record.pv):
        jump = abs(float(signal[row] - signal[row - 1]))
        sides = signal[max(row - ABOUT, 0) : row], signal[row : row + ABOUT]
        if any(jump < float(np.nanmax(side) - np.nanmin(side)) for side in sides):
            return False
    return True


def _foreign(record: LoopRecord, row: int) -> bool:
    """Whether nothing commanded the jump; what PV followed is a command where noise and controller stay the same."""
    return not _commanded(record, row) or _other_noise(record, row)


def _other_noise(record: LoopRecord, row: int) -> bool:
    """Whether OP or PV moves from row to row by another amount before the jump than behind it."""
    for signal in (record.op, record.pv):
        sides = signal[max(row - SIDE - NOISE_ROWS, 0) : max(row - SIDE, 0)], signal[row + SIDE :][:NOISE_ROWS]
        moves = [np.abs(np.diff(side)) for side in sides]
        typical = [float(np.median(each[each > 0])) if np.sum(each > 0) > NOISE_ROWS // 4 else 0.0 for each in moves]
        if min(typical) > 0.0 and max(typical) > OTHER_NOISE * min(typical):
            return True
    return False


def _commanded(record: LoopRecord, row: int) -> bool:
    """Whether PV went where SP or OP sent it."""
    jump = float(record.pv[row] - record.pv[row - 1])
    before = max(row - ANSWER, 1)
    if record.sp is not None:
        moves = np.diff(record.sp[before - 1 : row + 1])
        moved = float(np.nansum(moves))
        if moved and 1.0 / ALIKE < jump / moved < ALIKE:
            answers = _answers(record, record.sp, moved, row)
            return not answers.size or _alike(float(np.median(answers)), jump / moved)
    moved = float(record.op[row] - record.op[row - 1])
    answers = _answers(record, record.op, moved, row)
    return bool(answers.size) and _alike(float(np.median(answers)), jump / moved)


def _alike(one: float, other: float) -> bool:
    return other != 0.0 and 1.0 / ALIKE < one / other < ALIKE


def _answers(record: LoopRecord, signal: FloatArray, moved: float, row: int) -> FloatArray:
    """Moves of PV for one of the signal (n,), of those elsewhere that are like this one and stay; shape (moves,)."""
    found = []
    steps = np.where(neighbours(record), np.diff(signal), 0.0)
    for at in np.flatnonzero(np.abs(steps) >= LIKE_IT * abs(moved)) + 1:
        first, last = int(at) - 1, int(at) + ANSWER
        if abs(int(at) - row) <= SIDE or last >= len(signal):
            continue
        went = float(signal[last] - signal[first])
        answer = float(record.pv[last] - record.pv[first])
        if np.isfinite(answer) and abs(went) >= LIKE_IT * abs(moved):
            found.append(answer / went)
    return np.array(found, dtype=np.float64)
