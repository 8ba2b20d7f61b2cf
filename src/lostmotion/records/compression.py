"""Rows that a historian made up: points on exact lines between stored values, values held until the next one.

An archive with a dead band stores a value only when it has moved enough (exception reporting), or when a straight
line from the last stored value would miss a sample (swinging door). On retrieval the rows between are interpolated or
held. Where the resolution of a signal is fine, neither happens by chance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.kernels.lines import knots
from lostmotion.records import limits
from lostmotion.records.quantum import quantum
from lostmotion.records.record import FloatArray, LoopRecord
from lostmotion.records.sampling import Bools, neighbours
from lostmotion.records.standstill import is_live

SINGLE = 2.4e-7  # relative rounding of single precision, twice
ROUNDING = 1e-9  # of the range: differences this small are float rounding
MOST_FACTOR = 1000


@dataclass(frozen=True)
class Compression:
    """Shares of rows of a signal that were not measured.

    Attributes
    ----------
    straight : float
        Rows inside exact, sloping lines of 4 points and more.
    held : float
        Rows that repeat the value before.
    """

    straight: float
    held: float

    @property
    def share(self) -> float:
        """Both together."""
        return self.straight + self.held


def compression(record: LoopRecord, name: str) -> Compression:
    """Shares of rows of OP or PV that look made up.

    Parameters
    ----------
    record : LoopRecord
    name : {"op", "pv"}
        Holds count for PV only, and only while OP is live: a controller may hold OP, an operator does, and PV then
        settles. OP on lines counts only while PV moves: the integral of a constant error is a line by nature.

    Examples
    --------
    >>> random = np.random.default_rng(0)
    >>> pv = np.interp(np.arange(1000), np.arange(0, 1001, 10), random.normal(size=101))
    >>> made_up = compression(LoopRecord(random.normal(size=1000), pv, dt=1.0), "pv")
    >>> round(made_up.straight, 1), made_up.held
    (0.9, 0.0)
    """
    values: FloatArray = getattr(record, name)
    known = values[~np.isnan(values)]
    live = is_live((np.diff(record.op) == 0) & neighbours(record))
    if len(known) < limits.STRAIGHT_ROWS or known.min() == known.max():
        return Compression(0.0, 0.0)
    step = quantum(values)
    moves = np.abs(np.diff(known))
    coarse = float(np.median(moves[moves > 0])) < limits.FINE_RESOLUTION * step
    tolerance = max(step, SINGLE * float(np.abs(known).max()))
    sloping, level = _made_up(record, values, tolerance, limits.COARSE_ROWS if coarse else limits.STRAIGHT_ROWS)
    if name == "pv" and not live:  # OP in steps: PV that has settled rests, and that is no historian's work
        return Compression(0.0 if coarse else float(np.mean(sloping)), 0.0)
    if name == "op":
        moving = np.r_[False, np.diff(record.pv) != 0]
        return Compression(float(np.mean(sloping & moving)), 0.0)
    held = level if coarse else level | np.r_[False, (np.diff(values) == 0) & neighbours(record)]
    return Compression(float(np.mean(sloping)), float(np.mean(held)))


def _made_up(record: LoopRecord, values: FloatArray, tolerance: float, points: int) -> tuple[Bools, Bools]:
    """Rows inside sloping and level lines of at least `points` samples that end in a sharp bend; shape (n,) each.

    A smooth curve that was rounded is a chain of short lines too, but these bend by a few steps over their length.
    """
    sloping, level = np.zeros((2, len(values)), dtype=np.bool_)
    at = knots(np.where(_broken(record), np.nan, values) if record.gaps else values, tolerance)
    length = np.diff(at)
    with np.errstate(invalid="ignore"):
        slope = np.diff(values[at]) / length
        bend = np.abs(np.diff(slope, append=np.nan)) * length
        bend = np.fmax(bend, np.abs(np.diff(slope, prepend=np.nan)) * length)
        chosen = (length + 1 >= points) & (bend > limits.SHARP_BEND * tolerance)
    for line in np.flatnonzero(chosen):
        inside = slice(at[line] + 1, at[line + 1])
        rows = level if abs(slope[line] * length[line]) <= tolerance else sloping
        rows[inside] = True
    return sloping, level


def _broken(record: LoopRecord) -> Bools:
    """Rows before which time is missing: a line does not cross them."""
    rows = np.zeros(len(record), dtype=np.bool_)
    rows[[row for row in record.gaps if 0 < row < len(record)]] = True
    return rows


def scan_factor(record: LoopRecord) -> tuple[int, int]:
    """Rows per true sample, and the first row of one, where the record only repeats or interpolates a slower scan.

    Returns
    -------
    (factor, phase)
        (1, 0) where it does not.

    Examples
    --------
    >>> op, pv = np.random.default_rng(0).normal(size=(2, 100))
    >>> scan_factor(LoopRecord(np.repeat(op, 5)[3:], np.repeat(pv, 5)[3:], dt=1.0))
    (5, 2)
    >>> scan_factor(LoopRecord(op, pv, dt=1.0))
    (1, 0)
    """
    if record.gaps or record.missing.any():
        return 1, 0
    bends = _bends(record.pv)
    if len(bends) < limits.FROZEN_RUN:
        return 1, 0
    spacing = np.diff(bends)
    factor = int(np.median(spacing))
    if not 1 < factor <= MOST_FACTOR or len(bends) * factor < 0.5 * len(record):
        return 1, 0
    phase = int(np.bincount(bends % factor, minlength=factor).argmax())
    steps = np.flatnonzero(np.diff(record.op)) + 1
    on = float(np.mean(bends % factor == phase))
    op_bends = _bends(record.op)
    on_op = float(np.mean(op_bends % factor == phase)) if len(op_bends) else 1.0
    jumps = float(np.mean(steps % factor == phase)) if len(steps) else 1.0
    regular = on >= limits.ON_PHASE and max(on_op, jumps) >= limits.ON_PHASE
    return (factor, phase) if regular else (1, 0)


def _bends(values: FloatArray) -> np.ndarray:
    """Rows at which a signal begins something new: a jump after a hold, or the end of a line."""
    moves = np.diff(values)
    still = moves == 0
    if np.mean(still) > limits.LIVE_SHARE:
        return np.flatnonzero(~still) + 1
    tolerance = ROUNDING * float(np.ptp(values))
    return np.flatnonzero(np.abs(np.diff(moves)) > tolerance) + 1
