"""What a historian makes of a loop: rounding, compression, gaps, means, units.

The functions change a recording in place; what they draw comes from the ingredient's own random numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import lostmotion as lm
from one_ingredient.draw import Case, Rng
from one_ingredient.valves import Array

LONGEST_GAP = 60  # rows: a value is stored at least as often
PERCENT = (0.0, 100.0)


@dataclass
class Recording:
    """A value for each row; OP and PV in units of their spans."""

    op: Array
    pv: Array
    sp: Array | None
    mean_op: Array  # over each row
    mean_pv: Array
    manual: Array
    mode: Array | None = None
    op_span: tuple[float, float] | None = PERCENT
    pv_span: tuple[float, float] | None = PERCENT
    percent: float = 1.0  # units of OP

    def record(self, seconds: float) -> lm.LoopRecord:
        """For the package; `seconds` in a row."""
        return lm.LoopRecord(
            self.op, self.pv, self.sp, dt=seconds, op_span=self.op_span, pv_span=self.pv_span, mode=self.mode
        )


def as_it_is(_recording: Recording, _case: Case, _rng: Rng) -> None:
    """Nothing happens to it."""


def op_to_a_tenth(recording: Recording, _case: Case, _rng: Rng) -> None:
    """OP to 0.1 %."""
    recording.op = np.round(recording.op, 1)


def op_to_one(recording: Recording, _case: Case, _rng: Rng) -> None:
    """OP to 1 %."""
    recording.op = np.round(recording.op)


def pv_rounded(recording: Recording, _case: Case, rng: Rng) -> None:
    """PV to 0.1, 0.25 or 0.5 %."""
    step = rng.choice([0.1, 0.25, 0.5])
    recording.pv = np.round(recording.pv / step) * step


def pv_held(recording: Recording, case: Case, _rng: Rng) -> None:
    """PV stored by exception, the last value repeated."""
    kept = by_exception(recording.pv, case.noise * 1.5 + 0.1)
    recording.pv = recording.pv[kept][np.searchsorted(kept, np.arange(case.rows), side="right") - 1]


def pv_interpolated(recording: Recording, case: Case, _rng: Rng) -> None:
    """PV stored by exception, straight lines between what is stored."""
    kept = by_exception(recording.pv, case.noise * 1.5 + 0.1)
    recording.pv = np.interp(np.arange(case.rows), kept, recording.pv[kept])


def by_exception(values: Array, deviation: float) -> Array:
    """Rows that are stored: those further than the deviation from what was stored last."""
    kept = [0]
    for row in range(1, len(values)):
        if abs(values[row] - values[kept[-1]]) > deviation or row - kept[-1] > LONGEST_GAP:
            kept.append(row)
    return np.array(kept)


def gaps(recording: Recording, case: Case, rng: Rng) -> None:
    """NaN in OP, in PV or in both for up to 11 rows, now and then."""
    row = 0
    while row < case.rows:
        row += int(rng.exponential(150))
        end, which = row + int(rng.integers(1, 12)), rng.integers(3)
        if which != 1:
            recording.pv[row:end] = np.nan
        if which != 0:
            recording.op[row:end] = np.nan
        row = end


def spikes(recording: Recording, case: Case, rng: Rng) -> None:
    """One row of PV in 300 is 5 to 30 % off."""
    rows = rng.choice(case.rows, max(3, case.rows // 300), replace=False)
    recording.pv[rows] += rng.choice([-1, 1], len(rows)) * rng.uniform(5, 30, len(rows))


def means(recording: Recording, _case: Case, _rng: Rng) -> None:
    """Each row is a mean over it."""
    recording.op, recording.pv = recording.mean_op, recording.mean_pv


def pv_a_row_late(recording: Recording, _case: Case, _rng: Rng) -> None:
    """PV of the row before."""
    recording.pv = np.concatenate([recording.pv[:1], recording.pv[:-1]])


def with_modes(recording: Recording, _case: Case, _rng: Rng) -> None:
    """The mode is recorded."""
    recording.mode = np.where(recording.manual, "MAN", "AUTO")


def shares(recording: Recording, _case: Case, _rng: Rng) -> None:
    """OP from 0 to 1, PV from 0 to 2."""
    recording.op, recording.op_span, recording.percent = recording.op / 100, (0.0, 1.0), 0.01
    _pv_to_two(recording)


def milliamperes(recording: Recording, _case: Case, _rng: Rng) -> None:
    """OP from 4 to 20 mA, PV from 0 to 2."""
    recording.op, recording.op_span, recording.percent = 4 + recording.op * 0.16, (4.0, 20.0), 0.16
    _pv_to_two(recording)


def _pv_to_two(recording: Recording) -> None:
    assert recording.sp is not None
    recording.pv, recording.sp, recording.pv_span = recording.pv * 0.02, recording.sp * 0.02, (0.0, 2.0)


def without_spans_and_sp(recording: Recording, _case: Case, _rng: Rng) -> None:
    """OP and PV alone."""
    recording.op_span = recording.pv_span = recording.sp = None
