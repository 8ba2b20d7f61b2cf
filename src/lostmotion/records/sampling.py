"""What is known about the rows of a record: how many, how regular, what is missing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import IntArray
from lostmotion.records import limits
from lostmotion.records.record import LoopRecord

Bools = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Sampling:
    """Rows of a record.

    Parameters
    ----------
    samples : int
        Rows.
    dt : float
        Sampling time in seconds.
    seconds : float
        Length, without what gaps left out.
    gaps : int
        Places where time is missing.
    missing : int
        Rows in which OP or PV is missing.
    longest_piece : int
        Samples in the longest stretch without gap or missing row; scattered missing samples do not end it.
    """

    samples: int
    dt: float
    seconds: float
    gaps: int
    missing: int
    longest_piece: int

    @property
    def missing_share(self) -> float:
        """Share of rows in which OP or PV is missing."""
        return self.missing / self.samples


def describe_sampling(record: LoopRecord) -> Sampling:
    """Count rows, gaps and missing rows.

    Examples
    --------
    >>> op = np.where(np.arange(200) // 10 == 9, np.nan, 1.0)
    >>> describe_sampling(LoopRecord(op, np.ones(200), dt=0.5, gaps=(130,))).longest_piece
    90
    """
    holes = record.missing & ~short_gaps(record)
    pieces = np.diff(np.flatnonzero(np.r_[True, _breaks(record, holes), True]))
    whole = pieces[~holes[np.r_[0, np.cumsum(pieces)[:-1]]]]
    return Sampling(
        samples=len(record),
        dt=record.dt,
        seconds=len(record) * record.dt,
        gaps=len(record.gaps),
        missing=int(record.missing.sum()),
        longest_piece=int(whole.max(initial=0)),
    )


def short_gaps(record: LoopRecord) -> Bools:
    """Missing rows between others, few in a row and few in all: they need not cut the record; shape (n,).

    Examples
    --------
    >>> pv = np.arange(100.0)
    >>> pv[[0, 20, 21, 99]] = pv[40:50] = np.nan
    >>> np.flatnonzero(short_gaps(LoopRecord(np.ones(100), pv, dt=1.0))).tolist()
    [20, 21]
    """
    short = np.zeros(len(record), dtype=np.bool_)
    ends = np.zeros(len(record) + 1, dtype=np.bool_)
    ends[[0, *record.gaps, len(record)]] = True
    for start, length in zip(*runs(record.missing), strict=True):
        stop = start + length
        short[start:stop] = length <= limits.BRIDGE_ROWS and not ends[start : stop + 1].any()
    return short if short.mean() <= limits.BRIDGE_SHARE else np.zeros_like(short)


def _breaks(record: LoopRecord, holes: Bools) -> Bools:
    """Tell for each row but the first whether a new piece starts there."""
    breaks: Bools = np.diff(holes.astype(np.int8)) != 0
    inside = [row - 1 for row in record.gaps if 0 < row < len(record)]
    breaks[inside] = True
    return breaks


def neighbours(record: LoopRecord) -> Bools:
    """Tell for each row but the first whether it follows its predecessor by dt, shape (n - 1,)."""
    follows = np.ones(len(record) - 1, dtype=np.bool_)
    follows[[row - 1 for row in record.gaps if 0 < row < len(record)]] = False
    return follows


def runs(flags: Bools) -> tuple[IntArray, IntArray]:
    """Find starts and lengths of the runs of True.

    Examples
    --------
    >>> runs(np.array([True, False, True, True]))
    (array([0, 2]), array([1, 2]))
    """
    edges = np.diff(np.r_[False, flags, False].astype(np.int8))
    starts = np.flatnonzero(edges == 1)
    return starts, np.flatnonzero(edges == -1) - starts
