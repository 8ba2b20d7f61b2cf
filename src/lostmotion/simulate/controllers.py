"""Controllers."""

from __future__ import annotations

import math
from dataclasses import dataclass

from lostmotion.arguments import finite
from lostmotion.errors import ParameterError


@dataclass(frozen=True)
class PI:
    """Parallel PI, ``u(k) = bias + kp e(k) + ki dt sum e``, with limits and anti-windup by clamping.

    Parameters
    ----------
    kp : float
        Proportional gain, units of u per unit of y; negative for a process with negative gain.
    ki : float
        Integral gain, units of u per unit of y and second.
    low, high : float
        Output limits in units of u.
    bias : float
        Output at the start, with no error.

    Examples
    --------
    >>> PI(kp=0.5, ki=0.7)
    PI(kp=0.5, ki=0.7, low=-inf, high=inf, bias=0.0)
    """

    kp: float
    ki: float
    low: float = -math.inf
    high: float = math.inf
    bias: float = 0.0

    def __post_init__(self) -> None:
        for name in ("kp", "ki", "bias"):
            object.__setattr__(self, name, finite(name, getattr(self, name)))
        if not self.low < self.high:
            raise ParameterError.expected("low < high", f"low={self.low}, high={self.high}", "swap them")
