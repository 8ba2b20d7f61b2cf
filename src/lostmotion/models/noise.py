"""Noise at the output: white noise through 1/D(q)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from lostmotion.arguments import coefficients, finite
from lostmotion.errors import ParameterError


@dataclass(frozen=True)
class NoiseModel:
    """Autoregressive noise ``v(k) = e(k) - d1 v(k-1) - .. - dp v(k-p)``.

    Parameters
    ----------
    d : array_like, shape (p,)
        d1 .. dp; empty for white noise (the paper's Output Error case).
    variance : float
        Variance of the white e, in units of y squared.
    """

    d: tuple[float, ...] = ()
    variance: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "d", coefficients("d", self.d))
        object.__setattr__(self, "variance", finite("variance", self.variance))
        if self.variance < 0:
            raise ParameterError.expected("variance >= 0", self.variance, "give the square of the deviation")

    @property
    def order(self) -> int:
        """Order p; 0 is white."""
        return len(self.d)

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
        return {"d": list(self.d), "variance": self.variance}
