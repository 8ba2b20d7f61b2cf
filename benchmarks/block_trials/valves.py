"""Valves with one fault each. Command and stem in % of the stroke, times in rows (one row: one scan of the controller).

S, the size, is how far a command has to turn until the stem follows, and J, the jump, how far it slips then.

Sources: Stenman, Gustafsson and Forsman 2003 (J = S). Choudhury, Thornhill and Shah 2005, with two parameters: a stem
that has stopped lets go J further on in its direction or S against it, and slides (S - J) / 2 behind; here it stops
where the command turns, not where it stands. He, Wang, Pottmann and Qin 2007: static and kinetic friction fs and fd, S
= fs + fd, J = fs - fd; the stem sticks anew after each move. Karnopp 1985: a mass on a spring that friction holds at
rest. Stenman's, Choudhury's and He's look at the command once in a row, the others in fine steps. Play and dead zone:
Tao and Kokotovic 1996.

Compiled anew in each process: Numba's cache keeps the name by which a module was imported, and this one has two.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

Array = np.ndarray

RULES = SOUND, SLOW, NONLINEAR, DEAD_ZONE, BACKLASH, STENMAN, CHOUDHURY, HE, KARNOPP = tuple(range(9))
KINDS = ("sound", "slow", "nonlinear", "dead zone", "backlash", "Stenman", "Choudhury", "He", "Karnopp")  # by rule
FAULTLESS, STICKING = KINDS[: NONLINEAR + 1], KINDS[STENMAN:]

POSITION, STEM, SPEED, HELD, BEFORE, TURNED_AT, STUCK, MOVED, WAY, CARRIED, TRAVEL, STATES = range(12)  # of the state
FULL_STROKE = 100.0  # %


class Valve(NamedTuple):
    """Fault, actuator and characteristic."""

    rule: int
    size: float  # S, %: full width of a play or a dead zone
    jump: float  # J, %
    static: float  # fs, %: friction over the spring of the actuator
    kinetic: float  # fd, %
    rest: float  # %: middle of the dead zone, and where the loop works
    lag: float  # of the actuator, rows
    frequency: float  # natural, of Karnopp's mass, radians a row
    damping: float  # of the mass, over the critical one
    curvature: float  # of the characteristic, 1/%; 0: linear

    def scaled(self, factor: float) -> Valve:
        """With a lost motion of this times the size; 0: repaired."""
        lost = {name: getattr(self, name) * factor for name in ("size", "jump", "static", "kinetic")}
        return self._replace(**lost)

    def ideal(self) -> Valve:
        """With the same actuator and characteristic, without fault or mass."""
        return self._replace(rule=SOUND)


def valve_at_rest(valve: Valve) -> Array:
    """State of a valve that has come to rest where the loop works."""
    state = np.zeros(STATES)
    for place in (POSITION, STEM, HELD, BEFORE, TURNED_AT):
        state[place] = valve.rest
    state[STUCK] = 1.0
    return state


@njit
def stenman(command: float, held: float, size: float) -> float:
    """The stem stays until the command is more than S away, and goes there."""
    return command if abs(command - held) > size else held


@njit
def choudhury(state: Array, command: float, size: float, jump: float) -> float:
    """It sticks where the command turned, and slides on behind it."""
    held, way, slides_behind = state[HELD], state[WAY], (size - jump) / 2.0
    moved = command - state[BEFORE]
    if moved * state[MOVED] < 0.0:
        if state[STUCK] == 0.0:
            state[TURNED_AT] = state[BEFORE]
        state[STUCK] = 1.0
    if state[STUCK] == 1.0:
        away = command - state[TURNED_AT]
        if abs(away) > (jump if away * way > 0.0 else size):
            state[STUCK] = 0.0
            way = 1.0 if away > 0.0 else -1.0
            held = command - way * slides_behind
    elif moved != 0.0:
        way = 1.0 if moved > 0.0 else -1.0
        held = command - way * slides_behind
    if moved != 0.0:
        state[MOVED] = moved
    state[BEFORE], state[WAY] = command, way
    return held


@njit
def he(state: Array, command: float, static: float, kinetic: float) -> float:
    """What has not moved the stem is carried over; above fs it moves by all but fd."""
    force = command - state[BEFORE] + state[CARRIED]
    state[BEFORE] = command
    if abs(force) <= static:
        state[CARRIED] = force
        return state[HELD]
    way = 1.0 if force > 0.0 else -1.0
    state[CARRIED] = way * kinetic
    return state[HELD] + force - way * kinetic


@njit
def backlash(position: float, stem: float, size: float) -> float:
    """Pushed by either flank."""
    if position - stem > size / 2:
        return position - size / 2
    return position + size / 2 if stem - position > size / 2 else stem


@njit
def dead_zone(position: float, middle: float, size: float) -> float:
    """Nothing moves inside the zone; its width is lost."""
    if position > middle + size / 2:
        return position - size / 2
    return position + size / 2 if position < middle - size / 2 else middle


@njit
def karnopp(valve: Valve, position: float, stem: float, speed: float, step: float) -> tuple[float, float]:
    """Stem and speed after a step of time; forces over the mass."""
    stiffness = valve.frequency * valve.frequency
    spring = stiffness * (position - stem)
    if speed == 0.0:
        if abs(spring) > stiffness * valve.static:
            way = 1.0 if spring > 0 else -1.0
            speed = step * (spring - way * stiffness * valve.kinetic)
    else:
        way = 1.0 if speed > 0 else -1.0
        damped = 2 * valve.damping * valve.frequency * speed
        faster = speed + step * (spring - way * stiffness * valve.kinetic - damped)
        speed = 0.0 if faster * speed <= 0.0 else faster
    return stem + step * speed, speed


@njit
def held_at_scan(valve: Valve, state: Array, command: float) -> float:
    """Where the actuator is sent, by the rules that look at the command once in a row; else the command itself."""
    if valve.rule == STENMAN:
        state[HELD] = stenman(command, state[HELD], valve.size)
    elif valve.rule == CHOUDHURY:
        state[HELD] = choudhury(state, command, valve.size, valve.jump)
    elif valve.rule == HE:
        state[HELD] = he(state, command, valve.static, valve.kinetic)
    else:
        return command
    return state[HELD]


@njit
def move_stem(valve: Valve, state: Array, target: float, approach: float, step: float) -> float:
    """One fine step; `approach`: share of its way that the actuator goes in it."""
    state[POSITION] += approach * (target - state[POSITION])
    position = stem = state[POSITION]
    if valve.rule == BACKLASH:
        stem = backlash(position, state[STEM], valve.size)
    elif valve.rule == DEAD_ZONE:
        stem = dead_zone(position, valve.rest, valve.size)
    elif valve.rule == KARNOPP:
        stem, state[SPEED] = karnopp(valve, position, state[STEM], state[SPEED], step)
    stem = min(max(stem, 0.0), FULL_STROKE)
    state[TRAVEL] += abs(stem - state[STEM])
    state[STEM] = stem
    return stem


@njit
def flow_through(valve: Valve, stem: float) -> float:
    """Flow above that at rest, %; the slope is 1 there."""
    away = stem - valve.rest
    return (math.exp(valve.curvature * away) - 1.0) / valve.curvature if valve.curvature > 0 else away
