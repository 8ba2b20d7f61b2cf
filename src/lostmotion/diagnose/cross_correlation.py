"""Odd or even? The cross-correlation of OP and PV tells a sticking valve from a disturbance or tight tuning."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.fft

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.filters import checked_period, standard_signal, without_trend
from lostmotion.errors import DataError


@dataclass(frozen=True)
class CrossCorrelation:
    """Where the cross-correlation of OP and PV stands between even (both 0) and odd (both 1).

    Parameters
    ----------
    delta_rho : float
        (largest between the zero crossings - at lag 0) over their sum; published limits: below 0.072 no stiction,
        above 1/3 stiction.
    delta_tau : float
        Difference over sum of the lags of the zero crossings on both sides of lag 0; published limits: below 1/3 no
        stiction, above 2/3 stiction.
    at_zero : float
        Correlation at lag 0, -1 to 1.
    largest : float
        Largest correlation up to half a period from lag 0, as an absolute value.
    """

    delta_rho: float
    delta_tau: float
    at_zero: float
    largest: float


def cross_correlation_index(op: FloatArray, pv: FloatArray, period: float) -> CrossCorrelation:
    """Measure how odd the cross-correlation of OP and PV is around lag 0.

    Parameters
    ----------
    op, pv : ndarray, shape (n,)
        Finite, uniformly sampled, of a loop that oscillates; the process self-regulating, the controller with
        integral action.
    period : float
        Period of the oscillation in samples, at least 4.

    Raises
    ------
    DataError
        Fewer than two periods, a constant signal, or no zero crossing within a period of lag 0.

    Notes
    -----
    Horch (1999), "A simple method for detection of stiction in control valves", Control Eng. Practice 7:1221, and
    his thesis (2000) for the two measures and their limits: phases of 30 and 60 degrees between the odd and the even
    case. Not meant for integrating processes. Deviation: what is slower than a period is taken out of both signals.

    Examples
    --------
    >>> t = 2 * np.pi * np.arange(1000) / 50
    >>> odd, even = (cross_correlation_index(np.sin(t), y, 50) for y in (np.cos(t), -np.sin(t)))
    >>> round(odd.delta_tau), round(odd.delta_rho), round(even.delta_tau), round(even.delta_rho)
    (1, 1, 0, 0)
    """
    u, y = standard_signal("op", op, 16), standard_signal("pv", pv, 16)
    if u.size != y.size:
        raise DataError.expected(f"pv with {u.size} samples", y.size, "cut both signals to the same length")
    period = checked_period(period, u.size)
    reach = int(np.ceil(period))
    r = _correlation(without_trend(u, period), without_trend(y, period), reach)
    at_zero = float(r[reach])
    r = r * (-1.0 if at_zero < 0.0 else 1.0)
    right, left = _first_crossing(r[reach:]), _first_crossing(r[reach::-1])
    if right is None or left is None:
        remedy = "choose the period at which OP and PV both oscillate"
        raise DataError.expected("a cross-correlation that changes sign within a period", "none", remedy)
    lobe = r[reach - int(left) : reach + int(right) + 1]
    top = max(_summit(lobe), r[reach])
    near = np.abs(r[reach - reach // 2 : reach + reach // 2 + 1])
    total = max(top + r[reach], 1e-300)
    tau = abs(left - right) / max(left + right, 1e-300)
    return CrossCorrelation(float((top - r[reach]) / total), float(tau), at_zero, float(near.max()))


def _correlation(u: FloatArray, y: FloatArray, reach: int) -> FloatArray:
    """Correlation of u(k) with y(k + lag) for lags -reach to reach."""
    size = scipy.fft.next_fast_len(2 * u.size, real=True)
    products = scipy.fft.irfft(scipy.fft.rfft(u, size).conj() * scipy.fft.rfft(y, size), size)
    both = np.concatenate([products[size - reach :], products[: reach + 1]])
    return np.asarray(both / max(np.sqrt((u @ u) * (y @ y)), 1e-300))


def _first_crossing(r: FloatArray) -> float | None:
    """Lag at which r, positive at lag 0, first goes below zero; between the samples by a straight line."""
    below = np.flatnonzero(r < 0.0)
    if not below.size:
        return None
    k = int(below[0])
    return float(k - r[k] / (r[k] - r[k - 1]))


def _summit(r: FloatArray) -> float:
    """Largest value of r, through a parabola over it and its neighbours."""
    k = int(np.argmax(r))
    if not 0 < k < r.size - 1:
        return float(r[k])
    before, at, after = r[k - 1 : k + 2].tolist()
    bend = before - 2.0 * at + after
    return float(at - (after - before) ** 2 / (8.0 * bend)) if bend < 0.0 else float(at)
