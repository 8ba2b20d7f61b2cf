"""How far OP goes between the rows of a record: its controller acts more often than it is recorded."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.identify.news import longest
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
# of the noise of OP. A controller with an integral leaves less than the first between its rows; one that answers the
# slope of PV up to twice that, as the noise of every scan moves OP in full: in another simulation 0.26 to 0.44, and
# at most 0.24 without it where nothing else moved or rounded OP. More is moved by something that the rows show
MOSTLY, OTHERWISE = 0.3, 0.5
# times the rounding of OP and PV when they were stored: what that leaves of an exact controller, 0.70 to 0.97 in 24
# simulated loops. Less says that PV was rounded before the controller saw it.
ROUNDED = (0.6, 1.3)
NO_BETTER = 1.05  # times what PV of the same row leaves as well: it does not help
# of its answer to SP that PV has given a row after the move: from the first on the loop has settled between the rows,
# if they do not show what moves OP. From the second on sizes of valves that stick are too small: by 12 to 31 % in six
# flows of tests/unit/test_in_row.py with 0.15 to 0.32 of it, by 1 to 10 % in twelve with 0.11 or less
SETTLED, HIDDEN = 0.25, 0.12
ANSWER, FEWEST_MOVES = 10, 5  # rows until PV has answered, and moves of SP that tell it
LEAST_ANSWER = 0.5  # of the move: PV follows SP within these rows
# times these moves: at either end OP turns round further out than the rows show, and when is not known. In another
# simulation 27 of 70 sizes were in the interval before this, 58 of 70 are with it (docs/other-simulation.md)
FURTHER, NEARER = 2.0, 1.0


@dataclass(frozen=True)
class Unseen:
    """What OP does between the rows.

    Attributes
    ----------
    moves : float
        Deviation of OP's noise where part of it lies between the rows, in units of OP; 0 where the rows show all, or
        nothing tells.
    rest : float
        Share of it that the rows of PV and SP do not explain.
    done : float
        Share of its answer to a move of SP that PV has given a row after it, where the rest is large; else 0.
    """

    moves: float = 0.0
    rest: float = 0.0
    done: float = 0.0

    @property
    def mostly(self) -> bool:
        """Whether the valve is moved by what no row shows: then the rows exclude no lost motion."""
        return self.moves > 0.0 and self.rest >= MOSTLY

    @property
    def settled(self) -> bool:
        """Whether the loop has settled before the next row: how far OP went, and came back, is in none."""
        return self.rest >= OTHERWISE

    @property
    def hides_size(self) -> bool:
        """Whether the loop does so much of its answer between the rows that a valve that sticks seems to lose less."""
        return self.done > HIDDEN


def unseen_moves(data: IdentificationData) -> Unseen:
    """What OP does between the rows, from what its controller leaves of it in the rows.

    A controller that acts once a row makes OP an exact function of PV, SP and its own past in the rows. One that acts
    several times leaves a small rest, the integral of a noise of PV that is in no row; then OP turns round between rows
    as well, further out by about its noise, and a valve with a memory has been there.
    """
    rows = _rows(data)
    if rows is None:
        return Unseen()
    own = _own(rows)
    left, rounded = _left(rows, data, 0)
    done = settled_by(data.y, data.sp, data.segments) if left >= MOSTLY * own > 0.0 else 0.0
    if left >= OTHERWISE * own > 0.0 and done > SETTLED:
        return Unseen(own, left / own, done)
    if not EXACT * own < left < OTHERWISE * own:
        return Unseen()
    return Unseen() if ROUNDED[0] * rounded <= left <= ROUNDED[1] * rounded else Unseen(own, left / own, done)


def of_past_rows(data: IdentificationData) -> bool:
    """Whether OP is an exact function of PV of the rows before: then PV of its own row does nothing to it."""
    rows = _rows(data)
    if rows is None:
        return False
    own, (left, rounded) = _own(rows), _left(rows, data, 1)
    if left <= EXACT * own:
        return own > 0.0
    by_rounding = ROUNDED[0] * rounded <= left <= ROUNDED[1] * rounded and left < OTHERWISE * own
    return by_rounding and left <= NO_BETTER * _left(rows, data, 0)[0]


def settled_by(y: FloatArray, sp: FloatArray | None, segments: IntArray) -> float:
    """Share of its answer to a move of SP that PV has given a row after it; 0 where moves of SP do not tell.

    Parameters
    ----------
    y : ndarray, shape (n,)
        PV, segments one after the other.
    sp : ndarray, shape (n,), or None
    segments : ndarray, shape (s, 2)
        First row and the row behind the last.
    """
    if sp is None:
        return 0.0
    rows, moves = [], []
    for start, stop in longest(segments):
        now = np.arange(start + ANSWER + 1, stop)
        rows.append(sp[now[:, None] - np.arange(ANSWER + 1)] - sp[now[:, None] - np.arange(1, ANSWER + 2)])
        moves.append(y[now] - y[now - 1])
    columns, moved = np.concatenate(rows), np.concatenate(moves)
    if np.count_nonzero(columns[:, 0]) < FEWEST_MOVES or len(columns) < 10 * ANSWER:
        return 0.0
    answer = np.linalg.lstsq(columns, moved, rcond=None)[0].cumsum()
    return float(answer[1] / answer[-1]) if answer[-1] > LEAST_ANSWER else 0.0


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


def _own(rows: _Rows) -> float:
    """Deviation of what the past of OP leaves of it."""
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
        taken = rows & (errors <= ORDINARY * left + 1e-12)
    return left, (weights / np.where(scale > 0.0, scale, 1.0))[:-1]
