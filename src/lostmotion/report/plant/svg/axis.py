"""An axis: its ends, and round numbers along it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.report.digits import plain

STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)
SPARE = 0.05  # of the range, on either side


@dataclass(frozen=True)
class Axis:
    """From where to where, and what it is called.

    Attributes
    ----------
    low, high : float
    name : str
        With its unit.
    most : int
        Round numbers along it, about.
    """

    low: float
    high: float
    name: str = ""
    most: int = 5

    @classmethod
    def around(cls, values: FloatArray, name: str = "", most: int = 5) -> Axis:
        """Axis with a little room around all values; NaN is no value."""
        known = values[np.isfinite(values)]
        low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
        spare = SPARE * (high - low) or max(abs(low), 1.0) * SPARE
        return cls(low - spare, high + spare, name, most)

    def share(self, value: float) -> float:
        """Where a value lies: 0 at the low end, 1 at the high one."""
        return (value - self.low) / (self.high - self.low)

    def ticks(self) -> list[tuple[float, str]]:
        """Share and text of round numbers.

        Examples
        --------
        >>> Axis(0.0, 10.0).ticks()
        [(0.0, '0'), (0.2, '2'), (0.4, '4'), (0.6, '6'), (0.8, '8'), (1.0, '10')]
        """
        rough = (self.high - self.low) / self.most
        unit = 10.0 ** math.floor(math.log10(rough))
        step = next(one * unit for one in STEPS if one * unit >= rough * 0.999)
        first = math.ceil(self.low / step - 1e-9)
        last = math.floor(self.high / step + 1e-9)
        return [(self.share(count * step), _text(count * step, step)) for count in range(first, last + 1)]


def _text(value: float, step: float) -> str:
    """With the digits that tell it from its neighbours."""
    places = max(-math.floor(math.log10(step) + 1e-9), 0)
    places += round(step * 10**places, 6) % 1 != 0
    return f"{value:.{places}f}" if abs(value) < 1e6 and places < 7 else plain(value)
