"""How near is a loop to minimum variance? The Harris index from routine records."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import finite_signal, whole
from lostmotion.arrays import FloatArray
from lostmotion.errors import DataError, ParameterError
from lostmotion.kernels.triangular import triangular

ORDER = 15  # of the autoregression
ROWS_PER_PARAMETER = 4  # so that by chance it explains no more than a quarter of white noise


@dataclass(frozen=True)
class HarrisIndex:
    """Minimum variance over actual variance of the control error: 1 is best, 0 worst.

    Parameters
    ----------
    low, high : float
        Smallest and largest index over the delays; the same number where one delay was given.
    shortest, longest : int
        These delays, in samples.
    minimum_variance : tuple of float
        What the best controller would leave for the shortest and for the longest delay, in units of PV squared.
    variance : float
        What is there, about the mean error, in units of PV squared.
    """

    low: float
    high: float
    shortest: int
    longest: int
    minimum_variance: tuple[float, float]
    variance: float


def harris_index(
    pv: npt.ArrayLike, sp: npt.ArrayLike | float, delay: int | tuple[int, int], order: int = ORDER
) -> HarrisIndex:
    """Compare the variance of the control error with the smallest that any feedback could reach.

    Parameters
    ----------
    pv : array_like, shape (n,)
        Measurement of a loop in automatic.
    sp : array_like, shape (n,), or float
        Set point.
    delay : int or (int, int)
        Samples after which PV first answers OP, at least 1 (the OP computed from PV(k) acts on PV(k + delay)); or
        the shortest and longest that it may be.
    order : int
        Order of the autoregression, at least 1.

    Raises
    ------
    ParameterError
        A delay or order below 1, a range the wrong way round.
    DataError
        Too short (4 rows for each of its parameters beyond the delay), or an error that does not move.

    Notes
    -----
    Harris (1989), "Assessment of control loop performance", Can. J. Chem. Eng. 67:856; by linear regression after
    Desborough and Harris (1992), "Performance assessment measures for univariate feedback control", same journal
    70:1186. What the errors of `delay` samples ago and before cannot predict, no controller takes away: its variance
    is the minimum variance. Convention: eta = minimum variance / variance, 1 at minimum variance; Desborough and
    Harris print 1 - eta. Both variances are about the mean error, so a lasting offset does not count. The index
    looks at disturbances only: it says nothing of the price in OP, and many good loops, slow ones above all, have a
    low one.

    Examples
    --------
    >>> white = np.random.default_rng(0).normal(size=5000)
    >>> round(harris_index(white, 0.0, 1).low, 1)
    1.0
    """
    y = finite_signal("pv", pv)
    error = y - (finite_signal("sp", sp, y.size) if np.ndim(sp) else float(np.asarray(sp)))
    order = whole("order", order, 1)
    shortest, longest = _delays(delay)
    need = longest + order + ROWS_PER_PARAMETER * (order + 1)
    if y.size < need:
        raise DataError.expected(f"{need} samples for delay {longest} and order {order}", y.size, "give more samples")
    error = error - error.mean()
    unit = float(np.abs(error).max())
    if not np.isfinite(unit) or unit <= 1e-12 * max(float(np.abs(y).max()), 1e-300):
        raise DataError.expected("a control error that moves", "a constant", "choose a stretch with the loop at work")
    error = error / unit
    variance = float(np.mean(error**2))
    least = [min(value, variance) for value in _unpredicted(error, shortest, longest, order)]
    return HarrisIndex(
        min(least) / variance,
        max(least) / variance,
        shortest,
        longest,
        (least[0] * unit**2, least[-1] * unit**2),
        variance * unit**2,
    )


def _delays(delay: int | tuple[int, int]) -> tuple[int, int]:
    """Shortest and longest delay."""
    pair = delay if isinstance(delay, tuple) else (delay, delay)
    if len(pair) != 2:
        raise ParameterError.expected("one delay or (shortest, longest)", pair, "give samples")
    shortest, longest = whole("delay", pair[0], 1), whole("delay", pair[1], 1)
    if longest < shortest:
        raise ParameterError.expected("a range of delays (shortest, longest)", pair, "turn it round")
    return shortest, longest


def _unpredicted(error: FloatArray, shortest: int, longest: int, order: int) -> list[float]:
    """Variance that the errors `delay` and more samples ago do not predict, for each delay, over the same rows.

    One triangular factor of all lags serves every delay: its columns have the geometry of the lagged errors.
    """
    lags = longest + order - 1
    rows = error.size - lags
    window = np.lib.stride_tricks.sliding_window_view(error, lags + 1)
    factor = triangular(
        lambda start, stop: np.column_stack([window[start:stop], np.ones(stop - start)]), [(0, rows)], lags + 2
    )
    now = factor[:, lags]
    left = []
    for delay in range(shortest, longest + 1):
        past = factor[:, [*range(lags - delay - order + 1, lags - delay + 1), lags + 1]]
        residual = now - past @ np.linalg.lstsq(past, now)[0]
        left.append(float(residual @ residual) / (rows - order - 1))
    return left
