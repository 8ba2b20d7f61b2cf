"""Plants that are off the model in many ways: 200 records, in open and closed loop, 0.3 to 100 rows a time constant.

Ways: time constants that differ with direction by 1.1 to 2; a characteristic whose gain changes up to 1 : 3 over the
range; a dead zone that is still to +-b and then on the line that reaches zero at +-0.65 b, which is its truth; a play
that is up to 30 % wider at one end of the range and narrower at the other, whose truth is that in the middle; drift and
the oscillation of a neighbouring loop as a load; an encoder that rounds. One of them, two, or all that there are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from .answer import identified
from .loops import drift, random_fault, random_lag, truth_of, tuned
from .plant import BACKLASH, DEAD_ZONE, DIRECTIONS, NONE, RANGE, Array, Plant, closed_loop, held_levels, open_loop
from .scored import ScoredRow, Truth, scored_report
from .suites import Job, Suite, drawn_jobs

ASYMMETRY, BEND, BREAK_AWAY, FRICTION, LOAD, ROUNDING = WAYS = (
    "asymmetry",
    "bend",
    "break-away",
    "load-dependent friction",
    "load",
    "rounding",
)
TWO, ALL = "two", "all"
ONLY = {BREAK_AWAY: DEAD_ZONE, FRICTION: BACKLASH}
FAULTS = (NONE, DEAD_ZONE, BACKLASH)
CELLS = tuple(
    (fault, way, closed)
    for fault, way, closed in product(FAULTS, (*WAYS, TWO, ALL), (False, True))
    if ONLY.get(way, fault) == fault
)
RATES = (0.3, 100.0)  # rows a time constant
ROWS = (800, 6000)
LAGS = 300.0  # time constants in a record, as far as `ROWS` allow
ZERO = 0.65  # of where a dead zone with break-away moves
BEFORE = 50  # rows that are not recorded


@dataclass(frozen=True)
class Record:
    """Record and what made it."""

    op: Array
    pv: Array
    dt: float
    rate: float
    plant: Plant
    truth: Truth


def ways_of(fault: str, way: str, rng: np.random.Generator) -> set[str]:
    """Ways in which this one is off the model."""
    possible = [one for one in WAYS if ONLY.get(one, fault) == fault]
    if way == TWO:
        return set(rng.choice(possible, 2, replace=False).tolist())
    return set(possible) if way == ALL else {way}


def plant_of(fault: str, ways: set[str], rng: np.random.Generator) -> Plant:
    """What is drawn, with what its ways change."""
    lag, spread = random_lag(rng), np.sqrt(rng.uniform(1.1, 2.0)) ** rng.choice([-1, 1])
    direction, bend, taper = str(rng.choice(DIRECTIONS)), rng.uniform(0.2, 0.5), rng.uniform(0.1, 0.3)
    signs = rng.choice([-1, 1], 2)
    valve = random_fault(fault, rng)
    spread = spread if ASYMMETRY in ways else 1.0
    valve = replace(valve, still=1.0 / ZERO) if BREAK_AWAY in ways else valve
    valve = replace(valve, taper=taper * signs[0]) if FRICTION in ways else valve
    plant = Plant(valve, rng.uniform(0.5, 3.0), lag * spread, lag / spread, direction)
    return replace(plant, bend=bend * signs[1]) if BEND in ways else plant


def record_of(job: Job) -> Record:
    """Draw and simulate."""
    fault, way, closed = CELLS[job.cell]
    rng = np.random.default_rng([job.seed, job.cell, 4])
    ways = ways_of(fault, way, rng)
    plant = plant_of(fault, ways, rng)
    rate = float(np.exp(rng.uniform(*np.log(RATES))))
    rows = BEFORE + int(np.clip(LAGS * rate, *ROWS))
    dt = float(np.sqrt(plant.up * plant.down)) / rate
    load = load_of(rng, rows, rate) if LOAD in ways else None
    noise = rng.normal(scale=rng.uniform(0.005, 0.02) * RANGE * plant.gain, size=rows)
    step = rng.uniform(0.002, 0.02) * RANGE * plant.gain if ROUNDING in ways else 0.0
    hold = np.exp(rng.uniform(np.log(2.0), np.log(6.0))) * np.array([0.6, 1.5])
    if closed:
        controller, pace = tuned(plant, dt, rng.uniform(0.4, 1.2), 0.65 * RANGE)
        half = 0.4 * RANGE * plant.gain
        set_point = held_levels(rng, rows, (-half, half), tuple(hold * pace / dt))
        op, pv = closed_loop(plant, dt, set_point, noise, load, controller, step)
    else:
        op = held_levels(rng, rows, (-RANGE / 2, RANGE / 2), tuple(hold * rate))
        pv = open_loop(plant, dt, op, load) + noise
        pv = step * np.round(pv / step) if step else pv
    op, pv = op[BEFORE:], pv[BEFORE:]
    return Record(op, pv, dt, rate, plant, truth_of(plant, op))


def load_of(rng: np.random.Generator, rows: int, rate: float) -> Array:
    """Drift, and the oscillation of a neighbouring loop, each 1 to 4 % of the range."""
    period = rng.uniform(5.0, 30.0) * rate
    waves = np.sin(2.0 * np.pi * (np.arange(rows) / period + rng.uniform())) * np.sqrt(2.0)
    sizes = rng.uniform(0.01, 0.04, 2) * RANGE
    return sizes[0] * waves + drift(rng, rows, sizes[1], rng.uniform(3.0, 30.0) * rate)


def jobs(seeds: Sequence[int]) -> list[list[Job]]:
    return drawn_jobs("off_model", len(CELLS), (1,), seeds)


def row(job: Job) -> ScoredRow:
    fault, way, closed = CELLS[job.cell]
    record = record_of(job)
    paces = ("below 1", "1 to 10", "above 10")
    pace = paces[int(np.searchsorted([1.0, 10.0], record.rate))]
    loop = "closed" if closed else "open"
    groups = {"actuator": fault, "off by": way, "loop": loop, "rows a time constant": pace}
    name = f"cell {job.cell}, seed {job.seed}: {way}, {loop} loop, {record.rate:.2g} rows a time constant"
    return ScoredRow(name, record.truth, groups, identified(record.op, record.pv, record.dt)[0])


SUITES = (Suite("off_model", jobs, row, scored_report),)
