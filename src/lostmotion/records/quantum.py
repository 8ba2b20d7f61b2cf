"""Step in which a signal was stored: the grid on which its values lie."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.records.limits import FINE_STEP

ON_GRID = 0.18  # of a step: nearer than this to a multiple is on the grid (0.06 and 0.07 for 0.0625 are); chance: 0.36
MOST_MULTIPLE = 10  # steps between neighbouring levels; longer distances do not tell
ENOUGH = 20  # distances that agree; a few do by chance
REPEATS = 4  # samples a level: as many make steps of a signal even where these are of different size
GRID_SHARE = 0.9  # of the distances between levels: some values may be averages or interpolated
CANDIDATES = (0.0, 0.05, 0.25, 0.5)  # quantiles of the distances that may be one step


def quantum(values: FloatArray) -> float:
    """Find the step on whose multiples the values lie.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Samples; NaN where missing. Rounding to decimals, to single precision and a few values off the grid
        (averages, interpolated rows) do not disturb.

    Returns
    -------
    float
        Largest step on whose grid nine tenths of the distances between levels lie. Without such a grid, but with
        few levels (the square root of a quantised difference pressure): their typical distance. 0 for a constant
        and for a signal without visible steps.

    Examples
    --------
    >>> quantum(np.round(np.sin(np.arange(500.0)), 2))
    0.01
    >>> quantum(np.sin(np.arange(500.0)))
    0.0
    """
    levels = np.unique(values[~np.isnan(values)])
    if len(levels) < 2:
        return 0.0
    size = max(float(levels[-1] - levels[0]), 1e-6 * float(np.abs(levels).max()))
    distances = np.diff(levels)
    distances = distances[distances > FINE_STEP * size]
    if not len(distances):
        return 0.0
    found = max(_refined(distances, float(np.quantile(distances, share))) for share in CANDIDATES)
    if found == 0.0 and np.sum(~np.isnan(values)) >= REPEATS * len(levels):
        found = float(np.median(distances))
    return float(f"{found:.6g}")


def _refined(distances: FloatArray, step: float) -> float:
    """Step near the candidate that fits the distances best; 0 where too few of them are multiples of it."""
    near = distances[distances < 1.5 * step]
    step = float(np.mean(near)) if len(near) else step
    multiples = np.round(distances / step)
    told = (multiples > 0) & (multiples < MOST_MULTIPLE)
    if told.sum() < min(ENOUGH, len(distances)):
        return 0.0
    step = float(distances[told].sum() / multiples[told].sum())
    ratio = distances[told] / step
    on = np.abs(ratio - np.round(ratio)) < ON_GRID
    if float(np.mean(on)) < GRID_SHARE:
        return 0.0
    return float(distances[told][on].sum() / multiples[told][on].sum())
