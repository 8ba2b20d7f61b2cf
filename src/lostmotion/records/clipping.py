"""Signals at the end of their range: PV that is cut off there."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.records import limits
from lostmotion.records.sampling import Bools, runs
from lostmotion.records.span import Span


def clipped(values: FloatArray, span: Span | None = None) -> Bools:
    """Rows in which a measurement is at the end of its range; shape (n,).

    Parameters
    ----------
    values : ndarray, shape (n,)
        Samples; NaN where missing.
    span : (float, float), optional
        Range of the transmitter. None: a range shows where the record ends in a pile: runs of the extreme value,
        which is much more frequent than the values next to it.

    Examples
    --------
    >>> wave = np.minimum(np.sin(np.arange(300) / 20.0), 0.9)
    >>> int(clipped(wave).sum()) == int(np.sum(wave == 0.9))
    True
    >>> int(clipped(np.round(np.sin(np.arange(300) / 20.0), 1)).sum())
    0
    """
    known = values[~np.isnan(values)]
    rows = np.zeros(len(values), dtype=np.bool_)
    if len(known) < 2 or known.min() == known.max():
        return rows
    if span is not None:
        margin = limits.FINE_STEP * (span[1] - span[0])
        return _in_runs(values <= span[0] + margin) | _in_runs(values >= span[1] - margin)
    levels, counts = np.unique(known, return_counts=True)
    for level, count, near in ((levels[0], counts[0], counts[1:4]), (levels[-1], counts[-1], counts[-4:-1])):
        if count >= limits.PILE_UP * near.sum():
            rows |= _in_runs(values == level)
    return rows if rows.sum() > _rests(values, levels[0], levels[-1]) else np.zeros_like(rows)


def _rests(values: FloatArray, low: float, high: float) -> int:
    """Rows between these in which the signal rests: as long there as at an end, it is no limit at which it rests."""
    starts, lengths = runs(np.diff(values) == 0.0)
    inner = (values[starts] > low) & (values[starts] < high)
    return int(lengths[inner & (lengths >= limits.SATURATED_RUN)].sum())


def _in_runs(flags: Bools) -> Bools:
    """Runs of some length among the flags; a few other rows between two flags, noise, belong to the run."""
    joined = flags.copy()
    at = np.flatnonzero(flags)
    for before, after in pairwise(at.tolist()):
        if after - before <= limits.JOIN_ROWS:
            joined[before:after] = True
    kept = np.zeros_like(flags)
    for start, length in zip(*runs(joined), strict=True):
        if length >= limits.SATURATED_RUN and flags[start : start + length].sum() >= limits.SATURATED_RUN:
            kept[start : start + length] = True
    return kept
