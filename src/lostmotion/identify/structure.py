"""Which orders and delays are tried, and which poles a sampled process can have."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy import stats

from lostmotion.identify.pole_grid import GridStart
from lostmotion.models._arguments import FloatArray

LADDER = ((1, 0), (1, 1), (2, 0), (2, 1), (2, 2), (3, 1), (3, 2))
LEAST_DAMPING = 0.1  # of a complex pair; valves and processes have 0.3 and more
SLOWEST_RINGING = 0.5  # largest negative real pole; a sampled continuous process has none
FEEDBACK_LAGS = 10
FEEDBACK_LEVEL = 1e-4  # of the test whether OP answers PV


def plausible(a: FloatArray) -> bool:
    """Whether a sampled process can have these poles: no ringing at half the sampling rate, some damping.

    Where a record says little, the likelihood likes poles on the unit circle that copy the loop's oscillation.
    """
    poles = np.roots(np.concatenate([[1.0], a]))
    log_poles = np.log(poles[np.abs(poles) > 1e-12].astype(complex))
    damping = -log_poles.real / np.maximum(np.abs(log_poles), 1e-12)
    real = np.abs(log_poles.imag) < 1e-9
    ringing = (log_poles.imag > np.pi - 1e-9) & (log_poles.real > np.log(SLOWEST_RINGING))
    return not bool(np.any(ringing | (~real & (damping < LEAST_DAMPING))))


def distinct(starts: list[GridStart], most: int) -> list[GridStart]:
    """The best starts that differ in na, best first."""
    best: dict[int, GridStart] = {}
    for start in starts:
        best.setdefault(start.na, start)
    return list(best.values())[:most]


def first_delay(u: FloatArray, y: FloatArray, segments: npt.NDArray[np.int64]) -> int:
    """Shortest delay that can be told: 0 in open loop, 1 where OP answers PV.

    In a closed loop PV and OP of one sample are tied by the controller, and a delay of 0 would model that instead.
    The test is Granger's: do past PV help to foretell OP beyond its own past?
    """
    rows, targets = [], []
    for start, stop in segments:
        if stop - start < 4 * FEEDBACK_LAGS:
            continue
        ks = np.arange(start + FEEDBACK_LAGS, stop)
        past = ks[:, None] - np.arange(1, FEEDBACK_LAGS + 1)
        rows.append(np.column_stack([np.ones(ks.size), u[past], y[past], y[ks]]))
        targets.append(u[ks])
    if not rows:
        return 1
    regressors, target = np.concatenate(rows), np.concatenate(targets)
    own = regressors[:, : FEEDBACK_LAGS + 1]
    free = target.size - regressors.shape[1]
    if free < FEEDBACK_LAGS:
        return 1

    def left_over(columns: FloatArray) -> float:
        solution = np.linalg.lstsq(columns, target, rcond=1e-10)[0]
        return float(np.sum((target - columns @ solution) ** 2))

    alone, both = left_over(own), left_over(regressors)
    added = regressors.shape[1] - own.shape[1]
    ratio = (alone - both) / added / max(both / free, 1e-300)
    return 1 if stats.f.sf(ratio, added, free) < FEEDBACK_LEVEL else 0
