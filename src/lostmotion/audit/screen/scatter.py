"""Scatter of a measurement from row to row: what its noise is, as far as rows are fast enough to tell."""

from __future__ import annotations

from math import comb

import numpy as np

from lostmotion.arrays import FloatArray

ORDER = 4  # of the differences: what moves slower than in eight rows adds 4 % of its deviation, by the second a quarter
MOST_DT = 5.0  # s between rows: slower ones show what the process does, too
MOST = 8192  # differences, from all over the window
LEAST = 100
NORMAL = 1.4826  # deviation over median absolute value


def scatter(values: FloatArray, dt: float) -> float | None:
    """Deviation of what is new in each row, units of the signal; None: too few rows, or too far apart.

    Parameters
    ----------
    values : ndarray, shape (n,)
        NaN where nothing is known.
    dt : float
        Seconds between rows.

    Examples
    --------
    >>> rng, slow = np.random.default_rng(0), 20.0 * np.sin(np.arange(5000) / 20.0)
    >>> round(scatter(slow + 0.5 * rng.normal(size=5000), 1.0), 1)
    0.5
    """
    if dt > MOST_DT:
        return None
    moves = np.diff(values, ORDER)
    moves = moves[np.isfinite(moves)]
    moves = moves[:: max(moves.size // MOST, 1)]
    if moves.size < LEAST:
        return None
    return NORMAL * float(np.median(np.abs(moves))) / float(np.sqrt(comb(2 * ORDER, ORDER)))
