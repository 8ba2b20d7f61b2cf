"""What closed loops have in common: PI settings, drift and set-point moves."""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter

from .plant import RANGE, Actuator, Array, Controller, Plant
from .scored import Truth


def tuned(plant: Plant, dt: float, slack: float, limit: float = np.inf) -> tuple[Controller, float]:
    """PI by Skogestad's rules with a closed-loop time of `slack` lags, and that time with its delay.

    No faster than twice the dead time and the row allow.
    """
    lag = np.sqrt(plant.up * plant.down)
    delay = plant.dead_time + dt + plant.second / 2
    pace = max(slack * lag, 2.0 * delay) + delay
    return Controller(lag / (plant.gain * pace), min(lag, 4.0 * pace), -limit, limit), pace


def drift(rng: np.random.Generator, rows: int, deviation: float, memory: float) -> Array:
    """Autoregression of the first order with this standard deviation, which forgets in `memory` rows."""
    pole = np.exp(-1.0 / memory)
    before = int(4.0 * memory) + 1
    noise = rng.normal(scale=deviation * np.sqrt(1.0 - pole**2), size=before + rows)
    return lfilter([1.0], [1.0, -pole], noise)[before:]


def truth_of(plant: Plant, op: Array) -> Truth:
    """What is asked of the answer."""
    valve = plant.actuator
    ends = (valve.left, valve.right) if valve.kind == "dead zone" else (float("nan"), float("nan"))
    return Truth(valve.kind, valve.size, float(np.ptp(op)), *ends)


def random_lag(rng: np.random.Generator) -> float:
    """Seconds, from a motor to a tank."""
    return float(np.exp(rng.uniform(np.log(0.03), np.log(30.0))))


def random_fault(kind: str, rng: np.random.Generator) -> Actuator:
    """Break points at 6 to 10 on either side, or a play of 3 to 12; of a range of OP of `RANGE`."""
    if kind == "dead zone":
        return Actuator(kind, left=-rng.uniform(0.05, 1 / 12) * RANGE, right=rng.uniform(0.05, 1 / 12) * RANGE)
    return Actuator(kind, width=rng.uniform(0.025, 0.1) * RANGE) if kind == "backlash" else Actuator()
