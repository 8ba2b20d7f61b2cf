"""Which orders and delays are tried."""

from __future__ import annotations

import numpy as np

from lostmotion.identify.likelihood.arx import HighOrderArx, linear_start
from lostmotion.identify.likelihood.poles import GridStart

# (na, nb) of sampled processes of order 1 to 3, and with the zero that a fraction of a sample of dead time adds or
# without it
LADDER = ((1, 0), (1, 1), (2, 0), (2, 1), (2, 2), (3, 1), (3, 2))
FULL = ((1, 0), (2, 1), (3, 2))  # orders of sampled processes
EARLIER, LATER = 2, 1  # delays tried before and after the first significant lag
SIGNIFICANT = 3.5  # standard errors of the first response


def null_space_starts(arx: HighOrderArx) -> list[GridStart]:
    """The structures that explain a high-order ARX best (misfit plus k log n), one for each delay, best first.

    They serve fast processes in strong feedback, where noise and dynamics can be told apart by the ARX alone.
    """
    response = _first_response(arx)
    room = min(arx.a.size, arx.b.size)
    best: dict[int, GridStart] = {}
    for delay in range(max(response - EARLIER, arx.delay), response + LATER + 1):
        for na, nb in FULL:
            if na + nb + 1 + delay - arx.delay > room:
                continue
            a, b, misfit = linear_start(arx, na, nb, delay)
            start = GridStart(na, nb, delay, a, b, misfit + (na + nb + 1) * np.log(arx.samples), 0.0)
            if delay not in best or start.score < best[delay].score:
                best[delay] = start
    return sorted(best.values(), key=lambda start: start.score)


def _first_response(arx: HighOrderArx) -> int:
    """Lag of the first input coefficient that is significant (the largest if none is)."""
    n = arx.a.size
    error = np.sqrt(np.maximum(np.diag(arx.covariance)[n:] * arx.variance, 1e-300))
    ratio = np.abs(arx.b) / error
    large = np.flatnonzero(ratio > SIGNIFICANT)
    return arx.delay + int(large[0] if large.size else np.argmax(ratio))


def distinct(starts: list[GridStart], most: int) -> list[GridStart]:
    """The best starts that differ in na, best first."""
    best: dict[int, GridStart] = {}
    for start in starts:
        best.setdefault(start.na, start)
    return list(best.values())[:most]
