"""Places to try: spread evenly in a box, and first positions that differ in what follows."""

from __future__ import annotations

from functools import cache

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.kernels.slips import first_positions

TINY = 1e-300  # keeps divisions finite
FEWEST_TURNS = 4  # of the valve, twice either way: a few slips could stand for any steps of load
GOLDEN = 1.2207440846057596  # the root of x^4 = x + 1: steps by its powers fill three dimensions evenly


@cache
def even_draws(number: int) -> FloatArray:
    """Places (number, 3) in the cube from -1 to 1 (additive recurrence)."""
    steps = GOLDEN ** -np.arange(1.0, 4.0)
    return np.asarray(2.0 * np.mod(0.5 + np.arange(1, number + 1)[:, None] * steps, 1.0) - 1.0)


def spaced_rests(u: FloatArray, band: float, jump: float, most: int) -> list[float]:
    """First positions from which one segment goes on in different ways, evenly chosen, in shares of (S + J) / 2."""
    reach = 0.5 * (band + jump)
    found = (np.sort(first_positions(u, band, jump)) - u[0]) / max(reach, TINY)
    found = found[np.abs(found) <= 1.0]
    if not found.size:
        return []
    return [float(found[at]) for at in np.unique(np.linspace(0, found.size - 1, min(most, found.size)).astype(int))]
