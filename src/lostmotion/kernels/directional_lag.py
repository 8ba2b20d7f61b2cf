"""A first-order lag whose time constant differs with direction, as two more inputs of a linear one."""

from __future__ import annotations

import math

from lostmotion.arrays import FloatArray
from lostmotion.kernels.numba_cache import njit

FINEST = 0.15  # of a time constant: a lag that turns round inside a row is simulated in steps of so much
MOST_STEPS = 32


@njit(nogil=True)
def missing_travel(x: FloatArray, pole: float, up: float, outward: float, centre: float, courses: FloatArray) -> None:
    """Fill `courses` (2, n) with |x - z| and |x - z| sign(z - centre), from rest at the first x (n,).

    T dz/dt = d + up |d| + outward |d| sign(z - centre), d = x - z, is the lag: faster up than down with `up` positive,
    faster away from the centre than towards it with `outward` positive. `pole` = exp(-row / T). Both courses are
    weighed over each row as the linear lag forgets them, so that they act as its inputs do.
    """
    steps = min(max(math.ceil(-math.log(pole) / FINEST), 1), MOST_STEPS)
    inner = pole ** (1.0 / steps)
    share, whole = 1.0 - inner, 1.0 - pole
    z = x[0]
    for k in range(x.size):
        travels, aways = 0.0, 0.0
        for _ in range(steps):
            missing = x[k] - z
            travel = abs(missing)
            away = travel if z > centre else (-travel if z < centre else 0.0)
            travels, aways = inner * travels + share * travel, inner * aways + share * away
            z += share * (missing + up * travel + outward * away)
        courses[0, k], courses[1, k] = travels / whole, aways / whole
