"""Orders and delay from a high-order ARX, before any iteration on the data."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.identify.start import HighOrderArx, linear_start
from lostmotion.models._arguments import FloatArray

LADDER = ((1, 0), (1, 1), (2, 0), (2, 1), (2, 2), (3, 1), (3, 2))
LATER = 1  # delays tried after the first significant lag; before it, all are
SIGNIFICANT = 3.5  # standard errors of the first response
LEAST_DAMPING = 0.1  # of a complex pair; valves and processes have 0.3 and more
SLOWEST_RINGING = 0.5  # largest negative real pole; a sampled continuous process has none
MOST_STRUCTURES = 3  # of different delays


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
    """The few structures that explain the ARX best (misfit plus k log n), best first."""
    latest = _first_response(arx)
    room = min(arx.a.size, arx.b.size)
    starts = []
    for delay in range(arx.delay, latest + LATER + 1):
        for na, nb in LADDER:
            if na + nb + 1 + delay - arx.delay > room:
                continue
            a, b, misfit = linear_start(arx, na, nb, delay)
            starts.append(Start(na, nb, delay, a, b, misfit + (na + nb + 1) * np.log(arx.samples)))
    if not starts:
        starts = [given_structure(arx, 1, 0, max(arx.delay, 1))]
    starts.sort(key=lambda start: start.score)
    return _of_different_delays(starts)


def neighbours(arx: HighOrderArx, na: int, nb: int, delay: int) -> list[Start]:
    """Structures one step away in one of orders and delay, with their start values."""
    room = min(arx.a.size, arx.b.size)
    steps = [(na, nb, delay - 1), (na, nb, delay + 1), (na + 1, nb, delay), (na, nb - 1, delay)]
    steps += [
        (na - 1, min(nb, na - 1), delay),
        (na, nb + 1, delay),
        (na, nb + 1, delay - 1),
        (na, nb - 1, delay + 1),
    ]
    return [
        given_structure(arx, *step)
        for step in steps
        if (step[0], step[1]) in LADDER and step[2] >= arx.delay and sum(step) + 1 - arx.delay <= room
    ]


def plausible(a: FloatArray) -> bool:
    """Whether a sampled process can have these poles: no ringing at half the sampling rate, some damping.

    Where a record says little, the likelihood likes poles on the unit circle that copy the loop's oscillation.
    """
    poles = np.roots(np.concatenate([[1.0], a]))
    log_poles = np.log(poles[np.abs(poles) > 1e-12].astype(complex))
    damping = -log_poles.real / np.maximum(np.abs(log_poles), 1e-12)
    real = np.abs(log_poles.imag) < 1e-9
    ringing = (log_poles.imag > np.pi - 1e-9) & (log_poles.real > np.log(SLOWEST_RINGING))
    return not bool(np.any(ringing | (~real & (damping < LEAST_DAMPING))))


def _of_different_delays(starts: list[Start]) -> list[Start]:
    best: dict[int, Start] = {}
    for start in starts:
        best.setdefault(start.delay, start)
    return list(best.values())[:MOST_STRUCTURES]


def _first_response(arx: HighOrderArx) -> int:
    """Lag of the first input coefficient that is significant (the largest if none is)."""
    n = arx.a.size
    error = np.sqrt(np.maximum(np.diag(arx.covariance)[n:] * arx.variance, 1e-300))
    ratio = np.abs(arx.b) / error
    large = np.flatnonzero(ratio > SIGNIFICANT)
    return arx.delay + int(large[0] if large.size else np.argmax(ratio))
