"""Loops with and without a fault of the valve, from a simulation that shares nothing with the package.

A specification (`other_specification.py`) says what a loop is; what it leaves open is drawn. Simulated in fine steps
(`other_valves.py`) and recorded as a historian does it: a row for each or each few scans of the controller, compressed.
OP and PV in % of span, times in rows of the record unless said otherwise.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, TypeVar

import numpy as np
from scipy.signal import lfilter

from verdicts.other_specification import (
    SECONDS,
    ControllerSpec,
    LoadSpec,
    LoopSpec,
    ProcessSpec,
    SetPointSpec,
    TransmitterSpec,
    ValveSpec,
)
from verdicts.other_valves import (
    BACKLASH,
    CHOUDHURY,
    DEAD_ZONE,
    HE,
    KARNOPP,
    SOUND,
    Clock,
    Controller,
    ProcessModel,
    Signals,
    Transmitter,
    Valve,
    closed_loop,
)

Array = np.ndarray
Rng = np.random.Generator
T = TypeVar("T")

PV_AT_REST = 50.0  # %
SETTLING = 200  # rows before the record
LONGEST_GAP = 600  # rows: a historian stores a value at least as often
RULES = {"": SOUND, "backlash": BACKLASH, "he": HE, "choudhury": CHOUDHURY, "karnopp": KARNOPP, "dead zone": DEAD_ZONE}
TUNINGS = ("normal", "normal", "sluggish", "tight")  # drawn from where none is given
PACE = {"tight": 1.0, "normal": 2.5, "sluggish": 6.0, "ringing": 1.0}  # time of the closed loop over its delay


@dataclass(frozen=True)
class RecordedLoop:
    """Record of a loop, and what was drawn for it."""

    op: Array
    pv: Array
    sp: Array
    place: Array  # of the valve, %
    manual: Array
    seconds: float  # in a row
    scans: int  # of the controller in a row
    tuning: str
    course: str  # of the set point


class _Tuning(NamedTuple):
    gain: float
    reset: float  # rows
    closed_loop_lag: float  # rows
    delay: float  # rows: dead time and what acts as such

    @property
    def settling(self) -> float:
        """Time constant with delay, rows."""
        return self.closed_loop_lag + self.delay


def recorded_loop(spec: LoopSpec, seed: int) -> RecordedLoop:
    """Draw what the specification leaves open, simulate, record. The order of the draws is part of the loop."""
    rng = np.random.default_rng(seed)
    historian = spec.historian
    rows = _given(historian.rows, int(rng.integers(1500, 4001)))
    scans = _given(historian.scans, int(rng.choice([1, 2, 4])))
    fine_steps = _given(historian.fine_steps, 8 if scans == 1 else 4)
    scan, count = 1.0 / scans, rows * scans
    process = _process(rng, spec.process)
    valve_lag = _given(spec.valve.lag, (0.15 if spec.process.kind == "flow" else 0.4) * rng.uniform())
    rest = float(_given(spec.controller.op_at_rest, rng.uniform(35, 65)))
    style = spec.controller.tuning or str(rng.choice(TUNINGS))
    filter_lag = spec.transmitter.filter_lag
    tuning = _tuned(style, process, scan, filter_lag, valve_lag)
    if style == "ringing":
        ringing = _ringing_gain(spec.controller.share_of_ultimate, tuning, process, scan, filter_lag, valve_lag)
        tuning = tuning._replace(gain=ringing)
    course, set_point = _set_point(rng, spec.set_point, count, scans, tuning)
    load = _load(rng, spec.load, rows, scans, tuning)
    drift = np.zeros(count)
    if spec.load.drift:
        drift += np.cumsum(rng.normal(size=count)) * spec.load.drift / np.sqrt(count)
    noise = _noise(rng, spec.transmitter, count)
    manual, manual_output = _manual(rng, spec.controller.manual_phases, count, rest)
    op, pv, place = closed_loop(
        Signals(set_point, load, drift, noise, manual, manual_output, -spec.controller.feedforward * load),
        Clock(scan / fine_steps, fine_steps, SECONDS[spec.process.kind]),
        process,
        _controller(spec.controller, tuning),
        Transmitter(filter_lag, spec.transmitter.step),
        _valve(spec.valve, valve_lag, rest),
        rest,
    )
    pv = late(pv, int(historian.pv_late * scans))
    op, pv, sp, place, manual = (signal[scans - 1 :: scans][SETTLING:] for signal in (op, pv, set_point, place, manual))
    if historian.compression:
        pv = compressed(pv, historian.pv_deviation, historian.compression)
        op = compressed(op, historian.op_deviation, historian.compression)
    return RecordedLoop(op, pv, sp, place, manual, SECONDS[spec.process.kind], scans, style, course)


def _given(value: T | None, drawn: T) -> T:
    return drawn if value is None else value


def _process(rng: Rng, spec: ProcessSpec) -> ProcessModel:
    """Draw what is not given."""
    draw = rng.uniform
    second_lag = 0.0
    if spec.kind == "flow":
        lag, dead_time, gain = draw(0.8, 4), draw(0.2, 1.2), draw(0.6, 2)
    elif spec.kind == "pressure":
        lag, second_lag, dead_time, gain = draw(5, 20), draw(0, 1.5), draw(0.3, 2), draw(0.8, 3)
    elif spec.kind == "temperature":
        lag, second_lag, dead_time, gain = draw(30, 120), draw(4, 25), draw(2, 12), draw(0.6, 2.5)
    else:
        lag, second_lag, dead_time, gain = 0.0, draw(0, 3), draw(0.2, 2), draw(0.004, 0.04)
    return ProcessModel(
        float(_given(spec.gain, gain)),
        float(_given(spec.lag, lag)),
        float(_given(spec.second_lag, second_lag)),
        float(_given(spec.dead_time, dead_time)),
        spec.kind == "level",
    )


# --- controller


def _tuned(style: str, process: ProcessModel, scan: float, filter_lag: float, valve_lag: float) -> _Tuning:
    """PI by the rules of Skogestad (SIMC); sampling and small lags count as dead time."""
    delay = process.dead_time + scan / 2 + process.second_lag / 2 + filter_lag + valve_lag
    if process.integrating:
        pace = PACE[style] * max(delay, 4.0)
        return _Tuning(1 / (process.gain * (pace + delay)), 4 * (pace + delay), pace, delay)
    lag = process.lag + process.second_lag / 2
    pace = PACE[style] * max(delay, 0.15 * lag)
    return _Tuning(lag / (process.gain * (pace + delay)), min(lag, 4 * (pace + delay)), pace, delay)


def _ringing_gain(
    share: float, tuning: _Tuning, process: ProcessModel, scan: float, filter_lag: float, valve_lag: float
) -> float:
    """This share of the gain at which the loop swings for ever; unchanged where there is no such gain."""
    w = np.logspace(-4, np.log10(np.pi / scan), 4000)
    answer = (process.gain / (1j * w)) if process.integrating else process.gain / (1 + 1j * w * process.lag)
    answer = answer * np.exp(-1j * w * (process.dead_time + 0.5 * scan)) / (1 + 1j * w * process.second_lag)
    answer = answer / (1 + 1j * w * filter_lag) / (1 + 1j * w * valve_lag)
    opened = answer * tuning.gain * (1 + 1 / (1j * w * tuning.reset))
    phase = np.unwrap(np.angle(opened))
    crossing = np.where((phase[:-1] > -np.pi) & (phase[1:] <= -np.pi))[0]
    return tuning.gain * (share / abs(opened[crossing[0]])) if len(crossing) else tuning.gain


def _controller(spec: ControllerSpec, tuning: _Tuning) -> Controller:
    return Controller(
        tuning.gain,
        tuning.gain / tuning.reset,
        tuning.gain * spec.derivative_time,
        spec.derivative_time / 8 if spec.derivative_time else 1.0,
        spec.dead_band,
        *(float(limit) for limit in spec.limits),
        spec.output_step,
    )


def _manual(rng: Rng, phases: int, count: int, rest: float) -> tuple[Array, Array]:
    """Scans in which the operator has the valve, and three steps of his in each phase."""
    manual, output = np.zeros(count, np.bool_), np.zeros(count)
    for _ in range(phases):
        begin = int(rng.uniform(0.1, 0.85) * count)
        end = min(count, begin + int(count * rng.uniform(0.03, 0.08)))
        manual[begin:end] = True
        steps = np.repeat(rng.uniform(-3, 3, 20), int(np.ceil((end - begin) / 3)))
        output[begin:end] = rest + steps[: end - begin]
    return manual, output


# --- valve


def _valve(spec: ValveSpec, lag: float, rest: float) -> Valve:
    """Sizes as distances to the command at which the valve lets go, and which then are left."""
    stick, slide = (spec.band + spec.jump) / 2, (spec.band - spec.jump) / 2
    middle, half = rest + spec.zone_offset, spec.band / 2
    return Valve(
        RULES[spec.rule],
        *(stick, slide, stick * spec.downward, slide * spec.downward),
        *(middle - half, middle + half),
        *spec.growth,
        spec.sudden,
        lag,
        spec.rate_limit,
        spec.positioner_gain,
        spec.equal_percentage,
        rangeability=40.0,
    )


# --- set point and disturbances


def _set_point(rng: Rng, spec: SetPointSpec, count: int, scans: int, tuning: _Tuning) -> tuple[str, Array]:
    """Course and value in each scan."""
    drawn = str(rng.choice(["rest", "moves"]))
    course, found = spec.course or drawn, np.full(count, PV_AT_REST)
    if course == "cascade":
        found = PV_AT_REST + coloured(rng, count, scans * spec.correlation, spec.size)
    if course == "moves":
        spacing = _given(spec.spacing, max(60, 6 * tuning.settling))
        begin, level = 0, PV_AT_REST
        while begin < count:
            end = begin + int(scans * spacing * rng.uniform(0.6, 2))
            found[begin:end] = level
            begin, level = end, PV_AT_REST + spec.size * rng.uniform(-1, 1)
    return course, found


def _load(rng: Rng, spec: LoadSpec, rows: int, scans: int, tuning: _Tuning) -> Array:
    """Added to the flow through the valve in each scan."""
    count, period = rows * scans, scans * (8 * tuning.settling)
    correlation = _given(spec.correlation, max(10.0, tuning.closed_loop_lag * 3))
    found = coloured(rng, count, scans * correlation, spec.deviation)
    if spec.steps:
        for _ in range(int(rows / 250) + 1):
            begin = int(rng.uniform(0, count))
            found[begin:] += spec.steps * rng.normal()
    if spec.sine:
        found += wandering_sine(rng, count, period, spec.sine, spec.sine_wander)
    if spec.sawtooth:
        found += spec.sawtooth * (2 * np.abs(2 * _turns(rng, count, scans, period) - 1) - 1)
    if spec.square:
        found += spec.square * np.sign(_turns(rng, count, scans, period) - 0.5)
    return found


def _turns(rng: Rng, count: int, scans: int, period: float) -> Array:
    """Phase, 0 to 1, of a swing whose period wanders by a tenth."""
    return (np.cumsum(1 + 0.1 * coloured(rng, count, scans * 200, 1)) / period) % 1


def _noise(rng: Rng, spec: TransmitterSpec, count: int) -> Array:
    noise = rng.normal(size=count) * spec.noise
    if spec.outliers:
        noise += spec.noise * 3 * rng.exponential(size=count) * (rng.random(count) < 0.05)
    return noise


def coloured(rng: Rng, count: int, correlation: float, deviation: float) -> Array:
    """First-order noise with this correlation time in scans, settled."""
    pole = np.exp(-1 / correlation)
    white = rng.normal(size=count + int(5 * correlation)) * np.sqrt(1 - pole * pole)
    return deviation * lfilter([1], [1, -pole], white)[-count:]


def wandering_sine(rng: Rng, count: int, period: float, amplitude: float, wander: float) -> Array:
    """Sine whose period, in scans, and amplitude wander slowly."""
    phase = 2 * np.pi * np.cumsum(1 + 0.15 * coloured(rng, count, 3 * period, 1)) / period
    swell = np.clip(1 + wander * coloured(rng, count, 6 * period, 1), 0.1, 3)
    return amplitude * swell * np.sin(phase + rng.uniform(0, 6))


# --- historian


def late(values: Array, scans: int) -> Array:
    """Each value so many scans later."""
    return np.concatenate([values[:scans], values[: len(values) - scans]])


def compressed(values: Array, deviation: float, filled: str) -> Array:
    """Stored where off by more than the deviation from the value stored last; between, "hold" that or "linear"."""
    stored = [0]
    for row in range(1, len(values)):
        if abs(values[row] - values[stored[-1]]) > deviation or row - stored[-1] > LONGEST_GAP:
            stored.append(row)
    kept, rows = np.array(stored), np.arange(len(values))
    if filled == "hold":
        return values[kept][np.searchsorted(kept, rows, side="right") - 1]
    return np.interp(rows, kept, values[kept])
