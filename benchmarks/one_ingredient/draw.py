"""The base case: which valve, process, controller and signals a seed draws.

OP, PV, loads and sizes in %, times in rows of the record unless said otherwise.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from one_ingredient.controller_and_process import LAGS
from one_ingredient.valves import (
    BACKLASH,
    CHOUDHURY,
    DEAD_ZONE,
    HE,
    KANO,
    KARNOPP,
    SATURATION,
    SOUND,
    Array,
    Valve,
)

Rng = np.random.Generator

KINDS = (  # by seed
    *("none", "backlash", "stiction", "none", "stiction", "dead zone"),
    *("none", "backlash", "stiction", "none", "dead zone", "saturation"),
)
RULES = {"none": SOUND, "backlash": BACKLASH, "dead zone": DEAD_ZONE, "saturation": SATURATION}
FRICTION_RULES = {"stenman": HE, "he": HE, "choudhury": CHOUDHURY, "kano": KANO, "karnopp": KARNOPP}
FRICTIONS = (*FRICTION_RULES, "karnopp")  # a mass is drawn twice as often as one of the others
LARGEST_JUMP_OF_MASS = 0.8  # of S: with less sliding friction the mass would swing
OPEN_ENDED = 1e9  # %: a stroke that ends nowhere
SWINGS_OF_STROKE = 1.5  # of the reach of OP: an end that is seldom met


class Streams(NamedTuple):
    """Random numbers, apart for what must not change with anything else."""

    case: Rng
    load: Rng
    noise: Rng
    set_point: Rng
    change: Rng  # what the ingredient draws


@dataclass
class Case:
    """What is simulated. From `rest` on: as the base case has it, for ingredients to change."""

    kind: str  # of fault
    friction: str  # rule of a sticking valve
    size: float
    jump_share: float  # of the size
    rows: int
    wanted_lag: float  # of the closed loop
    dead_time: float
    lag: float
    second_lag: float
    gain: float
    velocity_form: bool
    tuning: str  # "lambda", "simc" or "ultimate"
    scan: int  # fine steps, 20 in a row
    noise: float  # standard deviation
    reach: float  # of OP from rest, where set points send it
    load_deviation: float  # standard deviation
    load_lag: float
    hold: float  # a set point stands so long, about
    stroke_share: float  # of the reach, where the stroke of a saturated valve ends
    seconds: float  # in a row
    damping: float  # of an underdamped process
    one_ended: bool  # whether the stroke of a saturated valve ends early on one side alone
    rest: float = 50.0  # OP
    sign: float = 1.0  # of controller and process
    process: int = LAGS
    lead: float = 0.0
    curvature: float = 0.0
    transmitter_lag: float = 0.0
    stroke_reach: float = 0.0  # as `reach`, for the ends of a stroke
    pv_reach: float = 0.0  # of set points from 50
    positioner_band: float = 0.0
    actuator_lag: float = 0.1
    rate_limit: float = 0.0
    rangeability: float = 0.0
    asymmetry: float = 1.0  # friction upward over downward
    size_at_first: float = 1.0  # of `size`, growing evenly to the last row
    size_at_last: float = 1.0
    gap: float = 0.0
    feedforward: float = 0.0
    slower: float = 1.0  # by which the gain of the controller is divided
    slower_reset: float = 1.0
    closed_over_delay: float = 0.0  # lag of the closed loop in delays; 0: `wanted_lag`
    gain_margin: float = 0.0  # that the tuning leaves; 0: at least 2
    derivative_share: float = 0.0  # of a quarter of the reset time
    level_gain: float = 0.0  # of a controller without integral
    level_lag: float = 0.0  # of its loop

    @property
    def jump_of_size(self) -> float:
        """J / S, as the rule has it."""
        if self.kind != "stiction":
            return 0.0
        if self.friction == "stenman":
            return 1.0
        return min(self.jump_share, LARGEST_JUMP_OF_MASS) if self.friction == "karnopp" else self.jump_share

    @property
    def stroke(self) -> tuple[float, float]:
        """Lowest and highest travel."""
        if self.kind != "saturation":
            return -OPEN_ENDED, OPEN_ENDED
        near = self.stroke_share * self.stroke_reach
        far = SWINGS_OF_STROKE * self.stroke_reach if self.one_ended else near
        return 50.0 - far + (self.rest - 50.0), 50.0 + near + (self.rest - 50.0)


def streams_of(seed: int) -> Streams:
    """Random numbers of a loop."""
    return Streams(*(np.random.default_rng([stream, seed]) for stream in (77, 78, 79, 80, 81)))


def base_case(rng: Rng, seed: int) -> Case:
    """The base case of a seed; the order of what is drawn is part of it."""
    uniform = rng.uniform
    size = float(np.exp(uniform(0, np.log(8))))
    friction = FRICTIONS[int(rng.integers(6))]
    jump_share, rows = float(uniform(0.1, 1.0)), int(uniform(1000, 6000))
    wanted_lag = uniform(5, 20)
    dead_time, lag = wanted_lag * uniform(0.2, 0.5), wanted_lag * uniform(0.7, 4)
    case = Case(
        kind=KINDS[seed % len(KINDS)],
        friction=friction,
        size=size,
        jump_share=jump_share,
        rows=rows,
        wanted_lag=wanted_lag,
        dead_time=dead_time,
        lag=lag,
        second_lag=lag * uniform(0.1, 0.5) if uniform() < 0.5 else 0.0,
        gain=float(np.exp(uniform(np.log(0.5), np.log(2)))),
        velocity_form=bool(rng.integers(2)),
        tuning=("lambda", "simc", "ultimate")[int(rng.integers(3))],
        scan=int(rng.choice([5, 10, 20])),
        noise=uniform(0.05, 0.3),
        reach=uniform(4, 12),
        load_deviation=uniform(0.2, 0.8),
        load_lag=wanted_lag * uniform(3, 10),
        hold=wanted_lag * uniform(8, 25),
        stroke_share=uniform(0.1, 0.6),
        seconds=float(rng.choice([0.5, 1, 2, 5, 10])),
        damping=uniform(0.15, 0.4),
        one_ended=bool(uniform() < 0.5),
    )
    case.stroke_reach, case.pv_reach = case.reach, case.gain * case.reach
    return case


def valve_of(case: Case) -> Valve:
    """The valve with its fault."""
    jump, (lowest, highest) = case.jump_of_size, case.stroke
    downward = 2 / (1 + case.asymmetry)
    upward = downward * case.asymmetry
    return Valve(
        rule=FRICTION_RULES[case.friction] if case.kind == "stiction" else RULES[case.kind],
        size=_sizes(case),
        jump_share=jump,
        stick_up=(1 + jump) / 2 * upward,
        slide_up=(1 - jump) / 2 * upward,
        stick_down=(1 + jump) / 2 * downward,
        slide_down=(1 - jump) / 2 * downward,
        middle=case.rest,
        lowest=lowest,
        highest=highest,
        positioner_band=case.positioner_band,
        lag=case.actuator_lag,
        rate_limit=case.rate_limit,
        rangeability=case.rangeability,
    )


def _sizes(case: Case) -> Array:
    return case.size * np.linspace(case.size_at_first, case.size_at_last, case.rows)


def met(case: Case, op: Array) -> int:
    """How often OP, in %, goes through the whole fault: reversals larger than 1.2 S, crossings of a dead zone, ends."""
    if case.kind == "dead zone":
        side = np.sign(op - case.rest) * (np.abs(op - case.rest) > case.size / 2)
        side = side[side != 0]
        return int(np.count_nonzero(side[1:] != side[:-1]))
    if case.kind == "saturation":
        lowest, highest = case.stroke
        return reversals(((op > highest + 1) | (op < lowest - 1)).astype(float), 0.5)
    return reversals(op, 1.2 * case.size) if case.kind != "none" else 0


def reversals(values: Array, threshold: float) -> int:
    """How often the values turn by more than the threshold."""
    found, way = 0, 0
    lowest = highest = values[0]
    for value in values:
        lowest, highest = min(lowest, value), max(highest, value)
        if way >= 0 and highest - value > threshold:
            found += way != 0
            way, lowest = -1, value
        elif way <= 0 and value - lowest > threshold:
            found += way != 0
            way, highest = 1, value
    return found
