"""Which way a controller moves OP against PV, by moves of its set point.

Where a loop settles within a row or two, PV follows OP in the rows as if OP followed PV, the wrong way. Moves of the
set point come from outside, and tell: OP goes with them as the gain of the process asks, at once and for good.
"""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray, IntArray

BLOCK = 10  # rows: OP has begun to answer SP, and what PV does to it is not yet done
FEWEST = 12  # blocks


def against_pv(u: FloatArray, segments: IntArray, sp: FloatArray | None) -> float:
    """Standard errors of the way in which OP answers SP, the other way round: below 0 it falls where PV rises.

    Differences of means over ten rows, OP on SP; the error holds where the rest is larger beside moves (White 1980,
    Econometrica 48). In an independent simulation it had the right sign wherever it was beyond 5 and the answer of OP
    to PV had another.

    Parameters
    ----------
    u : ndarray, shape (n,)
        OP, segments one after the other.
    segments : ndarray, shape (s, 2)
        First row and the row behind the last.
    sp : ndarray, shape (n,), or None
        Set point; where it is not known or hardly moves, 0 is told.

    Examples
    --------
    >>> random = np.random.default_rng(0)
    >>> sp = np.repeat(random.normal(size=40), 25)
    >>> op = 2.0 * sp + 0.1 * random.normal(size=1000)
    >>> against_pv(op, np.array([[0, 1000]]), sp) < -5.0
    True
    """
    if sp is None:
        return 0.0
    spans = [(start, start + (stop - start) // BLOCK * BLOCK) for start, stop in segments.tolist()]
    moves = [[np.diff(x[a:b].reshape(-1, BLOCK).mean(axis=1)) for a, b in spans if b > a] for x in (sp, u)]
    if not moves[0]:
        return 0.0
    of_sp, of_op = (np.concatenate(parts) for parts in moves)
    size = float(of_sp @ of_sp)
    if of_sp.size < FEWEST or size <= 0.0:
        return 0.0
    gain = float(of_sp @ of_op) / size
    spread = float(np.linalg.norm(of_sp * (of_op - gain * of_sp)))
    return -gain * size / spread if spread > 0.0 else 0.0
