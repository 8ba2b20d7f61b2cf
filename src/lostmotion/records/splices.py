"""Two recordings glued together: OP and PV jump in one row and stay there."""

from __future__ import annotations

import numpy as np

from lostmotion.records import limits
from lostmotion.records.record import LoopRecord
from lostmotion.records.sampling import neighbours

SIDE = 10  # rows on either side whose medians must differ as well


def splices(record: LoopRecord) -> tuple[int, ...]:
    """Rows before which another recording ends: OP and PV both jump there, far and for good.

    A step of SP moves OP at once, but PV follows through the process; a wild sample comes back.

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
    return tuple(int(row) + 1 for row in np.flatnonzero(far) if _stays(record, int(row) + 1))


def _stays(record: LoopRecord, row: int) -> bool:
    """Whether both signals stay on the other side of the jump."""
    for signal in (record.op, record.pv):
        before, after = signal[max(row - SIDE, 0) : row], signal[row : row + SIDE]
        jump = abs(float(signal[row] - signal[row - 1]))
        if not abs(float(np.nanmedian(after) - np.nanmedian(before))) > 0.5 * jump:
            return False
    return True
