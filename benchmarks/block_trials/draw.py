"""A loop drawn by its kind of valve and a seed. Times in rows, the size of all signals by the gain of the process.

The order of the random numbers is part of it: the same kind and seed are the same loop for ever.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from block_trials.process import Process, fine_steps
from block_trials.valves import HE, KARNOPP, KINDS, Valve

Rng = np.random.Generator

STREAM = 77  # of random numbers, beside kind and seed
PROCESSES = {"flow": 0.25, "one lag": 0.2, "two lags": 0.2, "temperature": 0.15, "level": 0.2}  # and their shares
SECONDS = {"flow": (0.5, 1.0, 2.0), "temperature": (5.0, 10.0, 30.0)}  # between two rows
USUAL_SECONDS = (1.0, 2.0, 5.0)
SET_POINT, LOAD, BOTH = "set point", "load", "both"  # what moves


class Controller(NamedTuple):
    """PI: gain in % over PV, reset time in rows."""

    gain: float
    reset: float


class Exercise(NamedTuple):
    """What moves the loop: steps of the set point (PV), a wandering load and steps of it (%), every so many rows."""

    set_point_size: float
    set_point_every: float
    load_deviation: float
    load_time: float
    step_size: float
    step_every: float


class Instrument(NamedTuple):
    """Noise of PV: deviation and pole; whether the record is rounded, and to what steps of PV and OP."""

    noise: float
    pole: float
    rounds: bool
    pv_step: float
    op_step: float


@dataclass(frozen=True)
class Loop:
    """A loop and its valve."""

    kind: str
    seed: int
    process_name: str
    seconds: float  # between two rows
    process: Process
    controller: Controller
    valve: Valve
    pv_rest: float
    exercise: Exercise
    instrument: Instrument
    rows: int  # of its record

    @property
    def fine_steps(self) -> int:
        """In a row, whatever valve is put in."""
        return fine_steps(KINDS.index(self.kind))


def loop_of(kind: str, seed: int) -> Loop:
    """The loop with a valve of this kind and this seed."""
    rng = np.random.default_rng([seed, KINDS.index(kind), STREAM])
    name = str(rng.choice(list(PROCESSES), p=list(PROCESSES.values())))
    process, seconds = _process(rng, name)
    lag = _actuator_lag(rng, kind)
    controller, reach = _controller(rng, process, lag)
    valve, pv_rest = _valve(rng, kind, lag)
    exercise = _exercise(rng, reach)
    instrument = _instrument(rng, reach)
    rows = int(rng.integers(2000, 6001))
    return Loop(kind, seed, name, seconds, process, controller, valve, pv_rest, exercise, instrument, rows)


def _process(rng: Rng, name: str) -> tuple[Process, float]:
    """Process and seconds between two rows."""
    sign = float(rng.choice([-1.0, 1.0]))
    gain = sign * 10 ** rng.uniform(math.log10(0.3), math.log10(3))
    seconds = float(rng.choice(SECONDS.get(name, USUAL_SECONDS)))
    if name == "level":
        second_lag, dead_time = rng.uniform(0.3, 2), rng.uniform(0.3, 2)
        return Process(True, gain * rng.uniform(0.02, 0.08), 0.0, second_lag, dead_time), seconds
    lowest, highest = {"flow": (0.8, 3), "one lag": (3, 12), "two lags": (4, 12), "temperature": (8, 20)}[name]
    lag = rng.uniform(lowest, highest)
    second_lag = 0.0
    if name in ("two lags", "temperature"):
        second_lag = lag * (rng.uniform(0.2, 0.6) if name == "two lags" else rng.uniform(0.1, 0.4))
    dead_time = rng.uniform(*{"flow": (0.3, 1.5), "temperature": (1, 6)}.get(name, (0.5, 4)))
    return Process(False, gain, lag, second_lag, dead_time), seconds


def _actuator_lag(rng: Rng, kind: str) -> float:
    lag = rng.uniform(0.05, 0.4)
    if kind == "slow":
        return rng.uniform(1.5, 4)
    return rng.uniform(0.6, 1.5) if kind != "sound" and rng.random() < 0.15 else lag


def _controller(rng: Rng, process: Process, actuator_lag: float) -> tuple[Controller, float]:
    """PI by SIMC with the half rule (Skogestad 2003), and what PV reaches for 1 % in the time of the closed loop."""
    small = process.second_lag + actuator_lag
    delay = process.dead_time + 0.5 + small / 2  # half a row for sample and hold
    lag = process.lag + small / 2
    closed = max(rng.uniform(0.6, 2.5) * delay, 0.6)
    if process.integrates:
        closed = max(closed, rng.uniform(2, 6))
        controller = Controller(1 / (process.gain * (closed + delay)), 4 * (closed + delay))
        return controller, abs(process.gain) * (closed + delay)
    controller = Controller(lag / (process.gain * (closed + delay)), min(lag, 4 * (closed + delay)))
    return controller, abs(process.gain)


def _valve(rng: Rng, kind: str, lag: float) -> tuple[Valve, float]:
    """Valve, and PV at rest."""
    rule = KINDS.index(kind)
    size = rng.uniform(1, 8) if kind == "backlash" else rng.uniform(1, 6)
    jump = static = kinetic = 0.0
    if kind == "Stenman":
        jump = size
    elif kind == "Choudhury":
        jump = size * float(rng.choice([0.2, 0.5, 1.0, 1.0]))
    elif rule in (HE, KARNOPP):
        ratio = rng.uniform(0.3, 0.85)  # of kinetic friction to static
        static = size / (1 + ratio)
        kinetic, jump = static * ratio, static * (1 - ratio)
    elif kind not in ("dead zone", "backlash"):
        size = 0.0
    frequency, damping = rng.uniform(8, 20), rng.uniform(0.3, 1.0)
    curvature = rng.uniform(0.015, 0.035) if kind == "nonlinear" else 0.0
    rest = rng.uniform(35, 65)
    valve = Valve(rule, size, jump, static, kinetic, rest, lag, frequency, damping, curvature)
    return valve, rng.uniform(40, 60)


def _exercise(rng: Rng, reach: float) -> Exercise:
    moves = str(rng.choice([SET_POINT, LOAD, BOTH], p=[0.4, 0.3, 0.3]))
    size, every = reach * rng.uniform(2, 7), rng.uniform(80, 400)
    quiet = moves == SET_POINT
    deviation = rng.uniform(0.1, 0.6) if quiet else rng.uniform(0.8, 3)
    time = rng.uniform(60, 300)
    step = 0.0 if quiet else rng.uniform(1.5, 5)
    return Exercise(0.0 if moves == LOAD else size, every, deviation, time, step, rng.uniform(200, 900))


def _instrument(rng: Rng, reach: float) -> Instrument:
    noise = reach * 10 ** rng.uniform(-2, -0.7)
    pole = float(rng.choice([0.0, 0.0, 0.5]))
    rounds = bool(rng.random() < 0.4)
    pv_step = noise * float(rng.choice([0.3, 1.0]))
    op_step = float(rng.choice([0.01, 0.05]))
    return Instrument(noise, pole, rounds, 10.0 ** math.floor(math.log10(pv_step)), op_step)
