"""Orders and delay from a high-order ARX, before any iteration on the data."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.identify.start import HighOrderArx, linear_start
from lostmotion.models._arguments import FloatArray

LADDER = ((1, 0), (1, 1), (2, 0), (2, 1), (2, 2), (3, 1), (3, 2))
DELAYS_TRIED = 4  # the first significant lag is the delay or a little after it
SIGNIFICANT = 3.5  # standard errors of the first response
MOST_STRUCTURES = 3


@dataclass(frozen=True)
class Start:
    """Orders, delay and start values of the linear part."""

    na: int
    nb: int
    delay: int
    a: FloatArray
    b: FloatArray
    score: float = 0.0


def given_structure(arx: HighOrderArx, na: int, nb: int, delay: int) -> Start:
    """Start values for orders that the caller gave."""
    a, b, misfit = linear_start(arx, na, nb, delay)
    return Start(na, nb, delay, a, b, misfit)


def likely_structures(arx: HighOrderArx) -> list[Start]:
    """The few structures that explain the ARX best (misfit in units of its covariance, plus k log n), best first."""
    latest = _first_response(arx)
    room = min(arx.a.size, arx.b.size)
    starts = []
    for delay in range(max(arx.delay, latest - DELAYS_TRIED + 1), latest + 1):
        for na, nb in LADDER:
            if na + nb + 1 + delay - arx.delay > room:
                continue
            a, b, misfit = linear_start(arx, na, nb, delay)
            starts.append(Start(na, nb, delay, a, b, misfit + (na + nb + 1) * np.log(arx.samples)))
    if not starts:
        starts = [given_structure(arx, 1, 0, max(arx.delay, 1))]
    return sorted(starts, key=lambda start: start.score)[:MOST_STRUCTURES]


def _first_response(arx: HighOrderArx) -> int:
    """Lag of the first input coefficient that is significant (the largest if none is)."""
    n = arx.a.size
    error = np.sqrt(np.maximum(np.diag(arx.covariance)[n:] * arx.variance, 1e-300))
    ratio = np.abs(arx.b) / error
    large = np.flatnonzero(ratio > SIGNIFICANT)
    return arx.delay + int(large[0] if large.size else np.argmax(ratio))
