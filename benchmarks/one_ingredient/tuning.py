"""Controllers tuned as the field does: lambda, SIMC (Skogestad 2003), or from the ultimate gain."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from one_ingredient.controller_and_process import INTEGRATING, UNDERDAMPED
from one_ingredient.draw import Case
from one_ingredient.valves import FINE_STEP, Array

Response = Callable[[Array], Array]  # of the process to exp(s t), at complex s in 1/row

FREQUENCIES = np.logspace(-3.5, 1.2, 6000)  # rad/row
LEAST_MARGIN, MARGIN_THEN = 2.0, 2.2  # a gain that leaves less of it is lowered
DERIVATIVE_OVER_FILTER = 4.0


class Tuning(NamedTuple):
    """Parameters of the controller, and of what they were made for."""

    gain: float
    reset: float  # rows
    derivative: float
    derivative_filter: float
    process_gain: float  # of an integrating process: %/row for each %
    ultimate_period: float  # at which the loop would ring, rows


def response_of(case: Case, process_gain: float) -> Response:
    """Valve, process, transmitter and half a scan."""
    delay = case.dead_time + case.scan * FINE_STEP / 2

    def process(s: Array) -> Array:
        if case.process == UNDERDAMPED:
            return process_gain / (case.lag * case.lag * s * s + 2 * case.damping * case.lag * s + 1)
        if case.process == INTEGRATING:
            return process_gain / s / (case.second_lag * s + 1)
        return process_gain * (1 - case.lead * s) / ((case.lag * s + 1) * (case.second_lag * s + 1))

    def response(s: Array) -> Array:
        return process(s) * np.exp(-s * delay) / (case.actuator_lag * s + 1) / (case.transmitter_lag * s + 1)

    return response


def margin(gain: float, reset: float, response: Response) -> tuple[float, float]:
    """Gain margin of the loop, and the frequency in rad/row at which it would ring."""
    s = 1j * FREQUENCIES
    open_loop = (1 + (1 / (s * reset) if reset > 0 else 0)) * response(s)
    phase = np.unwrap(np.angle(open_loop))
    crossings = np.flatnonzero((phase[:-1] > -np.pi) & (phase[1:] <= -np.pi))
    if crossings.size == 0:
        return np.inf, float(FREQUENCIES[-1])
    sizes = np.abs(open_loop[crossings])
    return 1 / (sizes.max() * gain), FREQUENCIES[crossings[sizes.argmax()]]


def tuned(case: Case) -> Tuning:
    """Controller for the case."""
    process_gain = case.gain / case.lag if case.process == INTEGRATING else case.gain
    response = response_of(case, process_gain)
    gain, reset = _by_rule(case, process_gain, response)
    gain, reset = gain / case.slower, reset * case.slower_reset
    left = margin(gain, reset, response)[0]
    if case.gain_margin > 0:
        gain *= left / case.gain_margin
    elif left < LEAST_MARGIN:
        gain *= left / MARGIN_THEN
    derivative = 0.25 * reset * case.derivative_share
    if derivative > 0:
        gain *= 0.9
    if case.level_gain > 0:
        gain, reset, process_gain = case.level_gain, 0.0, 1 / (case.level_gain * case.level_lag)
    period = 2 * np.pi / margin(gain, reset, response)[1]
    return Tuning(gain, reset, derivative, derivative / DERIVATIVE_OVER_FILTER, process_gain, period)


def _by_rule(case: Case, process_gain: float, response: Response) -> tuple[float, float]:
    """Gain and reset time."""
    delay = case.dead_time + case.scan * FINE_STEP / 2
    if case.process == UNDERDAMPED:  # the zero of the controller in the middle of the poles
        reset = max(2 * case.damping * case.lag, 0.5)
        return reset / process_gain / (3 * case.lag + case.dead_time), reset
    if case.process == INTEGRATING:
        delay += case.second_lag + case.actuator_lag
        closed = max(case.wanted_lag, delay) + delay
        return 1 / process_gain / closed, 4 * closed
    delay = delay + case.actuator_lag + case.transmitter_lag + case.lead + case.second_lag / 2
    if case.tuning == "ultimate":
        ultimate_gain, frequency = margin(1.0, 0.0, response)
        return 0.3 * ultimate_gain, max(2 * np.pi / frequency / 1.2 * 1.3, 0.8 * case.lag)
    closed = max(case.wanted_lag - case.dead_time, 0.3 * delay)
    if case.closed_over_delay > 0:
        closed = delay * case.closed_over_delay
    if case.tuning == "simc":
        closed = max(delay, 0.5 * case.wanted_lag)
    lag = case.lag + case.second_lag / 2
    return lag / process_gain / (closed + delay), min(lag, 4 * (closed + delay))
