"""Routine operation of the level tank: PI loop, set-point moves, drifting disturbance."""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter

from lostmotion.errors import ParameterError
from lostmotion.models import Hammerstein, Nonlinearity
from lostmotion.simulate.controllers import PI
from lostmotion.simulate.loop import simulate_loop
from lostmotion.simulate.platforms.level_tank import NOISE_VARIANCE, level_tank
from lostmotion.simulate.response import LoopResponse

PAPER_PI = PI(kp=0.5, ki=0.7, low=-50.0, high=50.0)  # 0 to 100 % of a valve at rest at 50 %
HOLD = 300  # samples between set-point moves: 30 s
VALVE_SLOPE = 3.0  # of the paper's dead zone: another actuator gets it in the process
DRIFT_POLE = 0.99  # of the first-order drift: it forgets in 10 s
DRIFT = {"none": 0.0, "mild": 0.3, "strong": 1.0, "very strong": 3.0}  # its deviation, in set-point moves


def routine_operation(
    n: int,
    drift: str = "mild",
    seed: int | np.random.Generator | None = None,
    noise_variance: float = NOISE_VARIANCE,
    actuator: Nonlinearity | None = None,
) -> LoopResponse:
    """Record of the paper's tank as it runs every day, without any test.

    Set point at -1, 0 or +1 %, drawn anew every 30 s; at the output a first-order drift (pole 0.99 at 0.1 s) whose
    deviation is 0.3 (mild), 1 (strong) or 3 (very strong) times a set-point move, and white measurement noise.

    Parameters
    ----------
    n : int
        Samples of 0.1 s.
    drift : {"none", "mild", "strong", "very strong"}
        Strength of the disturbance.
    seed : int, Generator or None
        Seed of set point, disturbance and noise.
    noise_variance : float
        Variance of the white measurement noise.
    actuator : Nonlinearity, optional
        Instead of the paper's dead zone; its slope of 3 then goes into the linear part.

    Raises
    ------
    ParameterError
        Unknown drift.

    Examples
    --------
    >>> record = routine_operation(600, drift="mild", seed=1)
    >>> len(record), bool(abs(record.command).max() < 20)
    (600, True)
    """
    if drift not in DRIFT:
        raise ParameterError.expected(f"drift as one of {list(DRIFT)}", repr(drift), "choose one of them")
    random = np.random.default_rng(seed)
    reference = np.repeat(random.choice([-1.0, 0.0, 1.0], n // HOLD + 1), HOLD)[:n]
    shocks = random.normal(scale=DRIFT[drift] * np.sqrt(1 - DRIFT_POLE**2), size=n)
    disturbance = lfilter([1.0], [1.0, -DRIFT_POLE], shocks)
    tank = level_tank()
    if actuator is not None:
        tank = Hammerstein(actuator, tank.linear.scaled(VALVE_SLOPE))
    return simulate_loop(tank, PAPER_PI, reference, disturbance=disturbance, noise=noise_variance, seed=random)
