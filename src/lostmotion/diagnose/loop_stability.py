"""Is the loop near its limit of stability? PI from the record, process from the fit, roots of both together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify import HammersteinFit
from lostmotion.identify.data import IdentificationData
from lostmotion.models import LinearModel

MOST_ROUNDED = 0.5  # of the moves of OP: what rounding of OP and PV may stand for, at most
EXACT = 0.05  # share of the moves of OP that a PI does not explain, up to which it is one
NEAR = 1.6  # times: a root and an oscillation this close in frequency are the same
LIGHTLY_DAMPED = 0.12  # damping ratio below which a loop keeps swinging from every push


@dataclass(frozen=True)
class LoopStability:
    """A root of the closed loop: the one near the oscillation, or the least damped.

    Attributes
    ----------
    kp, ki : float
        PI that explains OP: units of OP per unit of PV, and per sample.
    unexplained : float
        Share of the moves of OP that this PI does not explain.
    damping : float
        Damping ratio of the least damped oscillating root, below 0 where unstable; 1 where none oscillates.
    period : float
        Of that root in samples; inf where none oscillates.
    """

    kp: float
    ki: float
    unexplained: float
    damping: float
    period: float

    def explains(self, period: float) -> bool:
        """Whether an oscillation of this period is the loop's own."""
        near = 1.0 / NEAR < self.period / period < NEAR
        return self.unexplained < EXACT and self.damping < LIGHTLY_DAMPED and near


def loop_stability(fit: HammersteinFit, sp: FloatArray | None, period: float = np.nan) -> LoopStability:
    """PI by least squares on the moves of OP, then the roots of the loop with the linear part of the fit.

    Parameters
    ----------
    fit : HammersteinFit
        Its linear part with the slope of the actuator counts as the process.
    sp : ndarray or None
        Set point on the rows of the data; None: constant.
    period : float
        In samples, of an oscillation whose root is sought; NaN: the least damped root.
    """
    found = estimate_pi(fit.data, sp)
    damping, own = _root_near(fit.linear, found.kp, found.ki, period)
    return LoopStability(found.kp, found.ki, found.unexplained, damping, own)


@dataclass(frozen=True)
class EstimatedPI:
    """PI that explains the moves of OP best.

    Attributes
    ----------
    kp, ki : float
        Units of OP per unit of PV, and per sample.
    unexplained : float
        Share of the moves of OP that it does not explain.
    """

    kp: float
    ki: float
    unexplained: float


def estimate_pi(data: IdentificationData, sp: FloatArray | None) -> EstimatedPI:
    """PI by least squares on the moves of OP.

    Parameters
    ----------
    data : IdentificationData
    sp : ndarray or None
        Set point on its rows; None: constant.
    """
    moves, columns = [], []
    for start, stop in data.segments.tolist():
        error = -data.y[start:stop] if sp is None else sp[start:stop] - data.y[start:stop]
        moves.append(np.diff(data.u[start:stop]))
        columns.append(np.column_stack([np.diff(error), error[1:]]))
    du, rows = np.concatenate(moves), np.concatenate(columns)
    rows = np.column_stack([rows, np.ones(du.size)])
    scale = np.maximum(np.abs(rows).max(axis=0), 1e-300)
    gains = np.linalg.lstsq(rows / scale, du, rcond=1e-10)[0] / scale
    left, all_of_it = du - rows @ gains, max(float(du @ du), 1e-300)
    rounding = du.size / 6.0 * (data.u_step**2 + (float(gains[0]) * data.y_step) ** 2)
    rounding = min(rounding, MOST_ROUNDED * all_of_it)
    unexplained = max(float(left @ left) - rounding, 0.0) / all_of_it
    return EstimatedPI(float(gains[0]), float(gains[1]), unexplained)


def _root_near(linear: LinearModel, kp: float, ki: float, period: float) -> tuple[float, float]:
    """Damping ratio and period of a pair of roots of 1 + B q^-d (kp + ki - kp q^-1) / (A (1 - q^-1)) = 0.

    The one whose period is nearest to the given one, or the least damped: a slow root of the process must not hide
    the one that swings.
    """
    around = np.convolve(np.r_[np.zeros(linear.delay), linear.b], [kp + ki, -kp])
    along = np.convolve(np.r_[1.0, linear.a], [1.0, -1.0])
    size = max(around.size, along.size)
    roots = np.roots(np.pad(around, (0, size - around.size)) + np.pad(along, (0, size - along.size)))
    swinging = roots[(roots.imag > 1e-9) & (np.abs(roots) > 1e-6)]
    if not swinging.size:
        return 1.0, float(np.inf)
    logs = np.log(swinging)
    ratios = -logs.real / np.abs(logs)
    distance = ratios if np.isnan(period) else np.abs(np.log(2.0 * np.pi / np.maximum(logs.imag, 1e-12) / period))
    worst = int(np.argmin(distance))
    return float(ratios[worst]), float(2.0 * np.pi / logs[worst].imag)
