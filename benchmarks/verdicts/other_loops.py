"""The loops of `benchmarks/other_simulation.py`: 86 valves without a fault, 106 with one.

A loop's number is its place in `LOOPS`, and part of its seed: new ones go to the end.
"""

from __future__ import annotations

from dataclasses import replace

from verdicts.other_simulation import RecordedLoop, recorded_loop
from verdicts.other_specification import (
    ControllerSpec,
    HistorianSpec,
    LoadSpec,
    LoopSpec,
    ProcessSpec,
    SetPointSpec,
    TransmitterSpec,
    ValveSpec,
)

FIRST_SEED = 1000

FLOW, PRESSURE, TEMPERATURE, LEVEL = (ProcessSpec(kind) for kind in ("flow", "pressure", "temperature", "level"))
AT_REST, MOVES = SetPointSpec("rest"), SetPointSpec("moves")
NORMAL, TIGHT, RINGING = (ControllerSpec(tuning) for tuning in ("normal", "tight", "ringing"))
BITS_12 = TransmitterSpec(step=100 / 4096)
QUIET, QUIET_BITS_12 = TransmitterSpec(noise=0.05), TransmitterSpec(noise=0.05, step=100 / 4096)
SECOND_SCANS = HistorianSpec(rows=2000, scans=2, fine_steps=6)
TWENTIETH_SCANS = HistorianSpec(scans=20, fine_steps=3)  # the process is done within a row
SINE = LoadSpec(sine=2.5, deviation=0.2)


def _moves(size: float, spacing: float | None = None) -> SetPointSpec:
    return SetPointSpec("moves", size, spacing)


def _cascade(size: float, correlation: float = 80.0) -> SetPointSpec:
    return SetPointSpec("cascade", size, correlation=correlation)


def _held(pv_deviation: float, op_deviation: float) -> HistorianSpec:
    return HistorianSpec(compression="hold", pv_deviation=pv_deviation, op_deviation=op_deviation)


def _linear(pv_deviation: float, op_deviation: float) -> HistorianSpec:
    return HistorianSpec(compression="linear", pv_deviation=pv_deviation, op_deviation=op_deviation)


def _sound_in_each(process: ProcessSpec) -> list[LoopSpec]:
    """Without a fault, once in each process."""
    rings_with_moves = process in (FLOW, TEMPERATURE)
    coarse = ControllerSpec("tight", output_step=0.5)
    curved = ValveSpec(equal_percentage=True)
    return [
        LoopSpec("plain, set point at rest", "none", process, set_point=AT_REST, transmitter=BITS_12),
        LoopSpec("plain, set point moves", "none", process, set_point=MOVES, transmitter=BITS_12),
        LoopSpec("load in steps", "none", process, set_point=AT_REST, load=LoadSpec(steps=2.0)),
        LoopSpec("load a sine", "disturbance", process, controller=NORMAL, set_point=AT_REST, load=SINE),
        LoopSpec(
            *("ringing", "tuning", process),
            controller=RINGING,
            set_point=MOVES if rings_with_moves else AT_REST,
            load=LoadSpec(deviation=0.5),
        ),
        LoopSpec("equal percentage", "none", process, curved, NORMAL, _moves(12.0), transmitter=BITS_12),
        LoopSpec("OP in steps", "none", process, controller=coarse, set_point=AT_REST, transmitter=BITS_12),
        LoopSpec("compressed, linear", "none", process, set_point=AT_REST, historian=_linear(0.3, 0.4)),
    ]


def _sound_recorded_or_filtered() -> list[LoopSpec]:
    return [
        LoopSpec("compressed, held", "none", FLOW, set_point=MOVES, historian=_held(0.3, 0.5)),
        LoopSpec("compressed, held", "none", LEVEL, set_point=AT_REST, historian=_held(0.3, 0.5)),
        LoopSpec(
            *("compressed, held", "disturbance", PRESSURE),
            set_point=AT_REST,
            load=LoadSpec(sine=2.0),
            historian=_held(0.4, 0.6),
        ),
        LoopSpec(
            *("filtered PV", "none", FLOW),
            controller=TIGHT,
            set_point=MOVES,
            transmitter=TransmitterSpec(filter_lag=4.0),
        ),
        LoopSpec(
            *("filtered PV", "tuning", FLOW),
            controller=RINGING,
            set_point=AT_REST,
            transmitter=TransmitterSpec(filter_lag=3.0),
        ),
    ]


def _sound_in_fast(process: ProcessSpec) -> list[LoopSpec]:
    """Without a fault, in a flow and in a pressure."""
    slow, slower = ValveSpec(lag=1.5, rate_limit=1.5), ValveSpec(lag=0.5, rate_limit=0.8)
    swinging = ControllerSpec("ringing", share_of_ultimate=1.03)
    limited = ControllerSpec("normal", limits=(40.0, 62.0), op_at_rest=52.0)
    by_hand = ControllerSpec("normal", manual_phases=3)
    outliers = TransmitterSpec(outliers=True)
    return [
        LoopSpec("slow valve", "none", process, slow, TIGHT, _moves(10.0)),
        LoopSpec("rate limit, swinging", "tuning", process, slower, swinging, _moves(8.0)),
        LoopSpec("cascade", "none", process, controller=NORMAL, set_point=_cascade(4.0, 60.0)),
        LoopSpec("saturated", "saturation", process, controller=limited, set_point=_moves(20.0)),
        LoopSpec("operator at times", "none", process, controller=by_hand, set_point=MOVES),
        LoopSpec(
            *("outliers and drift", "none", process),
            controller=NORMAL,
            set_point=AT_REST,
            load=LoadSpec(drift=3.0),
            transmitter=outliers,
        ),
    ]


def _sound_in_slow(process: ProcessSpec) -> list[LoopSpec]:
    """Without a fault, in a temperature and in a level."""
    pid = ControllerSpec("tight", derivative_time=6.0)
    return [
        LoopSpec("PID", "none", process, controller=pid, set_point=MOVES, transmitter=TransmitterSpec(noise=0.03)),
        LoopSpec(
            *("controller's dead band", "none", process),
            controller=ControllerSpec("normal", dead_band=0.5),
            set_point=AT_REST,
            load=LoadSpec(steps=1.5),
            transmitter=TransmitterSpec(noise=0.08),
        ),
        LoopSpec(
            *("controller's dead band", "disturbance", process),
            controller=ControllerSpec("tight", dead_band=0.4),
            set_point=AT_REST,
            load=LoadSpec(sine=3.0),
            transmitter=QUIET,
        ),
        LoopSpec("drift", "none", process, controller=NORMAL, set_point=AT_REST, load=LoadSpec(drift=4.0)),
    ]


def _sound_otherwise() -> list[LoopSpec]:
    """Unusual sampling, hardly any noise, swings of other shapes."""
    fast_flow, faster_flow = ProcessSpec("flow", 0.1, 0.05), ProcessSpec("flow", 0.08, 0.03)
    slow_temperature, slow_level = (
        ProcessSpec("temperature", 600.0, 30.0, 60.0),
        ProcessSpec("level", dead_time=20.0, gain=0.001),
    )
    return [
        LoopSpec(
            *("slow sampling", "none", faster_flow),
            controller=NORMAL,
            set_point=_moves(5.0, 25.0),
            historian=TWENTIETH_SCANS,
        ),
        LoopSpec(
            *("slow sampling", "none", fast_flow),
            controller=NORMAL,
            set_point=AT_REST,
            load=LoadSpec(correlation=4.0),
            historian=TWENTIETH_SCANS,
        ),
        LoopSpec(
            *("fast sampling", "none", slow_temperature),
            controller=NORMAL,
            set_point=_moves(4.0, 900.0),
            historian=HistorianSpec(rows=6000),
        ),
        LoopSpec(
            *("fast sampling", "tuning", slow_level),
            controller=RINGING,
            set_point=AT_REST,
            historian=HistorianSpec(rows=6000),
        ),
        LoopSpec(
            *("hardly any noise", "none", FLOW),
            controller=NORMAL,
            set_point=_cascade(3.0),
            load=LoadSpec(deviation=0.05),
            transmitter=TransmitterSpec(noise=0.005),
        ),
        LoopSpec(
            *("hardly any noise", "disturbance", FLOW),
            controller=NORMAL,
            set_point=AT_REST,
            load=LoadSpec(deviation=0.02, sine=2.0, sine_wander=0.05),
            transmitter=TransmitterSpec(noise=0.01),
        ),
        *(
            LoopSpec(f"load a {shape}", "disturbance", process, controller=NORMAL, set_point=AT_REST, load=load)
            for shape, process, load in (
                ("sawtooth", PRESSURE, LoadSpec(sawtooth=2.5)),
                ("square wave", FLOW, LoadSpec(square=2.0)),
                ("square wave", LEVEL, LoadSpec(square=2.0)),
            )
        ),
    ]


def _faulty_in_each(process: ProcessSpec) -> list[LoopSpec]:
    """A fault of each kind, in each process."""
    gap, stem, zone = ("backlash", "backlash", process), ("stiction", process), ("dead zone", "dead zone", process)
    loads = {deviation: LoadSpec(deviation) for deviation in (1.0, 1.5)}
    return [
        LoopSpec(*gap, ValveSpec("backlash", 1.0), NORMAL, MOVES, transmitter=QUIET_BITS_12),
        LoopSpec(*gap, ValveSpec("backlash", 4.0), NORMAL, AT_REST, loads[1.0]),
        LoopSpec(*gap, ValveSpec("backlash", 8.0), TIGHT, _moves(8.0)),
        LoopSpec(*gap, ValveSpec("backlash", 0.5), NORMAL, AT_REST, transmitter=QUIET),
        LoopSpec("stiction, Choudhury", *stem, ValveSpec("choudhury", 5.0, 2.0), NORMAL, AT_REST),
        LoopSpec("stiction, Choudhury", *stem, ValveSpec("choudhury", 3.0, 3.0), TIGHT, MOVES),
        LoopSpec("stiction, Choudhury", *stem, ValveSpec("choudhury", 1.0, 0.5), NORMAL, AT_REST, transmitter=QUIET),
        LoopSpec("stiction, He", *stem, ValveSpec("he", 4.0, 1.5), NORMAL, MOVES, transmitter=BITS_12),
        LoopSpec("stiction, Karnopp", *stem, ValveSpec("karnopp", 4.0, 1.0), NORMAL, AT_REST, historian=SECOND_SCANS),
        LoopSpec("stiction, Karnopp", *stem, ValveSpec("karnopp", 2.0, 1.0), NORMAL, MOVES, historian=SECOND_SCANS),
        LoopSpec(*zone, ValveSpec("dead zone", 6.0), NORMAL, _moves(8.0)),
        LoopSpec(*zone, ValveSpec("dead zone", 3.0), NORMAL, AT_REST, loads[1.5], QUIET),
    ]


def _faulty_unequal_or_growing() -> list[LoopSpec]:
    unequal, growing, sudden = "stiction, unequal ways", "growing", "sudden"
    onset = ValveSpec("he", 5.0, 2.0, growth=(0.05, 1.0), sudden=True)
    return [
        LoopSpec(unequal, "stiction", FLOW, ValveSpec("he", 4.0, 1.5, downward=0.4), NORMAL, AT_REST),
        LoopSpec(unequal, "stiction", PRESSURE, ValveSpec("he", 4.0, 1.5, downward=2.0), NORMAL, MOVES),
        LoopSpec(growing, "stiction", FLOW, ValveSpec("choudhury", 6.0, 2.0, growth=(0.1, 1.0)), NORMAL, AT_REST),
        LoopSpec(growing, "backlash", PRESSURE, ValveSpec("backlash", 6.0, growth=(0.2, 1.0)), NORMAL, MOVES),
        LoopSpec(sudden, "stiction", FLOW, onset, NORMAL, AT_REST, historian=HistorianSpec(rows=4000)),
    ]


def _faulty_with_more() -> list[LoopSpec]:
    """A fault and something else that disturbs the verdict."""
    stem, small_stem = ValveSpec("choudhury", 4.0, 2.0), ValveSpec("choudhury", 2.0, 1.0)
    curved_stem = ValveSpec("he", 4.0, 1.5, equal_percentage=True)
    curved_gap = ValveSpec("backlash", 4.0, equal_percentage=True)
    fast_hunting, slow_hunting = (ValveSpec("karnopp", 6.0, 2.0, positioner_gain=gain) for gain in (0.6, 0.3))
    coarse, blind = ControllerSpec("normal", output_step=0.5), ControllerSpec("normal", dead_band=0.3)
    return [
        LoopSpec("stiction, compressed", "stiction", FLOW, stem, NORMAL, AT_REST, historian=_linear(0.3, 0.3)),
        LoopSpec("stiction, compressed", "stiction", LEVEL, stem, NORMAL, AT_REST, historian=_held(0.3, 0.3)),
        LoopSpec("stiction, OP in steps", "stiction", PRESSURE, small_stem, coarse, AT_REST),
        LoopSpec("stiction, load a sine", "stiction", FLOW, small_stem, NORMAL, AT_REST, LoadSpec(sine=2.0)),
        LoopSpec("stiction, equal percentage", "stiction", FLOW, curved_stem, NORMAL, _moves(10.0)),
        LoopSpec("backlash, equal percentage", "backlash", PRESSURE, curved_gap, NORMAL, _moves(10.0)),
        LoopSpec("hunting positioner", "stiction", FLOW, fast_hunting, NORMAL, AT_REST, historian=SECOND_SCANS),
        LoopSpec("hunting positioner", "stiction", PRESSURE, slow_hunting, NORMAL, MOVES, historian=SECOND_SCANS),
        LoopSpec(
            *("backlash, controller's dead band", "backlash", LEVEL, ValveSpec("backlash", 3.0)),
            controller=blind,
            set_point=AT_REST,
            transmitter=QUIET,
        ),
        LoopSpec("backlash, cascade", "backlash", FLOW, ValveSpec("backlash", 3.0), NORMAL, _cascade(3.0)),
        LoopSpec("stiction, cascade", "stiction", FLOW, ValveSpec("choudhury", 3.0, 1.0), NORMAL, _cascade(3.0)),
        LoopSpec(
            *("stiction, slow sampling", "stiction", ProcessSpec("flow", 0.08, 0.03), stem),
            controller=NORMAL,
            set_point=AT_REST,
            load=LoadSpec(correlation=4.0),
            historian=TWENTIETH_SCANS,
        ),
        LoopSpec(
            *("dead zone, aside", "dead zone", FLOW, ValveSpec("dead zone", 5.0, zone_offset=4.0)),
            controller=NORMAL,
            set_point=_moves(8.0),
        ),
    ]


def _ahead_in_each(process: ProcessSpec) -> list[LoopSpec]:
    """A controller that knows more than the rows of PV, before a sound valve and before two with a fault."""
    valves = (("none", ValveSpec()), ("backlash", ValveSpec("backlash", 3.0)), ("stiction", ValveSpec("he", 4.0, 1.5)))
    ahead = replace(NORMAL, feedforward=0.8)
    pid = replace(NORMAL, derivative_time=4.0)
    load, seldom = LoadSpec(1.0, steps=1.0), HistorianSpec(scans=4)
    after = (
        HistorianSpec(scans=4, pv_late=0.5),
        HistorianSpec(scans=1, pv_late=1.0),
        HistorianSpec(scans=2, pv_late=2.0),
    )
    found = []
    for truth, valve in valves:
        prefix = "" if truth == "none" else f"{truth}, "
        found.append(LoopSpec(f"{prefix}feedforward", truth, process, valve, ahead, MOVES, load))
        found.append(LoopSpec(f"{prefix}derivative", truth, process, valve, pid, MOVES, load, QUIET, seldom))
        found += [LoopSpec(f"{prefix}PV late", truth, process, valve, NORMAL, MOVES, historian=one) for one in after]
    return found


EACH = (FLOW, PRESSURE, TEMPERATURE, LEVEL)

LOOPS: tuple[LoopSpec, ...] = (
    *(spec for process in EACH for spec in _sound_in_each(process)),
    *_sound_recorded_or_filtered(),
    *(spec for process in (FLOW, PRESSURE) for spec in _sound_in_fast(process)),
    *(spec for process in (TEMPERATURE, LEVEL) for spec in _sound_in_slow(process)),
    *_sound_otherwise(),
    *(spec for process in EACH for spec in _faulty_in_each(process)),
    *_faulty_unequal_or_growing(),
    *_faulty_with_more(),
    *(spec for process in EACH for spec in _ahead_in_each(process)),
)


def loop_of(number: int, offset: int) -> RecordedLoop:
    """Loop of this number, drawn with the seeds from `offset` on."""
    return recorded_loop(LOOPS[number], FIRST_SEED + number + offset)
