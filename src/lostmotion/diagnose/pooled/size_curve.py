"""What one record says of the size of one kind: log-likelihood over that of a linear process, for every size."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray

NORMAL = 1.96  # deviations of a 95 % interval to either side


@dataclass(frozen=True)
class SizeCurve:
    """Profile over the size, everything else refitted; 0 is a linear process.

    Attributes
    ----------
    sizes, gains : ndarray, shape (k,)
        Held sizes in units of OP, ascending, and the gain in log-likelihood over the linear process at each.
    size, gain : float
        Where the kind was found: the maximum. NaN and 0 where it was not.
    interval : (float, float)
        95 % interval of `size`.
    cost : float
        What the kind costs in a record (information criterion): a gain or a loss below it tells nothing for sure.
    """

    sizes: FloatArray
    gains: FloatArray
    size: float = float("nan")
    gain: float = 0.0
    interval: tuple[float, float] = (float("nan"), float("nan"))
    cost: float = 0.0

    @property
    def known(self) -> bool:
        """Whether the maximum has an interval, so that it can be drawn as a hill."""
        return bool(np.isfinite([self.size, *self.interval]).all() and self.interval[1] > self.interval[0] > 0.0)

    def on(self, sizes: FloatArray, finest: float) -> FloatArray:
        """Gain at other sizes (ascending, above 0).

        Between held sizes it is interpolated; beyond the largest nothing moves, so nothing changes. About the maximum
        the hill has the shape that its interval says, on a logarithmic axis, and no deviation below `finest`: the
        likelihood of a threshold is a needle of many patterns (Hansen, 2000), which held sizes would step over.
        """
        knots, gains = np.r_[0.0, self.sizes], np.r_[0.0, self.gains]
        if not np.isfinite(self.size):
            return np.asarray(np.interp(sizes, knots, gains))
        if not self.known:
            at = int(np.searchsorted(knots, self.size))
            return np.asarray(np.interp(sizes, np.insert(knots, at, self.size), np.insert(gains, at, self.gain)))
        low, high = (abs(np.log(end / self.size)) / NORMAL for end in self.interval)
        off = np.log(sizes / self.size)
        hill = self.gain - 0.5 * (off / np.maximum(np.where(off < 0.0, low, high), finest)) ** 2
        return np.asarray(np.maximum(hill, np.interp(sizes, knots, gains)))

    def firm_on(self, sizes: FloatArray, finest: float) -> FloatArray:
        """What is left of gains and losses beyond the cost.

        A real process is not quite the model, and in records of one loop it differs from it in the same way: what one
        record would not settle by itself does not become sure by being there many times.
        """
        gains = self.on(sizes, finest)
        return np.asarray(np.sign(gains) * np.maximum(np.abs(gains) - self.cost, 0.0))
