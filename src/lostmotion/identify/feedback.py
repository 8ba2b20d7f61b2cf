"""Does OP answer PV, and does anything else move it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import stats

from lostmotion.models._arguments import FloatArray

LAGS = 10
LEVEL = 1e-4  # of the test whether OP answers PV
NEARLY_EXACT = 1e-3  # share of the moves of OP that PV does not explain, below which OP is a function of PV


@dataclass(frozen=True)
class Feedback:
    """How OP depends on PV.

    Attributes
    ----------
    closed : bool
        Past PV help to foretell OP beyond its own past (Granger's test), so a controller is at work.
    free : float
        Share of the variance of the moves of OP that past OP and PV up to now do not explain: set-point moves,
        operators, noise of the controller. At 0 a linear process cannot be told from the controller's inverse.
    """

    closed: bool
    free: float

    @property
    def exact(self) -> bool:
        """Whether OP is nearly a function of PV alone."""
        return self.closed and self.free < NEARLY_EXACT


def feedback(u: FloatArray, y: FloatArray, segments: npt.NDArray[np.int64]) -> Feedback:
    """Test for feedback from PV to OP with linear regressions of OP on ten past samples of both."""
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
    closed = bool(stats.f.sf(ratio, LAGS + 1, free) < LEVEL)
    variance = float(np.sum(np.concatenate(moves) ** 2))
    return Feedback(closed, min(both / variance, 1.0) if variance > 0 else 1.0)


def _left_over(columns: FloatArray, target: FloatArray) -> float:
    solution = np.linalg.lstsq(columns, target, rcond=1e-12)[0]
    return float(np.sum((target - columns @ solution) ** 2))
