"""How far OP goes between the rows of a record: its controller acts more often than it is recorded."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.identify.data import IdentificationData
from lostmotion.records.sampling import Bools

# rows of a PID with a filter in front of it: past ones of OP, and of PV and SP with the present one
OF_OP, OF_PV = 3, 4
OWN = 7  # past rows of OP that foretell what is smooth of it
MOST_ROWS = 4000  # that are looked at
TURNS = 5  # of the regression, without the rows of steps and limits
ORDINARY = 3.0  # standard errors: rows further off are something else
DEVIATION = 1.4826  # of Gaussian errors over their median
EXACT = 1e-6  # of the noise of OP: what the controller leaves where every act of it is a row
OTHERWISE = 0.3  # of the noise of OP, from which on something else moves it, that the rows show
# times the rounding of OP and PV when they were stored: what that leaves of an exact controller, 0.70 to 0.97 in 24
# simulated loops. Less says that PV was rounded before the controller saw it.
ROUNDED = (0.6, 1.3)
# times these moves: at either end OP turns round further out than the rows show, and when is not known. In another
# simulation 27 of 70 sizes were in the interval before this, 58 of 70 are with it (docs/other-simulation.md)
FURTHER, NEARER = 2.0, 1.0


def unseen_moves(data: IdentificationData) -> float:
    """Deviation of OP's noise where part of it lies between the rows; 0 where the rows show all, or nothing tells.

    A controller that acts once a row makes OP an exact function of PV, SP and its own past in the rows. One that acts
    several times leaves a small rest, the integral of a noise of PV that is in no row; then OP turns round between rows
    as well, further out by about its noise, and a valve with a memory has been there.

    Returns
    -------
    float
        In units of OP.
    """
    rows = _rows(data)
    if rows is None:
        return 0.0
    op, pv, sp, now, inside = rows
    own = _regressed(_lags([op], now, 1, OWN), op[now], inside)[0]
    if sp is None:  # a step of it that is not known is in two rows of these differences
        op, pv = np.diff(op, 2, prepend=op[[0, 0]]), np.diff(pv, prepend=pv[0])
    moved_by = [pv] if sp is None or np.ptp(sp) == 0.0 else [pv, sp]
    columns = np.hstack([_lags([op], now, 1, OF_OP), _lags(moved_by, now, 0, OF_PV - 1)])
    left, gains = _regressed(columns, op[now], inside)
    if not EXACT * own < left < OTHERWISE * own:
        return 0.0
    of_op, of_pv = gains[:OF_OP], gains[OF_OP : OF_OP + OF_PV]
    stored = np.hypot(data.u_step * np.hypot(1.0, np.linalg.norm(of_op)), data.y_step * np.linalg.norm(of_pv))
    rounded = float(stored) / np.sqrt(12.0)
    return 0.0 if ROUNDED[0] * rounded <= left <= ROUNDED[1] * rounded else own


def beyond_unseen(size: float, moves: float) -> float:
    """Upper end of the size of a valve with a memory, where OP moves so between the rows."""
    return size + FURTHER * moves


def within_unseen(size: float, moves: float) -> float:
    """Lower end of the same."""
    return max(size - NEARER * moves, 0.0) if moves > 0.0 else size


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
        taken = rows & (errors <= ORDINARY * left + 1e-12)
    return left, (weights / np.where(scale > 0.0, scale, 1.0))[:-1]
