"""Closed forms of the fundamental of what an actuator makes of a sine of amplitude 1."""

from __future__ import annotations

import math


def clipped_sine(ratio: float) -> float:
    """Gain of a sine clipped at `ratio` >= 0 on both sides (Gelb and Vander Velde 1968, appendix B)."""
    if ratio >= 1.0:
        return 1.0
    return 2.0 / math.pi * (math.asin(ratio) + ratio * math.sqrt(1.0 - ratio * ratio))


def gliding_sine(band: float, jump: float) -> complex:
    """Gain of a valve that rests from the peak of the sine until it has fallen by `band`, jumps, then glides.

    Choudhury et al. (2005): ``-(A - iB) / pi`` with phi = asin(1 - S), here with A and B written out in
    m = sin(phi) and q = cos(phi). With jump = 0 the play of width `band` (Gelb and Vander Velde 1968, appendix B).
    """
    if band >= 2.0:
        return 0j
    m = 1.0 - band
    q = math.sqrt(1.0 - m * m)
    real = 0.5 + (math.asin(m) + (m + 2.0 * jump) * q) / math.pi
    return complex(real, (m * m - 1.0 + 2.0 * jump * m) / math.pi)
