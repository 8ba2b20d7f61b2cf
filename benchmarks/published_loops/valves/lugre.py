"""Bristles that bend before they slip: LuGre (Canudas de Wit, Olsson, Åström and Lischinsky 1995; Garcia 2008).

The bristles are ten times softer than Garcia's (1e7 N/m), for steps of time that can be afforded: before it breaks
away the stem gives by up to 0.03 % of its travel. Their damping fades with speed, as Olsson 1996 has it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from published_loops.meters import Meter, Turns, see_turn
from published_loops.valves import spring_and_diaphragm as actuator
from published_loops.valves.valve import Stem, label_of, sticking_kind

Array = np.ndarray
STEP = 2e-5  # s
STIFFNESS, BRISTLE_DAMPING = 1e7, 9000.0  # N/m, N s/m
FADES_AT = 10 * actuator.STRIBECK_SPEED  # m/s
LEAST_MOVE = 0.05  # % of travel: more than bristles give
X, SPEED, BENT, PRESSURE = range(4)  # of the state: m, m/s, m, share of full pressure
FORCE, TRAVEL, MASS, SPRING = actuator.FULL_FORCE, actuator.TRAVEL, actuator.MASS, actuator.SPRING


@dataclass(frozen=True)
class LuGre:
    """Static and sliding friction, % of full force."""

    static: float
    sliding: float

    @property
    def label(self) -> str:
        return label_of("lugre", self.static, self.sliding)

    @property
    def kind(self) -> str:
        return sticking_kind(self.jump)

    @property
    def size(self) -> float:
        return self.static + self.sliding

    @property
    def jump(self) -> float:
        return self.static - self.sliding

    def stem(self, place: float, seconds: float) -> Stem:
        return _Stem(self, place, seconds)


class _Stem:
    def __init__(self, valve: LuGre, place: float, seconds: float) -> None:
        self.state = np.array([actuator.travel_of(place), 0.0, 0.0, place / 100])
        self.friction = actuator.force_of(valve.static), actuator.force_of(valve.sliding)
        self.steps, self.turns = round(seconds / STEP), Turns(place, LEAST_MOVE)

    @property
    def meter(self) -> Meter:
        return self.turns

    def move(self, op: float) -> float:
        return float(_row(self.state, self.turns.state, self.turns.room, op / 100, self.friction, self.steps))


@njit
def _row(state: Array, turn: Array, brackets: Array, op: float, friction: tuple[float, float], steps: int) -> float:
    """Mean place over a row, %."""
    total = 0.0
    for _ in range(steps):
        state[PRESSURE] += STEP / actuator.PRESSURE_LAG * (op - state[PRESSURE])
        _slip(state, friction[0], friction[1])
        place = state[X] / TRAVEL * 100
        see_turn(turn, brackets, state[PRESSURE] * 100, place, LEAST_MOVE)
        total += place
    return total / steps


@njit
def _slip(state: Array, static: float, sliding: float) -> None:
    """One step; the bristles' damping and the stem's are implicit."""
    speed = state[SPEED]
    slips_at = sliding + (static - sliding) * math.exp(-((speed / actuator.STRIBECK_SPEED) ** 2))
    bent = (state[BENT] + STEP * speed) / (1 + STEP * STIFFNESS * abs(speed) / slips_at)
    bends, state[BENT] = (bent - state[BENT]) / STEP, bent
    damping = BRISTLE_DAMPING * math.exp(-((speed / FADES_AT) ** 2))
    net = FORCE * state[PRESSURE] - SPRING * state[X] - STIFFNESS * bent - damping * (bends - speed)
    state[SPEED] = (speed + STEP / MASS * net) / (1 + STEP / MASS * (actuator.DAMPING + damping))
    state[X] += STEP * state[SPEED]
