"""A second family of closed loops, drawn otherwise than ``random_faulty_loop``: does the diagnosis hold on it as well?

A full grid: cause x process x disturbance (white noise, drift, a sine of load, steps of load) x width 1, 2, 5, 10 % of
span; in two thirds of the loops the set point moves every one to four minutes. Nothing was calibrated on it.
"""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter

from lostmotion.evaluate.random_faults import CAUSES, PROCESSES, REST, FaultyLoop, near_the_limit
from lostmotion.models import (
    Backlash,
    DeadZone,
    Hammerstein,
    Identity,
    LinearModel,
    Nonlinearity,
    Saturation,
    Stiction,
)
from lostmotion.simulate import PI, simulate_loop

DISTURBANCES = ("white", "drift", "sine", "steps")
WIDTHS = (1.0, 2.0, 5.0, 10.0)
CELLS = len(CAUSES) * len(PROCESSES) * len(DISTURBANCES) * len(WIDTHS)
SAMPLES = 2000


def second_family(seed: int, share: float = 1.0) -> FaultyLoop:
    """Cell `seed` of the grid (modulo its size), with everything else drawn; of the width only a share is there."""
    rest, cause = divmod(seed, len(CAUSES))
    process = PROCESSES[rest % len(PROCESSES)]
    disturbance = DISTURBANCES[rest // len(PROCESSES) % len(DISTURBANCES)]
    width = WIDTHS[rest // (len(PROCESSES) * len(DISTURBANCES)) % len(WIDTHS)]
    rng = np.random.default_rng([seed, 991])
    linear, kp, ki, gain = _loop(rng, process)
    if CAUSES[cause] == "tuning":
        kp, ki = near_the_limit(linear, kp, ki, 0.97)
    actuator = _actuator(rng, CAUSES[cause], share * width)
    deviation = width * rng.uniform(0.05, 0.45) / max(kp, 0.3)
    noise = deviation * rng.normal(size=SAMPLES)
    load = _load(rng, disturbance, width)
    if CAUSES[cause] == "disturbance":
        load = load + 1.5 * width * np.sin(2.0 * np.pi * np.arange(SAMPLES) / rng.uniform(30, 120) + 1.0)
    reference = _moves(rng, width * gain) if rng.random() < 2.0 / 3.0 else np.zeros(SAMPLES)
    response = simulate_loop(
        Hammerstein(actuator, linear), PI(kp, ki, -REST, REST), reference,
        disturbance=linear.simulate(load), noise=noise, allow_unstable=True,
    )  # fmt: skip
    size = float(getattr(actuator, "width", getattr(actuator, "band", 0.0)))
    return FaultyLoop(
        CAUSES[cause], process, actuator, size, REST + response.control, REST + response.measured,
        REST + response.reference, linear.dt, deviation * kp,
    )  # fmt: skip


def _loop(rng: np.random.Generator, process: str) -> tuple[LinearModel, float, float, float]:
    """Process, PI by lambda tuning, and the change of PV that a change of OP by one makes (1 for a level)."""
    gain = rng.uniform(0.5, 2.0)
    if process == "level":
        rate, dead = rng.uniform(0.02, 0.08), 1.0
        linear = LinearModel.from_continuous([rate], [1.0, 0.0], dead, 1.0)
        pace = rng.uniform(8.0, 20.0)
        kp = (2.0 * pace + dead) / (rate * (pace + dead) ** 2)
        return linear, kp, kp / (2.0 * pace + dead), 1.0
    lag, dead = {
        "flow": lambda: (rng.uniform(1.0, 4.0), 1.0),
        "pressure": lambda: (rng.uniform(5.0, 12.0), 2.0),
        "temperature": lambda: (rng.uniform(15.0, 30.0), float(rng.integers(3, 7))),
    }[process]()
    pace = max(2.0 * lag, 3.0) if process == "flow" else lag
    den = [lag, 1.0] if process != "temperature" else np.convolve([lag, 1.0], [0.2 * lag, 1.0])
    linear = LinearModel.from_continuous([gain], den, dead, 1.0)
    kp = lag / (gain * (pace + dead))
    return linear, kp, kp / lag, gain


def _actuator(rng: np.random.Generator, cause: str, width: float) -> Nonlinearity:
    if cause == "dead zone":
        return DeadZone(-0.5 * width, 0.5 * width)
    if cause == "backlash":
        return Backlash(width)
    if cause == "stiction":
        return Stiction(width, width * float(rng.choice([0.3, 0.6, 1.0])))
    return Saturation(-0.5 * width, 0.5 * width) if cause == "saturation" else Identity()


def _load(rng: np.random.Generator, disturbance: str, width: float) -> np.ndarray:
    time = np.arange(SAMPLES)
    if disturbance == "drift":
        drift = lfilter([1.0], [1.0, -0.995], rng.normal(size=SAMPLES))
        return np.asarray(drift * width * rng.uniform(0.3, 1.0) / drift.std())
    if disturbance == "sine":
        return np.asarray(width * rng.uniform(0.3, 1.0) * np.sin(2.0 * np.pi * time / rng.uniform(60, 200)))
    load = np.zeros(SAMPLES)
    if disturbance == "steps":
        for change in np.sort(rng.integers(0, SAMPLES, 10)):
            load[change:] = width * rng.normal()
    return load


def _moves(rng: np.random.Generator, size: float) -> np.ndarray:
    """A set point that moves every 60 to 250 samples."""
    reference = np.zeros(SAMPLES)
    row = 0
    while row < SAMPLES:
        reference[row:] = size * rng.normal()
        row += int(rng.integers(60, 250))
    return reference
