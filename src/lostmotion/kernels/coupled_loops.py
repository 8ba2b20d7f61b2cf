"""Control loops that disturb each other, one row at a time: actuators, processes, sensors, PI controllers, modes.

All signals are in % of span. Row k: what happens at k (`events`), what the sensors say, what the controllers make of
it, where the valves go, what the processes do until k + 1. Arrays of a plant with n loops and m connections:

loops (n, COLUMNS)
    Numbers of each loop, by the constants below. Lags are shares that a row makes up: 1 - exp(-dt / time constant).
wires (m, 4), weights (m, 2)
    From, to, what (PV or FLOW), delay in rows; gain and lag. A connection adds to the load of the loop it leads to.
events (e, 4)
    Row, loop, code, value; by row.
load, noise (rows, n)
    In units of OP, and of PV; NaN in the noise: the sensor is frozen in that row.
state (n, STATES), actuators (n, 6), history (2, n, length), lagged (m,)
    Carried from one call to the next; `history` is longer than every delay.
"""

from __future__ import annotations

import math

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels import actuator
from lostmotion.kernels.loop import pi_step
from lostmotion.kernels.numba_cache import njit

KIND, FIRST, STROKE, CURVE, GAIN, LAG1, LAG2, RATE, DELAY = 0, 1, 5, 6, 7, 8, 9, 10, 11
SENSOR, FILTER, KP, KI = 12, 13, 14, 15
SCAN, MASTER, RATIO, OP_REST, PV_REST, TRACKS, LOW, HIGH, COLUMNS = 16, 17, 18, 19, 20, 21, 22, 23, 24
Z1, Z2, STEM, SENSED, FILTERED, INTEGRAL, OP, SP, PV_SEEN, MODE, STATES = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10
PV, FLOW = 0, 1
SET_SP, SET_MODE, SET_OP = 0, 1, 2  # codes of events
MANUAL, AUTO, CASCADE = 0, 1, 2
LEAST, MOST = -1.25, 103.125  # % of span: 3.8 and 20.5 mA


@njit()
def measure(loop: FloatArray, state: FloatArray, noise: float) -> None:
    """What the sensor says; a frozen one (NaN) says what it said."""
    state[SENSED] += loop[SENSOR] * (loop[PV_REST] + state[Z2] - state[SENSED])
    if not math.isnan(noise):
        state[PV_SEEN] = min(max(state[SENSED] + noise, LEAST), MOST)
    state[FILTERED] += loop[FILTER] * (state[PV_SEEN] - state[FILTERED])


@njit()
def control(loop: FloatArray, state: FloatArray, every: FloatArray, loops: FloatArray, row: int) -> None:
    """Output of the controller. In manual it stands, and the integral follows, so that the way back has no bump."""
    if state[MODE] == MANUAL and loop[TRACKS] == 1.0:
        state[SP] = state[FILTERED]
    if state[MODE] == CASCADE:
        master = int(loop[MASTER])
        sp = loop[PV_REST] + loop[RATIO] * (every[master, OP] - loops[master, OP_REST])
        state[SP] = min(max(sp, 0.0), 100.0)
    error = state[SP] - state[FILTERED]
    if state[MODE] == MANUAL:
        state[INTEGRAL] = state[OP] - loop[KP] * error
    elif row % int(loop[SCAN]) == 0:
        state[OP], state[INTEGRAL] = pi_step(error, state[INTEGRAL], loop[KP], loop[KI], loop[LOW], loop[HIGH])


@njit()
def follow(loops: FloatArray, state: FloatArray) -> None:
    """A master whose slave does not listen: its output is what the slave is at, as if it had asked for it."""
    for i in range(loops.shape[0]):
        master = int(loops[i, MASTER])
        if master >= 0 and state[i, MODE] != CASCADE:
            there = state[i, SP] if state[i, MODE] == AUTO else state[i, FILTERED]
            op = loops[master, OP_REST] + (there - loops[i, PV_REST]) / loops[i, RATIO]
            state[master, OP] = min(max(op, loops[master, LOW]), loops[master, HIGH])
            error = state[master, SP] - state[master, FILTERED]
            state[master, INTEGRAL] = state[master, OP] - loops[master, KP] * error


@njit()
def valve(loop: FloatArray, state: FloatArray, memory: FloatArray) -> float:
    """Position of the actuator; `state` gets that of the stem, which follows it."""
    moved = loop[OP_REST] + actuator.step(
        int(loop[KIND]), loop[FIRST : FIRST + 4], memory, state[OP] - loop[OP_REST]
    )  # fmt: skip
    position = min(max(moved, 0.0), 100.0)
    state[STEM] += loop[STROKE] * (position - state[STEM])
    return float(position)


@njit()
def process(loop: FloatArray, state: FloatArray, flow: float, load: float) -> None:
    """Two lags, or a lag and a tank that is neither emptier than empty nor fuller than full."""
    state[Z1] += loop[LAG1] * (loop[GAIN] * (flow + load) - state[Z1])
    if loop[RATE] > 0.0:
        filled = loop[PV_REST] + state[Z2] + loop[RATE] * state[Z1]
        state[Z2] = min(max(filled, 0.0), 100.0) - loop[PV_REST]
    else:
        state[Z2] += loop[LAG2] * (state[Z1] - state[Z2])


@njit()
def act(events: FloatArray, at: int, row: int, state: FloatArray) -> int:
    """What the operators do in this row; place of the first event of a later one."""
    while at < events.shape[0] and events[at, 0] <= row:
        i, code, value = int(events[at, 1]), int(events[at, 2]), events[at, 3]
        if code == SET_SP:
            state[i, SP] = value
        elif code == SET_MODE:
            state[i, MODE] = value
        elif state[i, MODE] == MANUAL:
            state[i, OP] = min(max(value, 0.0), 100.0)
        at += 1
    return at


@njit()
def start(loops: FloatArray, state: FloatArray, actuators: FloatArray) -> None:
    """Every loop at rest in automatic, slaves in cascade."""
    for i in range(loops.shape[0]):
        state[i, :] = 0.0
        state[i, STEM] = state[i, INTEGRAL] = state[i, OP] = loops[i, OP_REST]
        state[i, SENSED] = state[i, FILTERED] = state[i, SP] = state[i, PV_SEEN] = loops[i, PV_REST]
        state[i, MODE] = CASCADE if loops[i, MASTER] >= 0.0 else AUTO
        actuators[i, :] = actuator.init(0.0)


@njit()
def run(
    begin: int,
    loops: FloatArray,
    wires: IntArray,
    weights: FloatArray,
    events: FloatArray,
    load: FloatArray,
    noise: FloatArray,
    state: FloatArray,
    actuators: FloatArray,
    history: FloatArray,
    lagged: FloatArray,
    record: FloatArray,
) -> None:
    """Rows begin, begin + 1, ..; `record` (5, rows, n) gets OP, PV, SP, position and mode of each."""
    n, length = loops.shape[0], history.shape[2]
    coming = np.zeros(n)
    at = 0
    for k in range(load.shape[0]):
        row = begin + k
        at = act(events, at, row, state)
        for i in range(n):
            measure(loops[i], state[i], noise[k, i])
        follow(loops, state)
        coming[:] = load[k]
        for j in range(wires.shape[0]):
            source, target, what, delay = wires[j, 0], wires[j, 1], wires[j, 2], wires[j, 3]
            lagged[j] += weights[j, 1] * (history[what, source, (row - delay) % length] - lagged[j])
            coming[target] += weights[j, 0] * lagged[j]
        for i in range(n):
            loop, own = loops[i], state[i]
            control(loop, own, state, loops, row)
            record[3, k, i] = valve(loop, own, actuators[i])
            record[0, k, i], record[1, k, i], record[2, k, i] = own[OP], own[PV_SEEN], own[SP]
            record[4, k, i] = own[MODE]
            away = own[STEM] - loop[OP_REST]
            here = row % length
            history[FLOW, i, here] = away + loop[CURVE] * away * away / 100.0
            process(loop, own, history[FLOW, i, (row - int(loop[DELAY])) % length], coming[i])
        for i in range(n):
            history[PV, i, row % length] = state[i, Z2]
