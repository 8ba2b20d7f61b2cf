"""Cascades, told from the data: OP of a master is the set point of its slave, up to a straight line."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray
from lostmotion.records.record import LoopRecord

MOMENTS = 256  # at which signals are compared, at most: 2 kB a loop
LEAST_MOVES = 40  # of a set point between them: less may be an operator, and one step is like any other
# Correlation of values and of moves: 14 cascades of three simulated plants, whose OP and SP were not all written at one
# moment, have 0.956 and 0.736 at least, all other pairs 0.703 and 0.349 at most.
ALIKE, ALIKE_MOVES = 0.9, 0.6

Sketch = npt.NDArray[np.float32]
Clock = tuple[float, int, int]  # seconds between moments, number of the first, how many


@dataclass(frozen=True, eq=False)
class _Seen:
    tag: str
    op: Sketch
    sp: Sketch | None  # None: it rests


class Cascades:
    """Loops as they are read, a sketch of each; then which of them sets the set point of which.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> op = 50.0 + np.cumsum(rng.normal(size=4000))
    >>> seen = Cascades()
    >>> seen.add("LIC-1", LoopRecord(op, rng.normal(size=4000), dt=1.0))
    >>> seen.add("FIC-2", LoopRecord(np.cumsum(rng.normal(size=4000)), op, sp=3.0 * op - 20.0, dt=1.0))
    >>> seen.slaves()
    {'LIC-1': 'FIC-2'}
    """

    def __init__(self) -> None:
        self._seen: dict[Clock, list[_Seen]] = {}

    def add(self, tag: str, record: LoopRecord) -> None:
        """Keep what is needed of one record; those of other times than others are compared among themselves."""
        times = _seconds(record)
        clock, moments = _moments(times)
        op = _at(record.op, times, moments)
        sp = None if record.sp is None else _at(record.sp, times, moments)
        if sp is not None and int(np.count_nonzero(np.diff(sp))) < LEAST_MOVES:
            sp = None
        if op is not None:
            self._seen.setdefault(clock, []).append(_Seen(tag, op, sp))

    def slaves(self) -> dict[str, str]:
        """Tag of the slave of each master; of several slaves the one that is most like."""
        found: dict[str, tuple[float, str]] = {}
        for seen in self._seen.values():
            ops = np.stack([one.op for one in seen])
            for place, one in enumerate(seen):
                if one.sp is None:
                    continue
                like = _likeness(ops, one.sp)
                like[place] = 0.0
                best = int(np.argmax(like))
                if like[best] > found.get(seen[best].tag, (0.0, ""))[0]:
                    found[seen[best].tag] = float(like[best]), one.tag
        return {master: slave for master, (_, slave) in found.items()}


def _likeness(ops: Sketch, sp: Sketch) -> FloatArray:
    """Correlation of the moves of each OP with those of SP where SP moved; 0 where it is too small; shape (n,)."""
    moved = np.flatnonzero(np.diff(sp))
    values = np.abs(_correlation(ops[:, moved + 1], sp[moved + 1]))
    moves = np.abs(_correlation(np.diff(ops, axis=1)[:, moved], np.diff(sp)[moved]))
    return np.asarray(np.where((values >= ALIKE) & (moves >= ALIKE_MOVES), moves, 0.0))


def _correlation(rows: Sketch, one: Sketch) -> FloatArray:
    apart = rows - rows.mean(axis=1, keepdims=True)
    other = one - one.mean()
    sizes = np.linalg.norm(apart, axis=1) * np.linalg.norm(other)
    return np.asarray(apart @ other / np.maximum(sizes, 1e-30), dtype=np.float64)


def _seconds(record: LoopRecord) -> FloatArray:
    """Of each row since 1970, of an undated record since its first."""
    times = np.arange(len(record), dtype=np.float64) * record.dt
    for row, lost in zip(record.gaps, record.gap_seconds, strict=False):
        times[row:] += lost
    if record.start is None:
        return np.asarray(times, dtype=np.float64)
    start = record.start.replace(tzinfo=UTC) if record.start.tzinfo is None else record.start
    return np.asarray(times + start.timestamp())


def _moments(times: FloatArray) -> tuple[Clock, FloatArray]:
    """Whole multiples of so many seconds, a power of two, within the times."""
    step = 2.0 ** np.ceil(np.log2(max(float(times[-1] - times[0]), 1e-6) / MOMENTS))
    first, last = int(np.ceil(times[0] / step)), int(times[-1] // step)
    return (float(step), first, last - first + 1), np.arange(first, last + 1) * step


def _at(values: FloatArray, times: FloatArray, moments: FloatArray) -> Sketch | None:
    """The last known values before moments, less their mean; None: nothing is known before the first."""
    known = np.flatnonzero(np.isfinite(values))
    place = np.searchsorted(times[known], moments, side="right") - 1
    if not place.size or place[0] < 0:
        return None
    found = values[known][place]
    return np.asarray(found - found.mean(), dtype=np.float32)
