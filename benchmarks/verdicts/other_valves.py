"""A control loop in fine steps of time: controller, actuator with its fault, process, transmitter.

Nothing of the package is in it. OP, travel and PV in %; times in rows of the record, friction's own in seconds. The
controller scans once in `fine_steps` steps; between scans the valve moves and the process answers.

Sources: He et al. 2007 and Choudhury et al. 2005 for the rules of sticking valves and for the mass of a stem, Karnopp
1985 for a mass that friction holds at rest.

Compiled anew in each process: Numba's cache keeps the name by which a module was imported, and this one has two.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

Array = np.ndarray

SOUND, BACKLASH, HE, CHOUDHURY, KARNOPP, DEAD_ZONE = range(6)  # rule of the valve
PLACE, HELD, SPEED, AIR, SUPPLY, WAY, BEFORE, STATES = range(8)  # of its state

FRICTION_STEP = 5e-4  # s: the stem's mass moves within milliseconds
MASS, DAMPING = 2.6e-5, 0.0117  # s^2 and s, over the spring: 3 lb, 3.5 lbf s/in, 300 lbf/in (Choudhury et al.)
SMALLEST_MOVE = 1e-9  # %: a command that moves less stands
SUPPLY_RANGE = (-30.0, 130.0)  # %: pressure that a positioner can give


class Signals(NamedTuple):
    """What comes from outside, a value for each scan."""

    set_point: Array
    load: Array  # adds to the flow through the valve
    drift: Array  # adds to PV
    noise: Array  # of the transmitter
    manual: Array  # whether the operator has the valve
    manual_output: Array
    feedforward: Array  # adds to OP


class Clock(NamedTuple):
    """Steps of time."""

    fine_step: float  # rows
    fine_steps: int  # in a scan
    seconds: float  # in a row


class ProcessModel(NamedTuple):
    """Two lags and a dead time; `integrating` puts an integral in place of the first lag."""

    gain: float
    lag: float
    second_lag: float
    dead_time: float
    integrating: bool


class Controller(NamedTuple):
    """PID, derivative of PV with a filter; integral clamped at the limits."""

    gain: float
    integral_gain: float  # 1/row
    derivative_gain: float  # rows
    derivative_filter: float  # rows
    dead_band: float  # of the error that it does not see
    lowest: float
    highest: float
    output_step: float  # of the signal to the valve; 0: none


class Transmitter(NamedTuple):
    """Its filter and its resolution."""

    filter_lag: float
    step: float


class Valve(NamedTuple):
    """Fault, actuator and characteristic.

    `stick` is the distance to the command at which the valve lets go, `slide` what is left of it then, upward and
    downward. They grow from `growth_from` to `growth_to` of these over the record, or halfway at once.
    """

    rule: int
    stick_up: float
    slide_up: float
    stick_down: float
    slide_down: float
    zone_low: float
    zone_high: float
    growth_from: float
    growth_to: float
    sudden: bool
    lag: float
    rate_limit: float  # %/row; 0: none
    positioner_gain: float  # 1/row; 0: none
    equal_percentage: bool
    rangeability: float


@njit
def approach(value: float, target: float, lag: float, step: float) -> float:
    """First-order lag after a step of time."""
    return value + (target - value) * (1 - np.exp(-step / lag)) if lag > 0 else target


@njit
def backlash(command: float, place: float, half: float) -> float:
    """Pushed by either flank."""
    if command - place > half:
        return command - half
    return command + half if command - place < -half else place


@njit
def he(command: float, place: float, friction: tuple[float, float, float, float]) -> float:
    """Sticks anew after each move."""
    stick_up, slide_up, stick_down, slide_down = friction
    if command - place > stick_up:
        return command - slide_up
    return command + slide_down if command - place < -stick_down else place


@njit
def choudhury(
    command: float, before: float, place: float, way: float, friction: tuple[float, float, float, float]
) -> tuple[float, float]:
    """Slides on behind the command until that stands or turns; place and way (1, -1, 0 at rest)."""
    stick_up, slide_up, stick_down, slide_down = friction
    moved = command - before
    if way > 0 and moved > SMALLEST_MOVE:
        return max(place, command - slide_up), way
    if way < 0 and moved < -SMALLEST_MOVE:
        return min(place, command + slide_down), way
    if command - place > stick_up:
        return command - slide_up, 1.0
    if command - place < -stick_down:
        return command + slide_down, -1.0
    return place, 0.0


@njit
def dead_zone(command: float, low: float, high: float) -> float:
    """Nothing moves inside the zone; its width is lost."""
    middle = 0.5 * (low + high)
    if command > high:
        return middle + command - high
    return middle + command - low if command < low else middle


@njit
def mass_under_friction(
    air: float,
    new_air: float,
    place: float,
    speed: float,
    friction: tuple[float, float, float, float],
    seconds: float,
) -> tuple[float, float]:
    """Place and speed of the stem after the air went from one pressure to another: Karnopp, damping implicit."""
    stick_up, slide_up, stick_down, slide_down = friction
    steps = int(seconds / FRICTION_STEP) + 1
    step = seconds / steps
    for k in range(steps):
        net = air + (new_air - air) * (k + 1) / steps - place
        if speed == 0.0:
            if -stick_down <= net <= stick_up:
                continue
            speed = _speed_after(speed, net - slide_up if net > stick_up else net + slide_down, step)
            place += speed * step
        else:
            new_speed = _speed_after(speed, net - (slide_up if speed > 0 else -slide_down), step)
            speed = new_speed if new_speed * speed > 0 else 0.0
            place += speed * step
    return place, speed


@njit
def _speed_after(speed: float, force: float, step: float) -> float:
    return (speed + step * force / MASS) / (1 + step * DAMPING / MASS)


@njit
def friction_now(valve: Valve, share_of_record: float) -> tuple[float, float, float, float]:
    """Stick and slide upward, stick and slide downward, at this part of the record."""
    grown = share_of_record
    if valve.sudden:
        grown = 1.0 if share_of_record > 0.5 else 0.0
    scale = valve.growth_from + (valve.growth_to - valve.growth_from) * grown
    return valve.stick_up * scale, valve.slide_up * scale, valve.stick_down * scale, valve.slide_down * scale


@njit
def move_valve(
    valve: Valve,
    friction: tuple[float, float, float, float],
    state: Array,
    command: float,
    scanned: bool,
    clock: Clock,
) -> None:
    """One fine step of the valve; the rules without a mass look at the command when it is `scanned`."""
    step = clock.fine_step
    if valve.rule == KARNOPP:
        if valve.positioner_gain > 0:
            supply = state[SUPPLY] + step * valve.positioner_gain * (command - state[PLACE])
            state[SUPPLY] = min(max(supply, SUPPLY_RANGE[0]), SUPPLY_RANGE[1])
            air = state[SUPPLY]
        else:
            air = approach(state[AIR], command, valve.lag, step)
        state[PLACE], state[SPEED] = mass_under_friction(
            state[AIR], air, state[PLACE], state[SPEED], friction, step * clock.seconds
        )
        state[AIR] = air
        return
    if valve.rule == SOUND:
        state[HELD] = command
    elif valve.rule == DEAD_ZONE:
        state[HELD] = dead_zone(command, valve.zone_low, valve.zone_high)
    elif scanned:
        hold(valve, friction, state, command)
    away = approach(state[PLACE], state[HELD], valve.lag, step) - state[PLACE]
    if valve.rate_limit > 0 and abs(away) > valve.rate_limit * step:
        away = valve.rate_limit * step * np.sign(away)
    state[PLACE] += away


@njit
def hold(valve: Valve, friction: tuple[float, float, float, float], state: Array, command: float) -> None:
    """Where a valve with a memory goes at a new command."""
    if valve.rule == BACKLASH:
        state[HELD] = backlash(command, state[HELD], friction[0])
    elif valve.rule == HE:
        state[HELD] = he(command, state[HELD], friction)
    else:
        state[HELD], state[WAY] = choudhury(command, state[BEFORE], state[HELD], state[WAY], friction)
    state[BEFORE] = command


@njit
def flow_through(valve: Valve, place: float, rest: float) -> float:
    """Flow above that at rest; the slope at rest is 1 for either characteristic."""
    travel = min(max(place, 0.0), 100.0)
    if not valve.equal_percentage:
        return travel - rest
    at_rest = 100.0 * valve.rangeability ** (rest / 100.0 - 1)
    slope = at_rest * np.log(valve.rangeability) / 100.0
    return (100.0 * valve.rangeability ** (travel / 100.0 - 1) - at_rest) / slope


@njit
def controller_output(
    controller: Controller, error: float, integral: float, derivative: float, scan: float
) -> tuple[float, float]:
    """Output and integral after a scan; at a limit the integral does not go further outward."""
    new_integral = integral + controller.integral_gain * scan * error
    output = controller.gain * error + new_integral + controller.derivative_gain * derivative
    outward = controller.integral_gain * error
    if output > controller.highest:
        if outward > 0:
            new_integral = min(new_integral, max(integral, controller.highest - controller.gain * error))
        return controller.highest, new_integral
    if output < controller.lowest:
        if outward < 0:
            new_integral = max(new_integral, min(integral, controller.lowest - controller.gain * error))
        return controller.lowest, new_integral
    return output, new_integral


@njit
def to_step(value: float, step: float) -> float:
    """Value with the resolution of a converter; 0: none."""
    return np.round(value / step) * step if step > 0 else value


@njit
def closed_loop(
    signals: Signals,
    clock: Clock,
    process: ProcessModel,
    controller: Controller,
    transmitter: Transmitter,
    valve: Valve,
    rest: float,
) -> tuple[Array, Array, Array]:
    """OP, PV and place of the valve at each scan; it starts at rest with OP at `rest` and PV at the set point."""
    scans, scan, step = signals.set_point.size, clock.fine_steps * clock.fine_step, clock.fine_step
    op, pv, place = np.zeros(scans), np.zeros(scans), np.zeros(scans)
    in_pipe, pipe_end = np.zeros(int(process.dead_time / step) + 1), 0
    state = np.zeros(STATES)
    for k in (PLACE, HELD, AIR, SUPPLY, BEFORE):
        state[k] = rest
    start = signals.set_point[0]
    first = second = derivative = 0.0
    filtered = last = start
    integral = rest
    for k in range(scans):
        pv[k] = to_step(filtered + signals.noise[k], transmitter.step)
        error = signals.set_point[k] - pv[k]
        if abs(error) < controller.dead_band:
            error = 0.0
        slope = -(pv[k] - last) / scan
        derivative = derivative + (scan / (controller.derivative_filter + scan)) * (slope - derivative)
        last = pv[k]
        if signals.manual[k]:
            output = signals.manual_output[k]
            integral = output - controller.gain * error
        else:
            output, integral = controller_output(controller, error, integral, derivative, scan)
        op[k] = to_step(output + signals.feedforward[k], controller.output_step)
        friction = friction_now(valve, k / scans)
        for fine in range(clock.fine_steps):
            move_valve(valve, friction, state, op[k], fine == 0, clock)
            in_pipe[pipe_end] = flow_through(valve, state[PLACE], rest) + signals.load[k]
            pipe_end = (pipe_end + 1) % in_pipe.size
            arrived = process.gain * in_pipe[pipe_end]
            first = first + step * arrived if process.integrating else approach(first, arrived, process.lag, step)
            second = approach(second, first, process.second_lag, step)
            filtered = approach(filtered, start + second + signals.drift[k], transmitter.filter_lag, step)
        place[k] = state[PLACE]
    return op, pv, place
