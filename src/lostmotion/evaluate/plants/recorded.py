"""Signals of a made loop -> LoopRecord as a historian gives it back."""

from __future__ import annotations

from datetime import datetime

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray
from lostmotion.evaluate.plants import historian
from lostmotion.evaluate.plants.made_loop import MadeLoop
from lostmotion.records import LoopRecord

MODES = np.array(["MAN", "AUTO", "CAS"])
Signals = tuple[FloatArray, FloatArray, FloatArray, npt.NDArray[np.int8]]


def loop_record(
    random: np.random.Generator, loop: MadeLoop, signals: Signals, how: str, dt: float, start: datetime
) -> LoopRecord:
    """OP in %, PV and SP in engineering units; PV through what the historian does to it."""
    op, pv, sp, mode = signals
    low, high = loop.pv_span
    step = historian.resolution(random, how)
    op = historian.rounded(op, max(100.0 * step, 0.01))
    pv, sp = (historian.rounded(low + (high - low) * one / 100.0, (high - low) * step) for one in (pv, sp))
    if how == "compressed":
        dead_band = float(random.uniform(*historian.EXCEPTION))
        pv, op = historian.reported(pv, dead_band * (high - low)), historian.reported(op, 100.0 * dead_band)
    if how == "stale":
        rows = historian.stretches(random, pv.size, float(random.uniform(*historian.STALE)))
        pv, op, sp = (historian.held(one, rows) for one in (pv, op, sp))
    if how == "gaps":
        rows = historian.stretches(random, pv.size, float(random.uniform(*historian.MISSING)))
        pv = np.where(rows, np.nan, pv)
    return LoopRecord(
        op, pv, sp, dt=dt, mode=MODES[mode.astype(np.intp)], op_span=(0.0, 100.0), pv_span=loop.pv_span, tag=loop.tag,
        source=loop.area, loop_type=loop.loop_type, start=start, op_unit="%", pv_unit=loop.pv_unit,
    )  # fmt: skip
