"""The paper's level tank: valve with dead zone, tank, transport delay."""

from __future__ import annotations

import functools

from lostmotion.models import DeadZone, Hammerstein, LinearModel

VALVE = ([25.0], [1.0, 5.0, 25.0])  # eq 27 to 30 of the paper, as all of these
TANK = ([2.0], [1.0, 0.9])
DEAD_TIME = 0.3  # s
DT = 0.1  # s
NOISE_VARIANCE = 0.03  # of the paper's experiments


@functools.cache
def level_tank() -> Hammerstein:
    """Level tank of Cequeira et al. (ICINCO 2010), section 5, in deviations from 50 %.

    Valve ``25/(s^2 + 5 s + 25)``, tank ``2/(s + 0.9)``, delay 0.3 s, dead zone +-1 % with slopes 3, sampled at
    0.1 s by zero-order hold (eqs 27-30).

    Notes
    -----
    The paper writes q^-3 for 0.3 s, so the sample that the hold takes is inside its delay: the first response
    comes 3 samples after the input, and the published tables agree with that. ``LinearModel.from_continuous``
    with dead_time=0.3 would give 4.

    Examples
    --------
    >>> tank = level_tank()
    >>> tank.linear.delay, round(tank.linear.gain, 4)
    (3, 2.2222)
    """
    num = [VALVE[0][0] * TANK[0][0]]
    v, t = VALVE[1], TANK[1]
    den = [1.0, v[1] + t[1], v[2] + v[1] * t[1], v[2] * t[1]]
    process = LinearModel.from_continuous(num, den, dead_time=DEAD_TIME - DT, dt=DT)
    return Hammerstein(DeadZone(left=-1.0, right=1.0, left_slope=3.0, right_slope=3.0), process)
