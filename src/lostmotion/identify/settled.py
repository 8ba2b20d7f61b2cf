"""Whether a loop settles between the rows of its record."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.identify.news import longest

ANSWER, FEWEST_MOVES = 10, 5  # rows until PV has answered, and moves of SP that tell it
LEAST_ANSWER = 0.5  # of the move: PV follows SP within these rows


def settled_by(y: FloatArray, sp: FloatArray | None, segments: IntArray) -> float:
    """Share of its answer to a move of SP that PV has given a row after it; 0 where moves of SP do not tell.

    Parameters
    ----------
    y : ndarray, shape (n,)
        PV, segments one after the other.
    sp : ndarray, shape (n,), or None
    segments : ndarray, shape (s, 2)
        First row and the row behind the last.
    """
    if sp is None:
        return 0.0
    rows, moves = [], []
    for start, stop in longest(segments):
        now = np.arange(start + ANSWER + 1, stop)
        rows.append(sp[now[:, None] - np.arange(ANSWER + 1)] - sp[now[:, None] - np.arange(1, ANSWER + 2)])
        moves.append(y[now] - y[now - 1])
    columns, moved = np.concatenate(rows), np.concatenate(moves)
    if np.count_nonzero(columns[:, 0]) < FEWEST_MOVES or len(columns) < 10 * ANSWER:
        return 0.0
    answer = np.linalg.lstsq(columns, moved, rcond=None)[0].cumsum()
    return float(answer[1] / answer[-1]) if answer[-1] > LEAST_ANSWER else 0.0
