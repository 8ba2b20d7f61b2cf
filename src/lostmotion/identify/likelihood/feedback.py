"""Does OP answer PV, and does anything else move it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.distributions import f_tail
from lostmotion.identify.scaled import Signals

LAGS = 10  # past rows of OP and PV: a PI controller needs two, a filter in front of it a few more
LEVEL = 1e-4  # of the test whether OP answers PV
RESTS, LEAST_MOVE = 0.5, 0.02  # share of moves of PV at which OP rests, and of the range of OP that a move takes then
SURE = 8.0  # standard errors of a gain of the controller, from which on its sign is known
LARGEST_CONDITION = 1e12  # above it the moves of PV and PV itself are one column to double precision
NEARLY_EXACT = 1e-3  # share of the moves of OP that PV does not explain, below which OP is a function of PV


@dataclass(frozen=True)
class Feedback:
    """How OP depends on PV.

    Attributes
    ----------
    closed : bool
        Past PV help to foretell OP beyond its own past (Granger's test), so a controller is at work; OP is not set
        by hand, that is at rest mostly while PV moves, and moved far where it moves.
    free : float
        Share of the variance of the moves of OP that past OP and PV up to now do not explain: set-point moves,
        operators, noise of the controller. At 0 a linear process cannot be told from the controller's inverse.
    direction : int
        Sign of the answer of OP to PV, that of a proportional and an integral part both; 0 where it is not sure.
    """

    closed: bool
    free: float
    direction: int = 0

    @property
    def exact(self) -> bool:
        """Whether OP is nearly a function of PV alone."""
        return self.closed and self.free < NEARLY_EXACT


def feedback(signals: Signals) -> Feedback:
    """Test for feedback from PV to OP with linear regressions of OP on ten past samples of both."""
    u, y, segments = signals.u, signals.y, signals.segments
    rows, targets, moves = [], [], []
    for start, stop in segments:
        if stop - start < 4 * LAGS:
            continue
        ks = np.arange(start + LAGS, stop)
        past = ks[:, None] - np.arange(1, LAGS + 1)
        rows.append(np.column_stack([np.ones(ks.size), u[past], y[past], y[ks]]))
        targets.append(u[ks])
        moves.append(u[ks] - u[ks - 1])
    if not rows:
        return Feedback(True, 1.0)
    regressors, target = np.concatenate(rows), np.concatenate(targets)
    columns = regressors.shape[1]
    free = target.size - columns
    if free < LAGS:
        return Feedback(True, 1.0)
    alone = _left_over(regressors[:, : LAGS + 1], target)
    both = _left_over(regressors, target)
    ratio = (alone - both) / (LAGS + 1) / max(both / free, 1e-300)
    closed = bool(f_tail(ratio, LAGS + 1, free) < LEVEL) and not _by_hand(signals)
    variance = float(np.sum(np.concatenate(moves) ** 2))
    direction = _direction(signals) if closed else 0
    return Feedback(closed, min(both / variance, 1.0) if variance > 0 else 1.0, direction)


def _direction(signals: Signals) -> int:
    """Sign of kp and ki in du = kp dy + ki y + constant, where both are sure and agree, or one is sure."""
    u, y, segments = signals.u, signals.y, signals.segments
    du = np.concatenate([np.diff(u[start:stop]) for start, stop in segments])
    dy = np.concatenate([np.diff(y[start:stop]) for start, stop in segments])
    now = np.concatenate([y[start + 1 : stop] for start, stop in segments])
    columns = np.column_stack([dy, now, np.ones(du.size)])
    gram = columns.T @ columns
    if np.linalg.cond(gram) > LARGEST_CONDITION:
        return 0
    gains = np.linalg.solve(gram, columns.T @ du)
    left = du - columns @ gains
    errors = np.sqrt(float(left @ left) / max(du.size - 3, 1) * np.diag(np.linalg.inv(gram)))
    sure = np.sign(gains[:2]) * (np.abs(gains[:2]) > SURE * errors[:2])
    return int(np.sign(sure.sum())) if abs(sure.sum()) == np.abs(sure).sum() else 0


def _by_hand(signals: Signals) -> bool:
    """Whether OP goes by steps that no controller takes; where OP rests at its ends it may be at a limit."""
    u, y, segments = signals.u, signals.y, signals.segments
    inner = (u > u.min()) & (u < u.max())
    moves = [(np.diff(u[a:b])[inner[a : b - 1]], np.diff(y[a:b])[inner[a : b - 1]]) for a, b in segments]
    of_op, of_pv = (np.concatenate(parts) for parts in zip(*moves, strict=True))
    answered, moved = of_op[of_pv != 0.0], np.abs(of_op[of_op != 0.0])
    if not answered.size or not moved.size:
        return False
    rests = float(np.mean(answered == 0.0)) > RESTS
    return rests and float(np.median(moved)) > LEAST_MOVE * float(np.ptp(u))


def _left_over(columns: FloatArray, target: FloatArray) -> float:
    solution = np.linalg.lstsq(columns, target, rcond=1e-12)[0]
    return float(np.sum((target - columns @ solution) ** 2))
