"""Time constants that differ with direction: 270 records in open loop, of which a third has no fault.

Cells: ratio 1.2, 1.5, 2.0; by the direction of motion or by speeding up and slowing down; dead zone, backlash, none;
12, 2 and 0.5 rows a time constant. Inputs as those of the wheels: random levels over a range of 120, each held for
several time constants. ``asymmetric_quiet`` is the same with a tenth of the noise, where errors of the model stand out.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from .answer import identified
from .loops import random_fault, random_lag, truth_of
from .plant import BACKLASH, DEAD_ZONE, DIRECTIONS, NONE, RANGE, Array, Plant, held_levels, open_loop
from .scored import ScoredRow, Truth, scored_report
from .suites import Job, Suite, drawn_jobs

RATIOS = (1.2, 1.5, 2.0)
FAULTS = (NONE, DEAD_ZONE, BACKLASH)
RATES = {12.0: 4800, 2.0: 2000, 0.5: 1000}  # rows a time constant: rows
CELLS = tuple(product(RATIOS, DIRECTIONS, FAULTS, RATES))
HOLD = (3.0, 8.0)  # time constants
LOUD, QUIET = "asymmetric", "asymmetric_quiet"
NOISE = {LOUD: (0.005, 0.02), QUIET: (0.0005, 0.002)}  # of the range of PV


@dataclass(frozen=True)
class Record:
    """Record and what made it."""

    op: Array
    pv: Array
    dt: float
    plant: Plant
    truth: Truth


def record_of(job: Job) -> Record:
    """Draw and simulate."""
    ratio, direction, fault, rate = CELLS[job.cell]
    rng = np.random.default_rng([job.seed, job.cell, 1])
    lag = random_lag(rng)
    spread = np.sqrt(ratio) ** rng.choice([-1, 1])
    plant = Plant(random_fault(fault, rng), rng.uniform(0.5, 3.0), lag * spread, lag / spread, direction)
    dt, rows = lag / rate, RATES[rate]
    op = held_levels(rng, rows, (-RANGE / 2, RANGE / 2), (HOLD[0] * rate, HOLD[1] * rate))
    clean = open_loop(plant, dt, op)
    pv = clean + rng.normal(scale=rng.uniform(*NOISE[job.suite]) * np.ptp(clean), size=rows)
    return Record(op, pv, dt, plant, truth_of(plant, op))


def row(job: Job) -> ScoredRow:
    ratio, direction, fault, rate = CELLS[job.cell]
    record = record_of(job)
    groups = {"actuator": fault, "rows a time constant": f"{rate:g}", "ratio": f"{ratio:g}", "by": direction}
    name = f"cell {job.cell}, seed {job.seed}: {ratio:g} by {direction}, {rate:g} rows a time constant"
    return ScoredRow(name, record.truth, groups, identified(record.op, record.pv, record.dt)[0])


def suite_of(name: str) -> Suite:
    return Suite(name, lambda seeds: drawn_jobs(name, len(CELLS), (1,), seeds), row, scored_report)


SUITES = (suite_of(LOUD), suite_of(QUIET))
