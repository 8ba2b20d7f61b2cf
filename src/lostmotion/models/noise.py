"""Noise at the output: white noise through C(q)/D(q)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from lostmotion.arguments import coefficients, finite
from lostmotion.arrays import FloatArray
from lostmotion.errors import ParameterError

LEFT, MOST_LAGS = 0.01, 60  # of a zero as an autoregression


@dataclass(frozen=True)
class NoiseModel:
    """Noise ``v(k) = e(k) - zero e(k-1) - d1 v(k-1) - .. - dp v(k-p)``, autoregressive where the zero is 0.

    Of a higher order: ``e(k) + c1 e(k-1) + .. + cm e(k-m)`` in the place of its first two terms.

    Parameters
    ----------
    d : array_like, shape (p,)
        d1 .. dp; empty for white noise (the paper's Output Error case).
    variance : float
        Variance of the white e, in units of y squared.
    zero : float
        In [0, 1): slow drift behind fast noise has one.
    c : array_like, shape (m,)
        c1 .. cm; its zeros lie inside the unit circle. The load of a level, which drifts, behind noise has two.
    """

    d: tuple[float, ...] = ()
    variance: float = 0.0
    zero: float = 0.0
    c: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "d", coefficients("d", self.d))
        object.__setattr__(self, "variance", finite("variance", self.variance))
        if self.variance < 0:
            raise ParameterError.expected("variance >= 0", self.variance, "give the square of the deviation")
        object.__setattr__(self, "zero", finite("zero", self.zero))
        if not 0.0 <= self.zero < 1.0:
            raise ParameterError.expected("a zero in [0, 1)", self.zero, "0 is autoregressive noise")
        object.__setattr__(self, "c", coefficients("c", self.c))
        if self.c and (self.zero or self._slowest_zero >= 1.0):
            got = f"{list(self.c)} beside a zero at {self.zero:g}"
            raise ParameterError.expected("a C(q) with zeros inside the unit circle, alone", got, "check the noise")

    @property
    def order(self) -> int:
        """Order p; 0 is white."""
        return len(self.d)

    @property
    def numerator(self) -> tuple[float, ...]:
        """Coefficients of C(q), beginning with 1."""
        return (1.0, *self.c) if self.c else (1.0, -self.zero) if self.zero else (1.0,)

    @property
    def _slowest_zero(self) -> float:
        return float(max(abs(np.roots(self.numerator)), default=0.0))

    @property
    def radius(self) -> float:
        """Modulus of the slowest pole of 1/D, below 1 if stationary; 0 for white noise.

        Examples
        --------
        >>> NoiseModel([-0.95], 0.01).radius, NoiseModel().radius
        (0.95, 0.0)
        """
        return float(max((abs(pole) for pole in np.roots([1.0, *self.d])), default=0.0))

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready description."""
        zeros = {"zero": self.zero} if self.zero else {"c": list(self.c)} if self.c else {}
        return {"d": list(self.d), "variance": self.variance, **zeros}

    def autoregression(self, most: int = MOST_LAGS) -> NoiseModel:
        """The same noise without zeros, by a long D that is cut off where a hundredth is left, or at `most` lags.

        Examples
        --------
        >>> NoiseModel([-0.9], 1.0, zero=0.5).autoregression().d[:3]
        (-0.4, -0.2, -0.1)
        """
        slowest = self._slowest_zero
        if slowest == 0.0:
            return self
        lags = max(min(self.order + math.ceil(math.log(LEFT) / math.log(slowest)), most), self.order)
        whole, after = [1.0, *self.d, *[0.0] * (lags - self.order)], self.numerator[1:]
        for lag in range(1, lags + 1):
            whole[lag] -= sum(one * whole[lag - 1 - back] for back, one in enumerate(after) if back < lag)
        return NoiseModel(tuple(whole[1:]), self.variance)


def white_share(d: FloatArray) -> float:
    """Variance of the errors e of stationary noise D(q) v = e over that of v (Durbin-Levinson); 0 where it grows."""
    left, share = d, 1.0
    while left.size:
        reflection = float(left[-1])
        kept = 1.0 - reflection**2
        if not kept > 0.0:
            return 0.0
        share *= kept
        left = (left[:-1] - reflection * left[-2::-1]) / kept
    return share
