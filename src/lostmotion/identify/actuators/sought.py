"""Where the likelihood of a kind is worth climbing."""

from __future__ import annotations

from dataclasses import dataclass

from lostmotion.arrays import FloatArray
from lostmotion.identify.likelihood.family import Family


@dataclass(frozen=True)
class Sought:
    """One kind of actuator and where its likelihood is worth climbing.

    Attributes
    ----------
    family : Family
    etas : list of ndarray
        Starts, best first.
    squares : float
        Residual sum of squares of the profile at the best.
    """

    family: Family
    etas: list[FloatArray]
    squares: float
