"""Valves with one fault each, in fine steps of time. Output, command and stem in %, times in rows of the record.

S, the size, is how far a command has to turn until the stem follows, and J, the jump, how far it slips then. A stem
that stands lets go where the command is the static band, (S + J) / 2, away from it, and slides (S - J) / 2 behind.

Sources: Stenman et al. 2003 (J = S) and He et al. 2007: the stem sticks anew after each move. Choudhury et al. 2005 and
Kano et al. 2004: it slides on until the command stands or turns, looked at when the controller scans. Karnopp 1985: a
mass that friction holds at rest.

Compiled anew in each process: Numba's cache keeps the name by which a module was imported, and this one has two.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

Array = np.ndarray

FINE_STEPS = 20  # in a row
FINE_STEP = 1.0 / FINE_STEPS  # rows
SOUND, BACKLASH, HE, CHOUDHURY, KANO, KARNOPP, DEAD_ZONE, SATURATION = range(8)  # rule of the valve
COMMAND, HELD, LAGGING, STEM, SPEED, COMMAND_BEFORE, TURNED_AT, WAY, SLIDES, STATES = range(10)  # of its state

MASS, DAMPING = 0.00125, 0.1  # row^2 and rows, over the spring: overdamped, at rest again well within a row
AT_REST = 0.05  # %/row: a slower mass stands
FRICTION_STEPS = 20  # of the mass in a fine step


class Valve(NamedTuple):
    """Fault, actuator and characteristic.

    `size`: S, a value for each row; `jump_share`: J / S. Of He's rule, as shares of S, upward and downward: how far the
    command is away where the stem lets go, and how far after it has slipped.
    """

    rule: int
    size: Array
    jump_share: float
    stick_up: float
    slide_up: float
    stick_down: float
    slide_down: float
    middle: float  # of the dead zone
    lowest: float  # end of the stroke
    highest: float
    positioner_band: float  # changes of OP within it are not passed on
    lag: float
    rate_limit: float  # %/row; 0: none
    rangeability: float  # of an equal-percentage characteristic; 0: linear


@njit
def approach(value: float, target: float, lag: float, step: float) -> float:
    """First-order lag after a step of time."""
    return value + (target - value) * (1 - math.exp(-step / lag)) if lag > 0 else target


@njit
def backlash(command: float, stem: float, size: float) -> float:
    """Pushed by either flank."""
    if command - stem > size / 2:
        return command - size / 2
    return command + size / 2 if stem - command > size / 2 else stem


@njit
def he(command: float, stem: float, size: float, shares: tuple[float, float, float, float]) -> float:
    """Sticks anew after each move."""
    stick_up, slide_up, stick_down, slide_down = shares
    if command - stem > stick_up * size:
        return command - slide_up * size
    return command + slide_down * size if stem - command > stick_down * size else stem


@njit
def choudhury(
    command: float, before: float, stem: float, way: float, slides: bool, size: float, jump: float
) -> tuple[float, float, bool]:
    """Stem, way (1, -1) and whether it slides; `before`: the command at the scan before."""
    slide_band = (size - jump) / 2
    moved = np.sign(command - before)
    if moved != way:
        slides = False
        if moved != 0.0:
            way = moved
    if slides:
        return command - way * slide_band, way, True
    if command - stem > slide_band + jump:
        return command - slide_band, 1.0, True
    if stem - command > slide_band + jump:
        return command + slide_band, -1.0, True
    return stem, way, False


@njit
def kano(
    command: float, before: float, stem: float, way: float, slides: bool, turned_at: float, size: float, jump: float
) -> tuple[float, float, bool, float]:
    """As `choudhury`, with the command at which the stem stopped, from which its bands are counted."""
    moved = command - before
    if slides and (moved * way < 0 or moved == 0):
        slides, turned_at = False, before
    if not slides:
        if way == 0.0:
            if abs(command - turned_at) > size / 2 + jump / 2:
                way, slides = 1.0 if command > turned_at else -1.0, True
        elif way * (turned_at - command) > size:
            way, slides = -way, True
        elif way * (command - turned_at) > jump:
            slides = True
    return (command - way * (size - jump) / 2 if slides else stem), way, slides, turned_at


@njit
def karnopp(command: float, stem: float, speed: float, size: float, jump: float) -> tuple[float, float]:
    """Stem and speed of a mass on a spring after a fine step; forces over the spring, in %; damping implicit."""
    static_band, sliding_band = (size + jump) / 2, (size - jump) / 2
    step = FINE_STEP / FRICTION_STEPS
    for _ in range(FRICTION_STEPS):
        force = command - stem
        if abs(speed) < AT_REST and abs(force) <= static_band:
            speed = 0.0
            continue
        friction = sliding_band * (np.sign(speed) if abs(speed) >= AT_REST else np.sign(force))
        new_speed = (speed + step / MASS * (force - friction)) / (1 + step * DAMPING / MASS)
        speed = 0.0 if speed != 0 and new_speed * speed < 0 else new_speed
        stem += step * speed
    return stem, speed


@njit
def dead_zone(command: float, middle: float, size: float) -> float:
    """Nothing moves inside the zone; its width is lost."""
    if command > middle + size / 2:
        return command - size / 2
    return command + size / 2 if command < middle - size / 2 else middle


@njit
def held_at_scan(valve: Valve, state: Array, command: float, size: float) -> None:
    """Choudhury's and Kano's rules, which look at the command when it is given."""
    before, held, way, slides = state[COMMAND_BEFORE], state[HELD], state[WAY], state[SLIDES] > 0
    jump = valve.jump_share * size
    if valve.rule == CHOUDHURY:
        held, way, slides = choudhury(command, before, held, way, slides, size, jump)
    else:
        turned_at = state[TURNED_AT]
        held, way, slides, state[TURNED_AT] = kano(command, before, held, way, slides, turned_at, size, jump)
    state[HELD], state[WAY], state[SLIDES] = held, way, 1.0 if slides else 0.0
    state[COMMAND_BEFORE] = command


@njit
def held_between_scans(valve: Valve, state: Array, command: float, size: float) -> None:
    """All other rules."""
    held = state[HELD]
    if valve.rule == SOUND:
        held = command
    elif valve.rule == BACKLASH:
        held = backlash(command, held, size)
    elif valve.rule == HE:
        held = he(command, held, size, (valve.stick_up, valve.slide_up, valve.stick_down, valve.slide_down))
    elif valve.rule == KARNOPP:
        held, state[SPEED] = karnopp(command, held, state[SPEED], size, valve.jump_share * size)
    elif valve.rule == DEAD_ZONE:
        held = dead_zone(command, valve.middle, size)
    else:
        held = min(max(command, valve.lowest), valve.highest)
    state[HELD] = held


@njit
def valve_at(place: float) -> Array:
    """State of a valve at rest."""
    state = np.zeros(STATES)
    for k in (COMMAND, HELD, LAGGING, STEM, COMMAND_BEFORE, TURNED_AT):
        state[k] = place
    return state


@njit
def move_valve(valve: Valve, state: Array, output: float, row: int, scanned: bool) -> None:
    """One fine step in which the controller gave this output."""
    band = valve.positioner_band
    if output > state[COMMAND] + band or output < state[COMMAND] - band:
        state[COMMAND] = output
    command, size = state[COMMAND], valve.size[row]
    if valve.rule in (CHOUDHURY, KANO):
        if scanned:
            held_at_scan(valve, state, command, size)
    else:
        held_between_scans(valve, state, command, size)
    state[LAGGING] = approach(state[LAGGING], state[HELD], valve.lag, FINE_STEP)
    if valve.rate_limit > 0:
        furthest = valve.rate_limit * FINE_STEP
        state[STEM] += min(max(state[LAGGING] - state[STEM], -furthest), furthest)
    else:
        state[STEM] = state[LAGGING]


@njit
def flow_through(valve: Valve, stem: float) -> float:
    """Flow above that at 50 %, where the slope is 1."""
    away = stem - 50.0
    if valve.rangeability > 1:
        return (valve.rangeability ** (away / 100.0) - 1.0) * 100.0 / math.log(valve.rangeability)
    return away
