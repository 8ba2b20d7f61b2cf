"""Faults of a made plant: what is wrong with which loop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.errors import ParameterError
from lostmotion.evaluate.plants.made_loop import MadeLoop
from lostmotion.evaluate.plants.truth import FAULTS, SENSORS, VALVES
from lostmotion.kernels import coupled_loops as kernel
from lostmotion.models import Backlash, DeadZone, Stiction
from lostmotion.models.kernel_view import KernelActuator

SIZES = {"stiction": (1.5, 8.0), "backlash": (1.5, 8.0), "dead zone": (1.5, 8.0)}  # % of the span of OP
JUMPS = (0.3, 1.1)  # slip jump over the band
MODELS = ("kano", "he")  # of Choudhury's, small reversals can hold the valve for ever
MARGINS = (0.5, 4.0)  # degrees that a tight loop is from swinging for ever
SOFTER = (0.05, 0.4)  # of the gain of a level that is tight by its integral action
FREQUENCIES, ROUNDS = 1500, 40
NOISY = (8.0, 25.0)  # times the noise of a good sensor
LEAST_NOISY = 1.0  # % of span: what is called noise
FROZEN = (0.15, 0.5)  # of the time
DRIFTS = (4.0, 10.0)  # % of span over the record
WORKED = 0.3  # times the lost motion, the wandering of the load at least: a valve wears where it works
USUAL = (
    "stiction", "tight tuning", "backlash", "stiction", "noisy sensor", "dead zone", "stiction", "tight tuning",
    "backlash", "frozen sensor",
)  # fmt: skip


@dataclass(frozen=True)
class SensorFault:
    """What a sensor adds to its noise.

    Attributes
    ----------
    kind : str
        Of SENSORS.
    size : float
        Times the noise, share of the time, or % of span over the record.
    seed : int
    """

    kind: str
    size: float
    seed: int

    def on(self, noise: FloatArray, begin: int, rows: int) -> FloatArray:
        """Noise from row `begin` of `rows` on, with the fault; NaN where the sensor is frozen."""
        random, at = np.random.default_rng([self.seed, 5]), begin + np.arange(noise.size)
        if self.kind == "noisy sensor":
            return np.asarray(self.size * noise)
        if self.kind == "drifting sensor":
            return np.asarray(noise + self.size * at / rows * random.choice([-1.0, 1.0]))
        pieces = int(random.integers(1, 4))
        length = int(self.size * rows / pieces)
        begins = random.integers(0, max(rows - length, 1), size=pieces)
        frozen = np.any((at >= begins[:, None]) & (at < begins[:, None] + length), axis=0)
        return np.asarray(np.where(frozen, np.nan, noise))


def wanted(faults: int | Sequence[str]) -> tuple[str, ...]:
    """Faults by name; a number takes as many of the usual mixture.

    Raises
    ------
    ParameterError
        Another word, or a number below 0.
    """
    if isinstance(faults, int):
        if faults < 0:
            raise ParameterError.expected("faults >= 0", faults, f"give a number, or some of {FAULTS}")
        return tuple(USUAL[k % len(USUAL)] for k in range(faults))
    for one in faults:
        if one not in FAULTS:
            raise ParameterError.expected(f"faults out of {FAULTS}", repr(one), "name them like that")
    return tuple(faults)


def worn(rng: np.random.Generator, kind: str) -> KernelActuator:
    """Actuator with lost motion, in deviations from where it works."""
    size = float(np.exp(rng.uniform(*np.log(SIZES[kind]))))
    if kind == "backlash":
        return Backlash(size)
    if kind == "dead zone":
        middle = float(rng.uniform(-0.2, 0.2)) * size
        return DeadZone(middle - 0.5 * size, middle + 0.5 * size)
    return Stiction(size, size * float(rng.uniform(*JUMPS)), str(rng.choice(MODELS)))


def faulty(rng: np.random.Generator, loop: MadeLoop, kind: str, dt: float) -> tuple[MadeLoop, SensorFault | None]:
    """The loop with a fault."""
    if kind in VALVES:
        return replace(loop, actuator=worn(rng, kind)), None
    if kind == "tight tuning":
        if loop.integrates:  # "slow it down", said of the gain, makes a level swing slower and longer
            loop = replace(loop, kp=loop.kp * float(rng.uniform(*SOFTER)))
        return tight(loop, float(rng.uniform(*MARGINS)), loop.integrates or rng.random() < 0.5, dt), None
    size = float(rng.uniform(*dict(zip(SENSORS, (NOISY, FROZEN, DRIFTS), strict=True))[kind]))
    if kind == "noisy sensor":
        size = max(size, LEAST_NOISY / loop.noise)
    return loop, SensorFault(kind, size, int(rng.integers(2**31)))


def worked(healthy: MadeLoop, ill: MadeLoop) -> MadeLoop:
    """The loop in order, with load enough that its valve, when worn, is driven through its lost motion."""
    width = float(getattr(ill.actuator, "width", 0.0))  # a valve that sticks and slips moves by itself
    return replace(healthy, drift=max(healthy.drift, WORKED * width))


def tight(loop: MadeLoop, margin: float, by_integral: bool, dt: float) -> MadeLoop:
    """The same loop with a PI that leaves it a phase margin of so many degrees: too much gain, or integral action."""
    low, high = 1e-3, 1e3  # of gain, or one over integral time, against what they are in good order
    for _ in range(ROUNDS):
        middle = float(np.sqrt(low * high))
        low, high = (middle, high) if _phase_margin(_sharper(loop, middle, by_integral), dt) > margin else (low, middle)
    return _sharper(loop, low, by_integral)


def _sharper(loop: MadeLoop, factor: float, by_integral: bool) -> MadeLoop:
    return replace(loop, ti=loop.ti / factor) if by_integral else replace(loop, kp=loop.kp * factor)


def _phase_margin(loop: MadeLoop, dt: float) -> float:
    """Degrees, where the sampled loop alone, without its neighbours, last has the gain 1; 180: nowhere."""
    row, angle = loop.row(dt), np.geomspace(1e-6 * dt, np.pi, FREQUENCIES)
    back = np.exp(-1j * angle)
    integral = row[kernel.KI] / row[kernel.SCAN] / (1.0 - back)
    late = row[kernel.DELAY] + 1.0 + 0.5 * (row[kernel.SCAN] - 1.0)
    answer = (row[kernel.KP] + integral) * row[kernel.GAIN] * back**late
    second = (kernel.SENSOR, kernel.FILTER, kernel.STROKE, kernel.LAG1) + (() if loop.integrates else (kernel.LAG2,))
    for lag in second:
        answer = answer * row[lag] / (1.0 - (1.0 - row[lag]) * back)
    if loop.integrates:
        answer = answer * row[kernel.RATE] / (1.0 - back)
    loud = np.flatnonzero(np.abs(answer) >= 1.0)
    phase = np.unwrap(np.angle(answer))
    phase -= 2.0 * np.pi * np.ceil(phase[0] / (2.0 * np.pi) - 1e-3)  # an integrator or two: it begins below zero
    return 180.0 + float(np.degrees(phase[loud[-1]])) if loud.size else 180.0
