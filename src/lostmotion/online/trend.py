"""A slow change from independent points: weighted line, whether one fits, and when it reaches a limit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from scipy import special

from lostmotion.arrays import FloatArray
from lostmotion.errors import DataError, ParameterError

MOST_POINTS = 64  # usual: a trend is a line, and the state file stays small
FEWEST_POINTS = 4  # two degrees of freedom for the check that a line fits
FITS = 0.01  # a line is refused where chi-square as large has less than this probability
SIGNIFICANT = 0.99  # confidence that a slope needs before a time is told: it is asked again at every report


@dataclass(frozen=True)
class Reach:
    """When a line reaches a limit.

    Parameters
    ----------
    state : str
        "approaching"; "reached" (the line is there already); "away" (the value goes the other way); "level" (no
        significant slope).
    time : float or None
        Best estimate; None unless approaching.
    earliest, latest : float or None
        Ends of the confidence interval (Fieller); None: open. A level line still has an earliest time.
    """

    state: str
    time: float | None
    earliest: float | None
    latest: float | None


@dataclass(frozen=True)
class Line:
    """Straight line through the latest points that one fits.

    Parameters
    ----------
    since, until : float
        Times of the first and last point used.
    points : int
        How many, and `left_out` older ones that no common line fits.
    centre, value, slope : float
        ``value + slope (t - centre)``; value and slope are uncorrelated.
    value_error, slope_error : float
        Standard errors, widened by sqrt(chi_square / freedom) where that is above 1.
    chi_square : float
        Weighted sum of squared residuals; `freedom` degrees of freedom; `probability` of as large a one.
    """

    since: float
    until: float
    points: int
    left_out: int
    centre: float
    value: float
    slope: float
    value_error: float
    slope_error: float
    chi_square: float
    freedom: int
    probability: float

    @property
    def fits(self) -> bool:
        """Whether the points agree with a line; if not, nothing may be extrapolated."""
        return self.probability >= FITS

    @property
    def significant(self) -> bool:
        """Whether the slope differs from zero (99 %)."""
        return self.fits and bool(abs(self.slope) > special.ndtri(0.5 + SIGNIFICANT / 2) * self.slope_error)

    def at(self, time: float) -> tuple[float, float]:
        """Value and standard error at a time."""
        away = time - self.centre
        return self.value + self.slope * away, float(np.hypot(self.value_error, self.slope_error * away))

    def reach(self, limit: float, level: float = 0.95) -> Reach | None:
        """When the line reaches a limit from below; None where no line fits.

        Fieller's interval: the times at which the limit lies within the confidence band of the line.
        """
        if not self.fits:
            return None
        if self.at(self.until)[0] >= limit:
            return Reach("reached", None, None, None)
        earliest, latest = self._band(limit, float(special.ndtri(0.5 + level / 2)))
        if not self.significant:
            return Reach("level", None, earliest if earliest is not None and earliest > self.until else None, None)
        if self.slope < 0:
            return Reach("away", None, None, None)
        return Reach("approaching", self.centre + (limit - self.value) / self.slope, earliest, latest)

    def _band(self, limit: float, z: float) -> tuple[float | None, float | None]:
        """Times from which on, and up to which, the limit is within z standard errors of the line."""
        short = limit - self.value
        a = self.slope**2 - (z * self.slope_error) ** 2
        c = short**2 - (z * self.value_error) ** 2
        inside = (self.slope * short) ** 2 - a * c
        if a == 0 or inside < 0:
            return None, None
        ends = sorted(self.centre + (self.slope * short + sign * inside**0.5) / a for sign in (-1.0, 1.0))
        return (ends[0], ends[1]) if a > 0 else (ends[1], None)


class Trend:
    """Independent points of a slowly changing value, in constant memory.

    Where there are more than `most` points, the two neighbours whose union loses least about the slope become one,
    weighted by their precision.

    Examples
    --------
    >>> trend = Trend()
    >>> for day in range(10):
    ...     trend.add(day, 1.0 + 0.1 * day, 0.02)
    >>> line = trend.line
    >>> round(line.slope, 6), line.significant, round(line.reach(3.0).time, 6)
    (0.1, True, 20.0)
    """

    def __init__(self, most: int = MOST_POINTS) -> None:
        if most < FEWEST_POINTS:
            raise ParameterError.expected(f"most >= {FEWEST_POINTS}", most, "64 is usual")
        self._most = most
        self._points: list[tuple[float, float, float]] = []  # time, value, weight
        self._line: Line | None = None
        self._fitted = True

    def __len__(self) -> int:
        return len(self._points)

    def add(self, time: float, value: float, error: float) -> None:
        """Take one point, later than those before; `error` is its standard error.

        Raises
        ------
        DataError
            A number is not finite, the error not positive, or the time not later.
        """
        if not np.all(np.isfinite([time, value, error])) or error <= 0:
            raise DataError.expected("finite numbers and error > 0", f"{time}, {value}, {error}", "leave the point out")
        if self._points and time <= self._points[-1][0]:
            raise DataError.expected(f"a time after {self._points[-1][0]}", time, "give the points in order")
        self._points.append((float(time), float(value), float(error) ** -2))
        if len(self._points) > self._most:
            self._merge()
        self._fitted = False

    @property
    def line(self) -> Line | None:
        """Line through the longest series of latest points that one fits; None with fewer than 4 points.

        Where not even the last 4 agree with a line, that through them, with ``fits`` False.
        """
        if not self._fitted:
            self._line, self._fitted = self._fit(), True
        return self._line

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready; the numbers come back bit by bit."""
        return {"most": self._most, "points": [list(point) for point in self._points]}

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Self:
        """Trend from :meth:`to_dict`."""
        new = cls(data["most"])
        new._points = [(float(time), float(value), float(weight)) for time, value, weight in data["points"]]
        new._fitted = False
        return new

    def _merge(self) -> None:
        time, _, weight = np.array(self._points).T
        loss = weight[:-1] * weight[1:] / (weight[:-1] + weight[1:]) * np.diff(time) ** 2
        first = int(np.argmin(loss))
        (t, x, v), (u, y, w) = self._points[first : first + 2]
        self._points[first : first + 2] = [((v * t + w * u) / (v + w), (v * x + w * y) / (v + w), v + w)]

    def _fit(self) -> Line | None:
        if len(self._points) < FEWEST_POINTS:
            return None
        points = np.array(self._points)
        line = None
        for first in range(len(points) - FEWEST_POINTS + 1):
            line = _line(points[first:], first)
            if line.fits:
                break
        return line


def _line(points: FloatArray, left_out: int) -> Line:
    """Weighted least squares with known variances."""
    time, value, weight = points.T
    total = weight.sum()
    centre, mean = float(weight @ time / total), float(weight @ value / total)
    away = time - centre
    spread = float(weight @ away**2)
    slope = float(weight @ (away * (value - mean))) / spread
    chi_square = float(weight @ (value - mean - slope * away) ** 2)
    freedom = len(points) - 2
    widen = max(1.0, chi_square / freedom) ** 0.5
    return Line(
        since=float(time[0]),
        until=float(time[-1]),
        points=len(points),
        left_out=left_out,
        centre=centre,
        value=mean,
        slope=slope,
        value_error=widen * float(total) ** -0.5,
        slope_error=widen * spread**-0.5,
        chi_square=chi_square,
        freedom=freedom,
        probability=float(special.gammaincc(0.5 * freedom, 0.5 * chi_square)),
    )
