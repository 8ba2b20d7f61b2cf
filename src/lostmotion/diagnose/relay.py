"""Does PV look like the answer to a relay? A sticking valve makes one of the loop."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.halves import cut_halves, relay_answer, sine, triangle

LAGS = np.geomspace(0.03, 2.0, 16)  # time constant of the process, in half periods


@dataclass(frozen=True)
class Relay:
    """Whether PV is made of answers to a relay (towards 1) or of sines (towards -1).

    Parameters
    ----------
    index : float
        -1 to 1; published limit: above 0.21 stiction, below -0.21 none, between them uncertain.
    spread : float
        Standard error of the mean of the indices of the single half periods.
    halves : int
        Half periods used.
    """

    index: float
    spread: float
    halves: int


def relay_index(pv: FloatArray, period: float) -> Relay:
    """Fit each half period of PV by half a sine, a triangle, and the answer of a first order process to a relay.

    Parameters
    ----------
    pv : ndarray, shape (n,)
        Finite, uniformly sampled.
    period : float
        Period of the oscillation in samples, at least 4 (8 and more are needed for 4 samples a half period).

    Raises
    ------
    DataError
        Fewer than two periods, a constant, or too few samples for each half period.

    Notes
    -----
    Rossi and Scali (2005), "A comparison of techniques for automatic detection of stiction: simulation and
    application to industrial data", J. Process Control 15:505. Index (E_S - E_RT) / (E_S + E_RT) with the error E_S
    of the sine and E_RT of the better of triangle and relay. The triangle is symmetric here; the time constant of
    the relay's answer is free, its delay follows from the half period. Trend and what is above the 7th harmonic are
    taken out first; errors are divided by independent samples less parameters (1, 1, 2).

    Examples
    --------
    >>> t = np.arange(1000)
    >>> relay_index(np.sin(2 * np.pi * t / 50), 50).index < -0.9
    True
    >>> relay_index(np.sign(np.sin(2 * np.pi * (t + 0.5) / 50)), 50).index > 0.6
    True
    """
    halves = cut_halves("pv", pv, period)
    of_sine = halves.misfit(sine(halves.place), 1)
    forms = [halves.misfit(relay_answer(halves.place, lag), 2) for lag in LAGS]
    of_relay = np.min([halves.misfit(triangle(halves.place, 0.5), 1), *forms], axis=0)
    single = (of_sine - of_relay) / (of_sine + of_relay)
    index = float(halves.samples @ (of_sine - of_relay) / (halves.samples @ (of_sine + of_relay)))
    return Relay(index, float(single.std(ddof=1) / np.sqrt(single.size)), halves.count)
