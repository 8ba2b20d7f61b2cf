"""Does the lost motion grow? Weighted regression of the sizes of the records over time or order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.special import stdtrit

from lostmotion.arrays import FloatArray

NORMAL = 1.96  # deviations of a 95 % interval to either side
FEWEST = 3  # sizes for a line with an interval


@dataclass(frozen=True)
class SizeTrend:
    """Line through the sizes of the records that spoke.

    Attributes
    ----------
    slope : float
        Units of OP for each `unit`; NaN with fewer than three sizes.
    interval : (float, float)
        95 %: sizes scatter about the line by what their intervals allow and by a deviation of their own (DerSimonian
        and Laird, 1986); the quantile is Student's (Knapp and Hartung, 2003).
    unit : str
        "day" where start times were given, else "record".
    scatter : float
        Deviation of the sizes about the line beside their own errors, units of OP.
    number : int
        Sizes used.
    centre, at_centre : float
        Mean place, and the size of the line there.
    """

    slope: float
    interval: tuple[float, float]
    unit: str
    scatter: float
    number: int
    centre: float = float("nan")
    at_centre: float = float("nan")

    @property
    def seen(self) -> bool:
        """Whether the size surely grows or shrinks."""
        return bool(self.interval[0] > 0.0 or self.interval[1] < 0.0)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        known = np.isfinite(self.slope)
        return {
            "slope": self.slope if known else None,
            "interval_95": list(self.interval) if known else [None, None],
            "unit": self.unit,
            "scatter": self.scatter if known else None,
            "number": self.number,
        }


def size_trend(
    places: Sequence[float], sizes: Sequence[float], intervals: Sequence[tuple[float, float]], unit: str
) -> SizeTrend:
    """Fit it.

    Parameters
    ----------
    places : sequence of float
        Time in `unit` of each size, or its number.
    sizes, intervals : sequences
        Units of OP, 95 %.
    unit : str

    Examples
    --------
    >>> found = size_trend([0, 1, 2, 3], [1.0, 1.5, 2.0, 2.5], [(0.9, 1.1), (1.4, 1.6), (1.9, 2.1), (2.4, 2.6)], "day")
    >>> round(found.slope, 3), found.seen
    (0.5, True)
    """
    x, y = np.asarray(places, dtype=np.float64), np.asarray(sizes, dtype=np.float64)
    ends = np.asarray(intervals, dtype=np.float64).reshape(-1, 2)
    if y.size < FEWEST or np.ptp(x) == 0.0:
        return SizeTrend(np.nan, (np.nan, np.nan), unit, np.nan, int(y.size))
    errors = np.maximum((ends[:, 1] - ends[:, 0]) / (2.0 * NORMAL), 1e-9 * np.abs(y).max())
    regressors = np.column_stack([np.ones_like(x), x - x.mean()])
    between = _between(regressors, y, errors)
    weights = 1.0 / (errors**2 + between)
    line, inverse, misfit = _weighted(regressors, y, weights)
    spread = max(misfit / (y.size - 2), 1.0)
    reach = float(stdtrit(y.size - 2, 0.975)) * float(np.sqrt(spread * inverse[1, 1]))
    slope, centre = float(line[1]), (float(x.mean()), float(line[0]))
    return SizeTrend(slope, (slope - reach, slope + reach), unit, float(np.sqrt(between)), int(y.size), *centre)


def _between(regressors: FloatArray, y: FloatArray, errors: FloatArray) -> float:
    """Variance of the sizes beside their errors (DerSimonian and Laird's moment estimate, for a regression)."""
    weights = 1.0 / errors**2
    _, inverse, misfit = _weighted(regressors, y, weights)
    trace = weights.sum() - float(np.trace(inverse @ (regressors.T @ (weights[:, None] ** 2 * regressors))))
    return float(max((misfit - (y.size - regressors.shape[1])) / max(trace, 1e-300), 0.0))


def _weighted(regressors: FloatArray, y: FloatArray, weights: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    """Coefficients, their covariance and the weighted sum of squares."""
    inverse = np.asarray(np.linalg.inv(regressors.T @ (weights[:, None] * regressors)), dtype=np.float64)
    line = inverse @ (regressors.T @ (weights * y))
    return line, inverse, float(weights @ (y - regressors @ line) ** 2)
