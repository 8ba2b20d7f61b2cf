"""What is known about the rows of a record: how many, how regular, what is missing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import IntArray
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
        Samples in the longest stretch without gap or missing row.
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
    >>> describe_sampling(LoopRecord([1, 2, np.nan, 4], [1, 2, 3, 4], dt=0.5, gaps=(1,))).longest_piece
    1
    """
    pieces = np.diff(np.flatnonzero(np.r_[True, _breaks(record), True]))
    whole = pieces[~record.missing[np.r_[0, np.cumsum(pieces)[:-1]]]]
    return Sampling(
        samples=len(record),
        dt=record.dt,
        seconds=len(record) * record.dt,
        gaps=len(record.gaps),
        missing=int(record.missing.sum()),
        longest_piece=int(whole.max(initial=0)),
    )


def _breaks(record: LoopRecord) -> Bools:
    """Tell for each row but the first whether a new piece starts there."""
    breaks: Bools = np.diff(record.missing.astype(np.int8)) != 0
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
