"""Fewer samples of the same loop: averages of PV over blocks, or the rows of a slower scan."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.errors import DataError, ParameterError
from lostmotion.records.as_record import RecordLike, as_record
from lostmotion.records.record import LoopRecord


def resample(record: RecordLike, factor: int) -> LoopRecord:
    """Take one row a block of `factor` rows, PV averaged, for a sampling that is too fast for the dynamics.

    Parameters
    ----------
    record : LoopRecord, path, data frame or dict of columns
        As it was read, or to be read by :func:`lostmotion.read_loop`, or a prepared stretch.
    factor : int
        Rows a block, at least 1.

    Returns
    -------
    LoopRecord
        With ``dt`` times `factor`. OP, SP, position and mode are those of the first row of each block. PV is the mean
        over the `factor` rows that end with that row, so that it holds nothing which this OP could have moved, and OP
        nothing that answers to its noise: the delay stays at least one sample where it was. PV is missing where more
        than half of these are. No block crosses a gap; what is left over before it is lost.

    Raises
    ------
    ParameterError
        `factor` is not a whole number of at least 1.
    DataError
        Fewer than two blocks.

    Notes
    -----
    OP is held between samples, so its mean over a block looks like the better choice. In closed loop it is a wrong
    one: it answers to the noise of the PV with which it would be compared, and the break points come out wrong by
    half their distance (docs/records.md). What OP does inside a block is not seen, so a block must be short against
    its moves.

    Examples
    --------
    >>> slower = resample(LoopRecord([1, 3, 5, 7, 9, 11], [0, 2, 4, 6, 8, 10], dt=0.5), 2)
    >>> slower.op.tolist(), slower.pv.tolist()
    ([5.0, 9.0], [3.0, 7.0])
    """
    if isinstance(factor, bool) or not isinstance(factor, int | np.integer) or factor < 1:
        raise ParameterError.expected("factor as a whole number >= 1", repr(factor), "e.g. resample(record, 5)")
    record = as_record(record)
    if factor == 1:
        return record
    edges = [0, *(gap for gap in record.gaps if 0 < gap < len(record)), len(record)]
    blocks = [range(start + factor, stop - factor + 1, factor) for start, stop in pairwise(edges)]
    starts = np.array([row for piece in blocks for row in piece], dtype=np.int64)
    if len(starts) < 2:
        raise DataError.expected(f"2 blocks of {factor} rows", f"{len(record)} rows", "use a smaller factor")
    gaps = np.cumsum([len(piece) for piece in blocks])[:-1]
    first = {name: getattr(record, name) for name in ("op", "sp", "position", "mode")}
    chosen: dict[str, Any] = {name: None if value is None else value[starts] for name, value in first.items()}
    return replace(
        record,
        **chosen,
        pv=_mean(record.pv[starts[:, None] - np.arange(factor)]),
        dt=record.dt * factor,
        gaps=tuple(sorted({int(gap) for gap in gaps if 0 < gap < len(starts)})),
        gap_seconds=(),
        start=record.moment(int(starts[0])),
        notes=(*record.notes, f"Resampled to {record.dt * factor:g} s: PV averaged over {factor} rows, OP of one."),
    )


def pick(record: LoopRecord, factor: int, phase: int) -> LoopRecord:
    """Take every `factor`-th row from `phase` on: exact where the rows between only repeat or interpolate.

    Examples
    --------
    >>> pick(LoopRecord([1, 1, 2, 2], [3, 3, 4, 4], dt=0.5), 2, 0)
    LoopRecord('': 2 samples of OP, PV every 1 s, 2 s)
    """
    rows = slice(phase, None, factor)
    signals = {name: getattr(record, name) for name in ("op", "pv", "sp", "position", "mode")}
    picked: dict[str, Any] = {name: None if value is None else value[rows] for name, value in signals.items()}
    return replace(record, **picked, dt=record.dt * factor, start=record.moment(phase))


def _mean(blocks: FloatArray) -> FloatArray:
    """Mean of the known samples of each block; NaN where more than half are missing."""
    known = ~np.isnan(blocks)
    count = known.sum(axis=1)
    total = np.where(known, blocks, 0.0).sum(axis=1)
    return np.where(2 * count >= blocks.shape[1], total / np.maximum(count, 1), np.nan)
