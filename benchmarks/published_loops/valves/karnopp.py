"""Friction that holds a mass at rest (Karnopp 1985) with Stribeck's curve, in the valve of Kayihan and Doyle 2000.

Below a small speed the mass stands until the net force passes the static friction. Damping is implicit in the step of
time: an explicit one stops a stem with much of it.
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
STEP = 2e-4  # s
AT_REST = 1e-5  # m/s: a slower mass stands
LEAST_MOVE = 1e-3  # % of travel that counts as a move of the stem
X, SPEED, PRESSURE = range(3)  # of the state: m, m/s, share of full pressure
FORCE, TRAVEL, MASS, SPRING = actuator.FULL_FORCE, actuator.TRAVEL, actuator.MASS, actuator.SPRING


@dataclass(frozen=True)
class Karnopp:
    """Static and sliding friction, % of full force; lag of the pressure, s; damping, N s/m."""

    static: float
    sliding: float
    lag: float = actuator.PRESSURE_LAG
    damping: float = actuator.DAMPING

    @property
    def label(self) -> str:
        lag = f"-lag-{self.lag:g}" if self.lag != actuator.PRESSURE_LAG else ""
        return label_of("karnopp", self.static, self.sliding) + lag + ("-viscous" if self.damping > 1e4 else "")

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
    def __init__(self, valve: Karnopp, place: float, seconds: float) -> None:
        self.state = np.array([actuator.travel_of(place), 0.0, place / 100])
        self.friction = (actuator.force_of(valve.static), actuator.force_of(valve.sliding), valve.damping, valve.lag)
        self.steps, self.turns = round(seconds / STEP), Turns(place, LEAST_MOVE)

    @property
    def meter(self) -> Meter:
        return self.turns

    def move(self, op: float) -> float:
        return float(_row(self.state, self.turns.state, self.turns.room, op / 100, self.friction, self.steps))


@njit
def _row(
    state: Array, turn: Array, brackets: Array, op: float, friction: tuple[float, float, float, float], steps: int
) -> float:
    """Mean place over a row, %."""
    static, sliding, damping, lag = friction
    total = 0.0
    for _ in range(steps):
        state[PRESSURE] += STEP / lag * (op - state[PRESSURE])
        net = FORCE * state[PRESSURE] - SPRING * state[X]
        if abs(state[SPEED]) >= AT_REST or abs(net) > static:
            state[SPEED] = _speed_after(state[SPEED], net, static, sliding, damping)
            state[X] += STEP * state[SPEED]
        else:
            state[SPEED] = 0.0
        place = state[X] / TRAVEL * 100
        see_turn(turn, brackets, state[PRESSURE] * 100, place, LEAST_MOVE)
        total += place
    return total / steps


@njit
def _speed_after(speed: float, net: float, static: float, sliding: float, damping: float) -> float:
    """Speed after a step in which the mass slides, or breaks away just above the speed at which it stands."""
    if abs(speed) < AT_REST:
        way = math.copysign(1.0, net)
        return (way * AT_REST * 1.01 + STEP / MASS * (net - way * static)) / (1 + STEP / MASS * damping)
    curve = math.exp(-((speed / actuator.STRIBECK_SPEED) ** 2))
    friction = math.copysign(sliding + (static - sliding) * curve, speed)
    after = (speed + STEP / MASS * (net - friction)) / (1 + STEP / MASS * damping)
    return 0.0 if after * speed < 0 else after
