"""The liveliest pieces of a long record: enough to choose among structures, which are then refined on all of it."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.identify.likelihood.remembered import remembered
from lostmotion.identify.scaled import ScaledData

MOST_ROWS = 6_000  # of rough fits: what they cannot tell apart is refined on all rows and only then compared
PIECES = 3  # of that length together; each has initial conditions of its own


@remembered
def excerpt(data: ScaledData, most: int = MOST_ROWS) -> IntArray:
    """Segments (s, 2) of at most about `most` rows in which OP moves most; all where there are no more.

    Pieces next to each other stay one segment.
    """
    if data.u.size <= most:
        return data.segments
    pieces = [piece for segment in data.segments.tolist() for piece in _cut(segment[0], segment[1], most // PIECES)]
    order = np.argsort(-_deviations(data.u, np.array(pieces)), kind="stable").tolist()
    kept: list[tuple[int, int]] = []
    for index in sorted(_until_full(order, pieces, most)):
        start, stop = pieces[index]
        if kept and kept[-1][1] == start and not np.any(data.segments[:, 0] == start):
            start = kept.pop()[0]
        kept.append((start, stop))
    return np.array(kept)


def alone(data: ScaledData, rows: IntArray) -> ScaledData:
    """The data of these segments (s, 2) and nothing else, one after the other."""
    if rows is data.segments:
        return data
    u, y = (np.concatenate([signal[start:stop] for start, stop in rows]) for signal in (data.u, data.y))
    stops = np.cumsum(rows[:, 1] - rows[:, 0])
    return replace(data, u=u, y=y, segments=np.column_stack([np.append(0, stops[:-1]), stops]))


def _cut(start: int, stop: int, length: int) -> list[tuple[int, int]]:
    """A segment in equal pieces of about this length."""
    count = max((stop - start) // length, 1)
    bounds = np.linspace(start, stop, count + 1).astype(int).tolist()
    return list(pairwise(bounds))


def _deviations(u: FloatArray, pieces: IntArray) -> FloatArray:
    """Of each piece."""
    starts, stops = pieces.T
    first, second = (np.append(0.0, np.cumsum(values)) for values in (u, u * u))
    lengths = stops - starts
    means = (first[stops] - first[starts]) / lengths
    return np.asarray(np.sqrt(np.maximum((second[stops] - second[starts]) / lengths - means * means, 0.0)))


def _until_full(order: list[int], pieces: list[tuple[int, int]], most: int) -> list[int]:
    """The first of them, as long as the rows are not enough."""
    lengths = np.array([pieces[index][1] - pieces[index][0] for index in order])
    return order[: int(np.searchsorted(np.cumsum(lengths), most - lengths[0] // 2)) + 1]
