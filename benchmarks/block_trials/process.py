"""Valve and process through one row in fine steps: dead time, then one or two lags, or an integration and a lag."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from block_trials.valves import KARNOPP, Array, Valve, flow_through, held_at_scan, move_stem

FINE_STEPS, STEPS_OF_A_MASS = 20, 100  # in a row; Karnopp's mass needs more


class Process(NamedTuple):
    """Times in rows; gain in PV over %, of an integrating one in PV a row over %."""

    integrates: bool
    gain: float
    lag: float
    second_lag: float
    dead_time: float


def fine_steps(rule: int) -> int:
    """In a row."""
    return STEPS_OF_A_MASS if rule == KARNOPP else FINE_STEPS


def nothing_on_its_way(process: Process, steps: int) -> Array:
    """What is inside the dead time, in fine steps."""
    return np.zeros(max(1, round(process.dead_time * steps)))


@njit
def share(step: float, lag: float) -> float:
    """Of its way that a first-order lag goes in a step of time."""
    return 1.0 - math.exp(-step / lag) if lag > 0 else 1.0


@njit
def through_a_row(
    valve: Valve, process: Process, stem: Array, lags: Array, delayed: Array, row: int, steps: int, command: float,
    load: float,
) -> float:  # fmt: skip
    """PV without noise at the end of a row in which the command is held; changes the states.

    `stem`: of the valve; `lags`: both of the process; `delayed`: a ring of what is inside the dead time; `load`: in %.
    """
    step = 1.0 / steps
    target = held_at_scan(valve, stem, command)
    approach, first, second = share(step, valve.lag), share(step, process.lag), share(step, process.second_lag)
    place = row * steps % delayed.size
    for _ in range(steps):
        flow = flow_through(valve, move_stem(valve, stem, target, approach, step))
        arriving = delayed[place]
        delayed[place] = process.gain * (flow + load)
        place = (place + 1) % delayed.size
        if process.integrates:
            lags[0] += step * arriving
        else:
            lags[0] += first * (arriving - lags[0])
        lags[1] += second * (lags[0] - lags[1])
    return lags[1]
