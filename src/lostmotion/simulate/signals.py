"""Test signals."""

from __future__ import annotations

import numpy as np

from lostmotion.arguments import whole
from lostmotion.arrays import FloatArray
from lostmotion.errors import ParameterError


def prs(n: int, low: float, high: float, hold: int, seed: int | np.random.Generator | None) -> FloatArray:
    """Pseudo-random staircase: levels uniform in [low, high], each held for `hold` samples (paper, section 5).

    Parameters
    ----------
    n : int
        Samples.
    low, high : float
        Range of the levels, in units of u.
    hold : int
        Samples for which a level is held, at least 1.
    seed : int, Generator or None
        Seed of the levels.

    Raises
    ------
    ParameterError
        n or hold below 1, or low >= high.

    Examples
    --------
    >>> prs(5, -1.0, 1.0, hold=2, seed=0).round(2).tolist()
    [0.27, 0.27, -0.46, -0.46, -0.92]
    """
    n, hold = whole("n", n, 1), whole("hold", hold, 1)
    if not (np.isfinite(low) and np.isfinite(high) and low < high):
        raise ParameterError.expected("low < high", f"low={low}, high={high}", "swap them")
    levels = np.random.default_rng(seed).uniform(low, high, -(-n // hold))
    return np.repeat(levels, hold)[:n]
