"""Rows that a historian made up: points on exact lines between stored values, values held until the next one.

An archive with a dead band stores a value only when it has moved enough (exception reporting), or when a straight
line from the last stored value would miss a sample (swinging door). On retrieval the rows between are interpolated or
held. Where the resolution of a signal is fine, neither happens by chance.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.lines import knots
from lostmotion.records import limits
from lostmotion.records.quantum import quantum
from lostmotion.records.record import LoopRecord
from lostmotion.records.sampling import Bools, neighbours, runs
from lostmotion.records.standstill import is_live

SINGLE = 2.4e-7  # relative rounding of single precision, twice
ROUNDING = 1e-9  # of the range: differences this small are float rounding
# Shares of rows that a historian made up. On lines, which foretell the next stored value, healthy valves seem to stick;
# held values lose what happened between, and that is less (docs/compensation-study.md).
MOST_ON_LINES = limits.COMPRESSED_TOLD
MOST_MADE_UP = limits.COMPRESSED_WARN
MOST_FACTOR = 1000  # rows per value of the scan: a slower scan leaves too few values to tell


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


@dataclass(frozen=True)
class MadeUp:
    """What a historian made up of OP and PV, as far as it matters to a fit."""

    op: Compression
    pv: Compression

    def hides_size(self, closed_loop: bool) -> tuple[str, str] | None:
        """What a size needs and what is there instead; None where it may rest on these rows.

        An OP that answers nothing may be on lines, e.g. a ramp by hand.
        """
        for name, one in (("PV", self.pv), *((("OP", self.op),) if closed_loop else ())):
            if one.straight > MOST_ON_LINES:
                got = f"{100.0 * one.straight:.0f} % of the rows of {name} on straight lines that a historian drew"
                return f"measured values, at most {100.0 * MOST_ON_LINES:.0f} % of the rows on lines", got
            if one.share > MOST_MADE_UP:
                got = f"{100.0 * one.share:.0f} % of the rows of {name} made up by a historian"
                return f"measured values, at most {100.0 * MOST_MADE_UP:.0f} % of the rows made up", got
        return None

    def to_dict(self) -> dict[str, dict[str, float]]:
        """JSON-ready."""
        return {name: dict(vars(found)) for name, found in (("op", self.op), ("pv", self.pv))}

    @classmethod
    def from_dict(cls, data: Mapping[str, Mapping[str, float]]) -> Self:
        """Inverse of :meth:`to_dict`."""
        return cls(*(Compression(float(data[name]["straight"]), float(data[name]["held"])) for name in ("op", "pv")))


def made_up(record: LoopRecord) -> MadeUp:
    """Of PV also what the reader made up; of OP only what is seen: holding it between its moves is right."""
    return MadeUp(_seen(record, "op"), compression(record, "pv"))


def made_up_of(found: Sequence[tuple[MadeUp, int]]) -> MadeUp | None:
    """Of several records, each with its rows; None where there is none.

    Examples
    --------
    >>> lines, held = Compression(0.4, 0.0), Compression(0.0, 0.2)
    >>> made_up_of([(MadeUp(lines, held), 300), (MadeUp(held, held), 100)])
    MadeUp(op=Compression(straight=0.3, held=0.05), pv=Compression(straight=0.0, held=0.2))
    """
    total = sum(rows for _, rows in found)
    if not total:
        return None

    def mean(of: Sequence[tuple[Compression, int]]) -> Compression:
        shares = (
            sum(part * rows for part, rows in each) / total
            for each in ([(one.straight, rows) for one, rows in of], [(one.held, rows) for one, rows in of])
        )
        return Compression(*(round(share, 12) for share in shares))

    return MadeUp(mean([(one.op, rows) for one, rows in found]), mean([(one.pv, rows) for one, rows in found]))


def compression(record: LoopRecord, name: str) -> Compression:
    """Shares of rows of OP or PV that look made up, at least those that the reader made up.

    Parameters
    ----------
    record : LoopRecord
    name : {"op", "pv"}
        Holds count for PV only, except at a value to which it returns: a controller may hold OP, an operator does.
        OP on lines counts only while PV moves: the integral of a constant error is a line by nature.

    Examples
    --------
    >>> random = np.random.default_rng(0)
    >>> pv = np.interp(np.arange(1000), np.arange(0, 1001, 10), random.normal(size=101))
    >>> made_up = compression(LoopRecord(random.normal(size=1000), pv, dt=1.0), "pv")
    >>> round(made_up.straight, 1), made_up.held
    (0.9, 0.0)
    """
    seen = _seen(record, name)
    known = record.made_up[0 if name == "op" else 1]
    if name == "op":  # moves by hand are stored whole, however few they are
        known = min(known, limits.COMPRESSED_REFUSE - 0.01)
    return seen if seen.share >= known else Compression(known - seen.held, seen.held)


def _seen(record: LoopRecord, name: str) -> Compression:
    """Shares that the values themselves show."""
    values: FloatArray = getattr(record, name)
    known = values[~np.isnan(values)]
    if len(known) < limits.STRAIGHT_ROWS or known.min() == known.max():
        return Compression(0.0, 0.0)
    step = quantum(values)
    moves = np.abs(np.diff(known))
    coarse = float(np.median(moves[moves > 0])) < limits.FINE_RESOLUTION * step
    tolerance = max(step, SINGLE * float(np.abs(known).max()))
    sloping, level = _made_up(record, values, tolerance, limits.COARSE_ROWS if coarse else limits.STRAIGHT_ROWS)
    if name == "op":
        moving = np.r_[False, np.diff(record.pv) != 0]
        return Compression(float(np.mean(sloping & moving)), 0.0)
    if coarse and not is_live((np.diff(record.op) == 0) & neighbours(record)):
        return Compression(0.0, 0.0)  # OP in steps: PV settles and rests, within the step in which it is seen
    held = level if coarse else level | np.r_[False, (np.diff(values) == 0) & neighbours(record)]
    return Compression(float(np.mean(sloping)), float(np.mean(held & ~_at_rest(values))))


def _at_rest(values: FloatArray) -> Bools:
    """Rows at the most frequent value, if it is left and found again: a closed valve, a motor that stands."""
    levels, counts = np.unique(values[~np.isnan(values)], return_counts=True)
    there: Bools = values == levels[counts.argmax()]
    lengths = runs(there)[1]
    return there if int(np.sum(lengths > 1)) > 2 else np.zeros_like(there)


def _made_up(record: LoopRecord, values: FloatArray, tolerance: float, points: int) -> tuple[Bools, Bools]:
    """Rows inside sloping and level lines of at least `points` samples that end in a sharp bend; shape (n,) each.

    A smooth curve that was rounded is a chain of short lines too, but these bend by a few steps over their length.
    """
    sloping, level = np.zeros((2, len(values)), dtype=np.bool_)
    at = knots(np.where(_broken(record), np.nan, values) if record.gaps else values, tolerance)
    length = np.diff(at)
    with np.errstate(invalid="ignore"):
        slope = np.diff(values[at]) / length
        turn = np.abs(np.diff(slope)) * np.minimum(length[1:], length[:-1])
        bend = np.fmax(np.r_[turn, np.nan], np.r_[np.nan, turn])
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
    for bends in (moves_at, bends_at):
        found = _regular(bends(record.pv), len(record))
        if found[0] > 1 and _on_phase(record.op, *found):
            return found
    return 1, 0


def _regular(rows: IntArray, count: int) -> tuple[int, int]:
    """Distance and phase of events that nearly all fall on one phase of it; (1, 0) where they do not."""
    if len(rows) < limits.FROZEN_RUN:
        return 1, 0
    factor = int(np.median(np.diff(rows)))
    if not 1 < factor <= MOST_FACTOR or len(rows) * factor < 0.5 * count:
        return 1, 0
    phases = np.bincount(rows % factor, minlength=factor)
    return (factor, int(phases.argmax())) if phases.max() >= limits.ON_PHASE * len(rows) else (1, 0)


def _on_phase(op: FloatArray, factor: int, phase: int) -> bool:
    """Whether OP is repeated or interpolated on the same rows as PV."""
    shares = [float(np.mean(at % factor == phase)) for at in (moves_at(op), bends_at(op)) if len(at)]
    return max(shares, default=1.0) >= limits.ON_PHASE


def moves_at(values: FloatArray) -> IntArray:
    """Rows that differ from the row before."""
    return np.flatnonzero(np.diff(values)) + 1


def bends_at(values: FloatArray) -> IntArray:
    """Rows at which a straight line ends."""
    return np.flatnonzero(np.abs(np.diff(values, 2)) > ROUNDING * float(np.ptp(values))) + 1
