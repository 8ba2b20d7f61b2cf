"""The controller in the rows of a record: what past OP, and PV and SP, leave of OP."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.identify.likelihood.remembered import remembered
from lostmotion.records.sampling import Bools

if TYPE_CHECKING:
    from lostmotion.identify.data import IdentificationData

# rows of a PID with a filter in front of it: past ones of OP, and of PV and SP with the present one
OF_OP, OF_PV = 3, 4
OWN = 7  # past rows of OP that foretell what is smooth of it
MOST_ROWS = 4000  # that are looked at
TURNS = 5  # of the regression, without the rows of steps and limits
ORDINARY = 3.0  # standard errors: rows further off are something else
DEVIATION = 1.4826  # of Gaussian errors over their median
EXACT = 1e-6  # of the noise of OP: what the controller leaves where every act of it is a row
# of the noise of OP: more is moved by something that no row shows
OTHERWISE = 0.5
# times the rounding of OP and PV when they were stored: what that leaves of an exact controller, 0.70 to 0.97 in 24
# simulated loops. Less says that PV was rounded before the controller saw it.
ROUNDED = (0.6, 1.3)
NO_BETTER = 1.05  # times what PV of the same row leaves as well: it does not help


@dataclass(frozen=True)
class ControllerRows:
    """What the rows of a controller leave of its output.

    Attributes
    ----------
    own : float
        Deviation of what the past of OP leaves of it, in units of OP.
    left : float
        Deviation of what past OP, PV and SP leave of it.
    rounding : float
        Deviation that the stored steps of OP and PV would leave of an exact controller.
    """

    own: float
    left: float
    rounding: float

    @property
    def exact(self) -> bool:
        """Whether nothing is left: every act of the controller is a row."""
        return self.left <= EXACT * self.own

    @property
    def rounded(self) -> bool:
        """Whether no more is left than rounding makes of an exact controller."""
        least, most = (times * self.rounding for times in ROUNDED)
        return least <= self.left <= most and self.left < OTHERWISE * self.own


@remembered
def controller_rows(data: IdentificationData, first: int = 0) -> ControllerRows | None:
    """What the controller leaves of OP beside PV from `first` rows ago on; None where there are too few rows."""
    rows = _rows(data)
    return None if rows is None else ControllerRows(_own(data), *_left(rows, data, first))


def of_past_rows(data: IdentificationData) -> bool:
    """Whether OP is an exact function of PV of the rows before: then PV of its own row does nothing to it."""
    found = controller_rows(data, 1)
    if found is None:
        return False
    if found.exact:
        return found.own > 0.0
    same = controller_rows(data)
    return found.rounded and same is not None and found.left <= NO_BETTER * same.left


_Rows = tuple[FloatArray, FloatArray, FloatArray | None, IntArray, Bools]


def _rows(data: IdentificationData) -> _Rows | None:
    """Signals about their means, the rows with a past in the longest segments, which of these are inside OP's range.

    None where there are too few.
    """
    begun, left = max(OWN, OF_PV), MOST_ROWS
    places: list[IntArray] = []
    for start, stop in sorted(data.segments.tolist(), key=lambda ends: ends[0] - ends[1]):
        taken = min(stop - start - begun, left)
        if taken > 0:
            places.append(np.arange(start + begun, start + begun + taken))
            left -= taken
    now = np.concatenate(places) if places else np.empty(0, dtype=np.int64)
    moves = (data.u > data.u.min()) & (data.u < data.u.max())
    inside = np.logical_and.reduce([moves[now - lag] for lag in range(OF_OP)])
    if np.count_nonzero(inside) < 10 * (OWN + OF_PV):
        return None
    sp = None if data.sp is None else data.sp - data.sp.mean()
    return data.u - data.u_centre, data.y - data.y_centre, sp, now, inside


@remembered
def _own(data: IdentificationData) -> float:
    """Deviation of what the past of OP leaves of it; there are rows enough."""
    rows = _rows(data)
    assert rows is not None  # noqa: S101  as its caller has seen
    op, _, _, now, inside = rows
    return _regressed(_lags([op], now, 1, OWN), op[now], inside)[0]


def _left(rows: _Rows, data: IdentificationData, first: int) -> tuple[float, float]:
    """Deviation of what past OP, and PV from a lag on, leave of OP; and what their rounding would leave of it."""
    op, pv, sp, now, inside = rows
    if sp is None:  # a step of it that is not known is in two rows of these differences
        op, pv = np.diff(op, 2, prepend=op[[0, 0]]), np.diff(pv, prepend=pv[0])
    moved_by = [_lags([pv], now, first, OF_PV - 1 + first)]
    if sp is not None and np.ptp(sp) > 0.0:
        moved_by.append(_lags([sp], now, 0, OF_PV - 1))
    left, gains = _regressed(np.hstack([_lags([op], now, 1, OF_OP), *moved_by]), op[now], inside)
    of_op, of_pv = gains[:OF_OP], gains[OF_OP : OF_OP + OF_PV]
    stored = np.hypot(data.u_step * np.hypot(1.0, np.linalg.norm(of_op)), data.y_step * np.linalg.norm(of_pv))
    return left, float(stored) / np.sqrt(12.0)


def _lags(signals: list[FloatArray], now: IntArray, first: int, last: int) -> FloatArray:
    """Past rows of signals, one column for each lag from `first` to `last`."""
    return np.column_stack([signal[now - lag] for signal in signals for lag in range(first, last + 1)])


def _regressed(columns: FloatArray, target: FloatArray, rows: Bools) -> tuple[float, FloatArray]:
    """Deviation of what the columns and a constant leave of ordinary rows, and the weights of the columns."""
    every = np.column_stack([columns, np.ones(len(columns))])
    scale = np.sqrt(np.mean(every**2, axis=0))
    every = every / np.where(scale > 0.0, scale, 1.0)
    taken, left = rows, np.inf
    weights: FloatArray = np.zeros(every.shape[1])
    for _ in range(TURNS):
        weights = np.asarray(np.linalg.lstsq(every[taken], target[taken], rcond=None)[0], dtype=np.float64)
        errors = np.abs(target - every @ weights)
        left = DEVIATION * float(np.median(errors[rows]))
        before, taken = taken, rows & (errors <= ORDINARY * left + 1e-12)
        if np.array_equal(taken, before):
            break
    return left, (weights / np.where(scale > 0.0, scale, 1.0))[:-1]
