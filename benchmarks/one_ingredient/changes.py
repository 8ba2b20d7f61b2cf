"""What each ingredient changes of the base case.

The functions of this file change a case in place; `signals.py` and `record.py` have those for signals and records. Of
an ingredient's own random numbers those of the case are drawn first, then set point, load, hand and record.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

from one_ingredient import record, signals
from one_ingredient.controller_and_process import INTEGRATING, UNDERDAMPED
from one_ingredient.draw import Case, Rng, Streams
from one_ingredient.record import Recording
from one_ingredient.valves import Array

SEEDS_APART = 120  # between the first loops of two ingredients; a multiple of the number of kinds
FREE = 32  # place in the table of an ingredient that is gone; those behind it keep their seeds


def nothing(_case: Case, _rng: Rng) -> None:
    """The base case."""


def short_record(case: Case, _rng: Rng) -> None:
    case.rows, case.hold = 300, min(case.hold, 60)


def long_record(case: Case, _rng: Rng) -> None:
    case.rows = 20000


def little_noise(case: Case, _rng: Rng) -> None:
    case.noise = 0.001


def much_noise(case: Case, rng: Rng) -> None:
    case.noise = rng.uniform(1, 2)


def no_load(case: Case, _rng: Rng) -> None:
    case.load_deviation = 0.0


def long_dead_time(case: Case, rng: Rng) -> None:
    case.dead_time = rng.uniform(15, 40)
    case.lag, case.second_lag = case.dead_time * rng.uniform(0.3, 1), 0.0
    case.hold, case.load_lag = max(case.hold, 10 * case.dead_time), 5 * case.dead_time
    case.closed_over_delay = rng.uniform(0.7, 1.5)


def underdamped(case: Case, rng: Rng) -> None:
    case.process, case.lag, case.dead_time = UNDERDAMPED, rng.uniform(3, 8), rng.uniform(1, 3)


def inverse_response(case: Case, rng: Rng) -> None:
    case.second_lag, case.lead = case.lag * 0.5, rng.uniform(0.3, 0.8) * case.dead_time + 2


def integrating(case: Case, rng: Rng) -> None:
    case.process, case.stroke_reach = INTEGRATING, 8.0
    case.second_lag, case.dead_time = max(0.5, case.dead_time * 0.3), max(1.0, case.dead_time * 0.5)
    case.pv_reach = rng.uniform(2, 8)


def level(case: Case, rng: Rng) -> None:
    case.level_gain, case.level_lag, case.velocity_form = rng.uniform(1, 3), rng.uniform(10, 25), False
    integrating(case, rng)


def quick_process(case: Case, rng: Rng) -> None:
    """It settles within a few rows."""
    quicker = rng.uniform(0.06, 0.15)
    case.dead_time, case.lag, case.second_lag = case.dead_time * quicker, case.lag * quicker, case.second_lag * quicker
    case.wanted_lag, case.load_lag = case.wanted_lag * quicker, case.load_lag * quicker
    case.hold, case.scan = max(case.hold * quicker, 25), 1


def seldom_scanned(case: Case, rng: Rng) -> None:
    case.scan, case.wanted_lag = 100, rng.uniform(20, 40)
    case.dead_time, case.hold = case.wanted_lag * 0.3, case.wanted_lag * 12
    case.lag = case.wanted_lag * rng.uniform(0.7, 3)


def often_scanned(case: Case, _rng: Rng) -> None:
    case.scan = 2


def reverse_acting(case: Case, _rng: Rng) -> None:
    case.sign = -1.0


def equal_percentage(case: Case, rng: Rng) -> None:
    case.rangeability = rng.uniform(20, 50)


def slow_actuator(case: Case, rng: Rng) -> None:
    case.actuator_lag = rng.uniform(2, 6)


def positioner(case: Case, rng: Rng) -> None:
    case.positioner_band = rng.uniform(0.1, 0.3)


def rate_limit(case: Case, rng: Rng) -> None:
    case.rate_limit = rng.uniform(0.3, 1.2)


def curved_gain(case: Case, rng: Rng) -> None:
    case.curvature = rng.choice([-1, 1]) * rng.uniform(0.01, 0.02)


def filtered_pv(case: Case, rng: Rng) -> None:
    case.transmitter_lag = rng.uniform(1, 4)


def sluggish(case: Case, rng: Rng) -> None:
    case.slower, case.slower_reset, case.hold = rng.uniform(4, 8), rng.uniform(1, 1.5), case.hold * 3


def aggressive(case: Case, rng: Rng) -> None:
    case.gain_margin = rng.uniform(1.12, 1.4)


def with_derivative(case: Case, rng: Rng) -> None:
    case.derivative_share = rng.uniform(0.3, 0.8)


def gap(case: Case, rng: Rng) -> None:
    case.gap = rng.uniform(0.3, 1.0)


def feedforward(case: Case, _rng: Rng) -> None:
    case.feedforward = -0.9


def asymmetric_friction(case: Case, rng: Rng) -> None:
    """By He's rule, or Stenman's where it was drawn: they have friction for each way."""
    if case.kind == "stiction":
        case.friction = case.friction if case.friction == "stenman" else "he"
        case.asymmetry = rng.uniform(1.4, 2.5)


def growing_fault(case: Case, _rng: Rng) -> None:
    case.size_at_first, case.size_at_last = 0.6, 1.4


def near_the_end(case: Case, rng: Rng) -> None:
    """Set points ask for more than 100 % of OP."""
    case.rest = 100 - rng.uniform(0.3, 0.7) * case.reach


class Change(NamedTuple):
    """What differs from the base case."""

    words: str
    case: Callable[[Case, Rng], None] = nothing
    set_point: Callable[[Case, Streams], Array] = signals.steps
    slow_load: Callable[[Case, Streams], Array] = signals.slow_load
    wave: Callable[[Case, Array, float, Streams], Array] = signals.no_wave
    hand: Callable[[Case, Streams], tuple[Array, Array]] = signals.automatic
    record: Callable[[Recording, Case, Rng], None] = record.as_it_is


CHANGES = {
    "base": Change("nothing"),
    "const_sp": Change("set point at rest", set_point=signals.constant),
    "sp_ramps": Change("set point in ramps", set_point=signals.ramps),
    "sp_sine": Change("set point a sine", set_point=signals.sine),
    "sp_prbs": Change("set point a binary sequence", set_point=signals.two_values),
    "cascade": Change("set point from a master", set_point=signals.of_a_master),
    "integ_pi": Change("integrating process", integrating),
    "level_p": Change("level under a P controller", level, signals.constant, signals.inflow_steps),
    "tiny_noise": Change("noise of 0.001 %", little_noise),
    "large_noise": Change("noise of 1 to 2 %", much_noise),
    "no_load": Change("no load", no_load),
    "rw_load": Change("load a random walk", slow_load=signals.walk),
    "periodic_load": Change("load with a sine as the loop would ring", wave=signals.wave_near_ringing),
    "square_load": Change("load with a square wave", wave=signals.square_wave),
    "sluggish": Change("sluggish controller", sluggish),
    "aggressive": Change("gain margin of 1.1 to 1.4", aggressive),
    "long_dead": Change("dead time longer than the lag", long_dead_time),
    "underdamped": Change("underdamped process", underdamped),
    "nmp": Change("inverse response", inverse_response),
    "eqpct": Change("equal-percentage valve", equal_percentage),
    "valve_lag": Change("actuator with a lag of 2 to 6 rows", slow_actuator),
    "positioner": Change("positioner with a band of its own", positioner),
    "asym_stiction": Change("other friction upward than downward", asymmetric_friction),
    "drift_size": Change("fault grows from 0.6 to 1.4 of its size", growing_fault),
    "reverse": Change("reverse-acting", reverse_acting),
    "scan5": Change("one scan in five rows", seldom_scanned),
    "op_round01": Change("OP stored to 0.1 %", record=record.op_to_a_tenth),
    "op_round1": Change("OP stored to 1 %", record=record.op_to_one),
    "pv_round": Change("PV stored to 0.1 to 0.5 %", record=record.pv_rounded),
    "pv_held": Change("PV by exception, values held", record=record.pv_held),
    "pv_interp": Change("PV by exception, lines between", record=record.pv_interpolated),
    "man_mode": Change("spells in manual", hand=signals.now_and_then, record=record.with_modes),
    "clamped": Change("OP at its upper limit now and then", near_the_end),
    "short300": Change("300 rows", short_record),
    "long20000": Change("20 000 rows", long_record),
    "bump": Change("steps in manual, mode not recorded", hand=signals.bump_test),
    "units01": Change("OP from 0 to 1", record=record.shares),
    "units_mA": Change("OP in mA", record=record.milliamperes),
    "nan": Change("NaN now and then", record=record.gaps),
    "spikes": Change("spikes in PV", record=record.spikes),
    "daynight": Change("load of day and night", slow_load=signals.day_and_night),
    "slow_rows": Change("loop that settles within a few rows", quick_process),
    "averaged": Change("rows are means", record=record.means),
    "pid": Change("derivative of PV", with_derivative),
    "gain_curve": Change("gain changes with the flow", curved_gain),
    "gap": Change("controller with a gap", gap),
    "txfilter": Change("filter in the transmitter", filtered_pv),
    "no_span_sp": Change("OP and PV alone, no spans", record=record.without_spans_and_sp),
    "feedforward": Change("feedforward of the load", feedforward),
    "rate_valve": Change("actuator with a rate limit", rate_limit),
    "sawtooth": Change("load with a sawtooth", wave=signals.sawtooth),
    "wave_up_const": Change(
        "set point at rest, load with a slower sine", set_point=signals.constant, wave=signals.slower_wave
    ),
    "fast_scan": Change("ten scans a row", often_scanned),
    "const_sp_noload": Change("set point at rest, no load", no_load, signals.constant),
    "late_pv": Change("PV a row late", record=record.pv_a_row_late),
}


def seeds_of(ingredient: str, loops: int) -> Iterator[int]:
    """Seeds of an ingredient's first loops: twice as many of the base case, no more than four of long records."""
    place = list(CHANGES).index(ingredient)
    first = SEEDS_APART * (place + (place >= FREE))
    numbers = {"base": range(2 * loops), "long20000": [k for k in (0, 1, 2, 5) if k < loops]}
    yield from (first + k for k in numbers.get(ingredient, range(loops)))
