"""Fewer samples of the same loop: averages over blocks, or the rows of a slower scan."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lostmotion.errors import DataError
from lostmotion.records.record import FloatArray, LoopRecord


def pick(record: LoopRecord, factor: int, phase: int) -> LoopRecord:
    """Take every `factor`-th row from `phase` on: exact where the rows between only repeat or interpolate.

    Examples
    --------
    >>> pick(LoopRecord([1, 1, 2, 2], [3, 3, 4, 4], dt=0.5), 2, 0)
    LoopRecord('': 2 samples of OP, PV every 1 s, 2 s)
    """
    rows = slice(phase, None, factor)
    signals = {name: getattr(record, name) for name in ("op", "pv", "sp", "position", "mode")}
    picked = {name: None if value is None else value[rows] for name, value in signals.items()}
    return replace(record, **picked, dt=record.dt * factor)
