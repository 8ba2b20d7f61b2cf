"""The loop in fine steps of time: controller, valve, process, transmitter. Nothing of the package is in it.

OP, PV and load in %, times in rows of the record. The controller scans once in `scan` fine steps; between scans the
valve moves and the process answers.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from one_ingredient.valves import (
    FINE_STEP,
    FINE_STEPS,
    STEM,
    Array,
    Valve,
    approach,
    flow_through,
    move_valve,
    valve_at,
)

LOWEST, HIGHEST = 0.0, 100.0  # OP
LAGS, INTEGRATING, UNDERDAMPED = range(3)  # kinds of process
OUTPUT, INTEGRAL, FILTERED, ERROR, FALL, FED_FORWARD, CONTROLLER_STATES = range(7)
FIRST, SECOND, SLOPE, PROCESS_STATES = range(4)


class Signals(NamedTuple):
    """What comes from outside."""

    set_point: Array  # a value for each row
    manual: Array  # whether the operator has the valve, for each row
    manual_output: Array  # OP that he gives, for each row; NaN: he leaves it
    load: Array  # adds to the flow through the valve, for each fine step
    noise: Array  # of the transmitter, for each measurement: one in a scan, at least one in a row


class Controller(NamedTuple):
    """PID with derivative of PV, in velocity or in position form."""

    gain: float
    reset: float  # rows; 0: no integral
    derivative: float  # rows
    filter_lag: float  # of PV as the controller sees it, rows
    gap: float  # of the error that it does not see
    feedforward: float  # OP for a load of 1 %
    velocity_form: bool
    scan: int  # fine steps
    rest: float  # OP at rest


class Process(NamedTuple):
    """Two lags, of which the second may be 0; an integral and a lag; or an underdamped second order."""

    kind: int
    gain: float  # of the integral: %/row for each %
    lag: float
    second_lag: float
    damping: float
    lead: float  # of the zero in the right half-plane
    dead_steps: int  # dead time in fine steps
    curvature: float  # of the gain, 1/%


@njit
def seen_error(controller: Controller, set_point: float, measured: float) -> float:
    """Error outside the gap."""
    error = set_point - measured
    if controller.gap > 0:
        return max(error - controller.gap, 0.0) + min(error + controller.gap, 0.0)
    return error


@njit
def controller_at_rest(controller: Controller, set_point: float, measured: float, load: float) -> Array:
    """State before the first scan."""
    state = np.zeros(CONTROLLER_STATES)
    state[OUTPUT], state[FILTERED] = controller.rest, measured
    state[ERROR], state[FED_FORWARD] = seen_error(controller, set_point, measured), controller.feedforward * load
    return state


@njit
def position_form(controller: Controller, state: Array, error: float, rise: float, forward: float) -> float:
    """Output; what drives it beyond a limit does not go into the integral. `rise`: of PV since the last scan."""
    interval = controller.scan * FINE_STEP
    reset = controller.gain * interval / controller.reset * error if controller.reset > 0 else 0.0
    integral = state[INTEGRAL] + reset
    braking = controller.gain * controller.derivative * rise / interval
    output = controller.rest + controller.gain * error + integral + forward - braking
    if output > HIGHEST:
        integral -= max(0.0, min(output - HIGHEST, reset))
    elif output < LOWEST:
        integral += max(0.0, min(LOWEST - output, -reset))
    state[INTEGRAL] = integral
    return min(max(output, LOWEST), HIGHEST)


@njit
def velocity_form(controller: Controller, state: Array, error: float, rise: float, forward: float) -> float:
    """Output, from the one before."""
    interval = controller.scan * FINE_STEP
    reset = controller.gain * interval / controller.reset * error
    move = controller.gain * (error - state[ERROR]) + reset + forward - state[FED_FORWARD]
    move += controller.gain * controller.derivative / interval * (-rise - state[FALL])
    state[FALL], state[FED_FORWARD] = -rise, forward
    return min(max(state[OUTPUT] + move, LOWEST), HIGHEST)


@njit
def scan_controller(
    controller: Controller, state: Array, signals: Signals, measured: float, row: int, load: float
) -> None:
    """One scan; in manual the integral follows, so that automatic begins where the operator left."""
    before = state[FILTERED]
    state[FILTERED] = approach(before, measured, controller.filter_lag, controller.scan * FINE_STEP)
    error = seen_error(controller, signals.set_point[row], state[FILTERED])
    forward, rise = controller.feedforward * load, state[FILTERED] - before
    if signals.manual[row]:
        wanted = signals.manual_output[row]
        output = min(max(state[OUTPUT] if np.isnan(wanted) else wanted, LOWEST), HIGHEST)
        state[INTEGRAL] = output - controller.rest - controller.gain * error - forward
    elif controller.velocity_form:
        output = velocity_form(controller, state, error, rise, forward)
    else:
        output = position_form(controller, state, error, rise, forward)
    state[OUTPUT], state[ERROR] = output, error


@njit
def respond(process: Process, state: Array, inflow: float) -> float:
    """PV above where it began, after a fine step."""
    inflow += process.curvature * inflow * inflow
    if process.kind == INTEGRATING:
        state[FIRST] += process.gain * inflow * FINE_STEP
        state[SECOND] = approach(state[SECOND], state[FIRST], process.second_lag, FINE_STEP)
        return state[SECOND]
    if process.kind == UNDERDAMPED:
        pull = process.gain * inflow - state[FIRST] - 2 * process.damping * process.lag * state[SLOPE]
        state[SLOPE] += FINE_STEP * pull / (process.lag * process.lag)
        state[FIRST] += FINE_STEP * state[SLOPE]
        return state[FIRST]
    state[FIRST] = approach(state[FIRST], process.gain * inflow, process.lag, FINE_STEP)
    if process.second_lag == 0:
        return state[FIRST]
    moved = approach(0.0, state[FIRST] - state[SECOND], process.second_lag, FINE_STEP)
    state[SECOND] += moved
    return state[SECOND] - process.lead * moved / FINE_STEP


@njit
def closed_loop(
    signals: Signals, controller: Controller, valve: Valve, process: Process, transmitter_lag: float
) -> tuple[Array, Array, Array, Array]:
    """OP and PV at the beginning of each row, and their means over each row; the loop starts at rest."""
    rows, start = signals.set_point.size, signals.set_point[0]
    op, pv, mean_op, mean_pv = np.zeros(rows), np.zeros(rows), np.zeros(rows), np.zeros(rows)
    measured_every = min(controller.scan, FINE_STEPS)
    measured, response = start + signals.noise[0], 0.0
    of_controller = controller_at_rest(controller, start, measured, signals.load[0])
    of_valve, of_process = valve_at(controller.rest), np.zeros(PROCESS_STATES)
    pipe = np.full(process.dead_steps + 1, controller.rest - 50.0)
    for step in range(rows * FINE_STEPS):
        row, scanned, load = step // FINE_STEPS, step % controller.scan == 0, signals.load[step]
        if step % measured_every == 0:
            now = start + response + signals.noise[step // measured_every]
            measured = approach(measured, now, transmitter_lag, measured_every * FINE_STEP)
        if scanned:
            scan_controller(controller, of_controller, signals, measured, row, load)
        move_valve(valve, of_valve, of_controller[OUTPUT], row, scanned)
        pipe[step % pipe.size] = flow_through(valve, of_valve[STEM])
        response = respond(process, of_process, pipe[(step + 1) % pipe.size] + load)
        if step % FINE_STEPS == 0:
            op[row], pv[row] = of_controller[OUTPUT], measured
        mean_op[row] += of_controller[OUTPUT]
        mean_pv[row] += measured
    return op, pv, mean_op / FINE_STEPS, mean_pv / FINE_STEPS
