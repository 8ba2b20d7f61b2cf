"""What works on a loop: set point, load and noise, a value a row, as deviations from where the loop rests."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from block_trials.draw import Exercise, Loop, Rng
from block_trials.valves import KINDS, Array

SHORTEST_HOLD, SHORTEST_STEP = 30, 50  # rows
KICK = slice(20, 60)  # rows
KICK_REACH, ROWS_OF_A_LEVEL = 3.0, 8.0  # %, and how long it runs: where the loop's own set point never moves


class Signals(NamedTuple):
    """Set point and noise in units of PV, load in %."""

    set_point: Array
    load: Array
    noise: Array


def in_operation(loop: Loop, rows: int, seed: int) -> Signals:
    """As the loop is run; `seed`: of this run."""
    rng = np.random.default_rng([seed, loop.seed, KINDS.index(loop.kind)])
    set_point = _set_point(rng, rows, loop.exercise)
    load = _load(rng, rows, loop.exercise)
    pole = loop.instrument.pole
    noise = first_order(rng.standard_normal(rows), pole, math.sqrt(1 - pole * pole)) * loop.instrument.noise
    return Signals(set_point, load, noise)


def left_alone(loop: Loop, rows: int, load: float) -> Signals:
    """Without noise at a constant load, after a move of the set point that is taken back."""
    set_point = np.zeros(rows)
    reach = abs(loop.process.gain) * KICK_REACH * (ROWS_OF_A_LEVEL if loop.process.integrates else 1.0)
    set_point[KICK] = loop.exercise.set_point_size or reach
    return Signals(set_point, np.full(rows, load), np.zeros(rows))


@njit
def first_order(shocks: Array, pole: float, scale: float) -> Array:
    """Autoregression of first order from 0."""
    made, value = np.empty(shocks.size), 0.0
    for k in range(shocks.size):
        value = pole * value + scale * shocks[k]
        made[k] = value
    return made


def _set_point(rng: Rng, rows: int, exercise: Exercise) -> Array:
    """Steps to one of 41 levels."""
    level, size = np.zeros(rows), exercise.set_point_size
    row = int(rng.exponential(exercise.set_point_every))
    if size == 0:
        return level
    while row < rows:
        level[row:] = rng.uniform(-1, 1) * size
        row += max(SHORTEST_HOLD, int(rng.exponential(exercise.set_point_every)))
    return np.round(level / (size / 20)) * (size / 20)


def _load(rng: Rng, rows: int, exercise: Exercise) -> Array:
    """It wanders, and steps from value to value."""
    pole = math.exp(-1 / exercise.load_time)
    load = first_order(rng.standard_normal(rows), pole, exercise.load_deviation * math.sqrt(1 - pole * pole))
    if exercise.step_size == 0:
        return load
    row = int(rng.exponential(exercise.step_every))
    while row < rows:
        end = row + max(SHORTEST_STEP, int(rng.exponential(exercise.step_every)))
        load[row:end] += rng.uniform(-1, 1) * exercise.step_size
        row = end
    return load
