"""What of a signal its past and other signals do not tell: its news."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.triangular import STRETCH, triangular

FEWEST = 10  # rows for every regressor
MOST_ROWS = 20_000  # that are looked at: more than enough where anything but PV moves OP

Spans = list[tuple[int, int]]


def longest(segments: IntArray) -> Spans:
    """The longest segments, of so many rows in all."""
    found, left = [], MOST_ROWS
    for start, stop in sorted(segments.tolist(), key=lambda ends: ends[0] - ends[1]):
        if left > 0:
            found.append((start, min(stop, start + left)))
            left -= stop - start
    return found


def standard(x: FloatArray) -> FloatArray:
    """With mean 0 and deviation 1."""
    return np.asarray((x - x.mean()) / max(float(x.std()), 1e-300))


def news(x: FloatArray, others: tuple[FloatArray, ...], spans: Spans, lags: int) -> FloatArray:
    """What past x, and the others up to now, do not tell of x (n,); 0 where there is no past.

    Parameters
    ----------
    x : ndarray, shape (n,)
    others : tuple of ndarray, shape (n,)
    spans : list of (int, int)
        First row and the row behind the last of what belongs together.
    lags : int
        Past rows of each.
    """

    def rows(start: int, stop: int) -> FloatArray:
        now = np.arange(start, stop)[:, None]
        past = [np.ones(now.shape), x[now - np.arange(1, lags + 1)]]
        return np.hstack([*past, *(other[now - np.arange(lags + 1)] for other in others), x[now]])

    inner = [(start + lags, stop) for start, stop in spans if stop - start > lags]
    columns = lags + 2 + len(others) * (lags + 1)
    found = np.zeros(x.size)
    if sum(stop - start for start, stop in inner) < FEWEST * columns:
        return found
    root = triangular(rows, inner, columns)
    weights = np.linalg.lstsq(root[:, :-1], root[:, -1], rcond=None)[0]
    for start, stop in inner:
        for first in range(start, stop, STRETCH):
            part = rows(first, min(first + STRETCH, stop))
            found[first : first + len(part)] = part[:, -1] - part[:, :-1] @ weights
    return found
