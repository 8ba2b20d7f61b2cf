"""100 closed loops recorded at every scan and at each 2nd, 4th and 16th: the same kind, and intervals that overlap.

PI with set-point moves, drifting disturbance and noise; processes of first and second order with and without dead time;
no fault, dead zone, backlash, stiction (two parameters, S and J, after He).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, product

import numpy as np

from .answer import NONE, Answer, identified
from .bars import at_least, share, summary, table
from .loops import drift, truth_of, tuned
from .plant import BACKLASH, DEAD_ZONE, STICTION, Actuator, Array, Plant, closed_loop, held_levels
from .scored import Truth
from .suites import Job, Suite, drawn_jobs

SCANS = 4800
BEFORE = 300  # scans that are not recorded
THINNED = (1, 2, 4, 16)
FAULTS = (NONE, DEAD_ZONE, BACKLASH, STICTION)
PROCESSES = {  # lag, second lag, dead time: scans, drawn between
    "fast": ((8.0, 20.0), (0.0, 0.0), (0.0, 2.0)),
    "slow": ((20.0, 60.0), (0.0, 0.0), (0.0, 3.0)),
    "dead time": ((10.0, 30.0), (0.0, 0.0), (3.0, 10.0)),
    "second order": ((15.0, 50.0), (3.0, 12.0), (0.0, 2.0)),
    "second order, dead time": ((15.0, 50.0), (3.0, 12.0), (3.0, 10.0)),
}
CELLS = tuple(product(FAULTS, PROCESSES))
MOVES = 40.0  # of OP: what set-point moves ask for


@dataclass(frozen=True)
class ThinnedRow:
    """Answer to one loop, recorded at each `every`-th scan."""

    loop: tuple[int, int]
    every: int
    process: str
    truth: Truth
    answer: Answer

    def __str__(self) -> str:
        true = f"{self.truth.kind} {self.truth.size:.3g}"
        return f"loop {self.loop}, {self.process}, each {self.every}: {true} -> {self.answer}"


def loop_of(job: Job) -> tuple[Array, Array, Plant]:
    """OP, PV at every scan (a second), and the plant."""
    kind, name = CELLS[job.cell]
    rng = np.random.default_rng([job.seed, job.cell, 2])
    lag, second, dead = (float(rng.uniform(*ends)) for ends in PROCESSES[name])
    plant = Plant(valve_of(kind, rng), rng.uniform(0.5, 2.0), lag, lag, second=second, dead_time=dead)
    controller, pace = tuned(plant, 1.0, rng.uniform(0.4, 1.2))
    scans = BEFORE + SCANS
    half = 0.5 * MOVES * plant.gain
    set_point = held_levels(rng, scans, (-half, half), (3.0 * pace, 8.0 * pace))
    load = drift(rng, scans, rng.uniform(1.0, 4.0), rng.uniform(5.0, 20.0) * pace)
    noise = rng.normal(scale=rng.uniform(0.003, 0.01) * 2.0 * half, size=scans)
    op, pv = closed_loop(plant, 1.0, set_point, noise, load, controller)
    return op[BEFORE:], pv[BEFORE:], plant


def valve_of(kind: str, rng: np.random.Generator) -> Actuator:
    """Sizes of 2 to 6, of moves of 40."""
    if kind == DEAD_ZONE:
        return Actuator(kind, left=-rng.uniform(1.0, 3.0), right=rng.uniform(1.0, 3.0))
    width = rng.uniform(2.0, 6.0)
    if kind == STICTION:
        return Actuator(kind, width=width, jump=rng.uniform(0.3, 0.8) * width)
    return Actuator(kind, width=width) if kind == BACKLASH else Actuator()


def jobs(seeds: Sequence[int]) -> list[list[Job]]:
    return drawn_jobs("thinning", len(CELLS), THINNED, seeds)


def row(job: Job) -> ThinnedRow:
    op, pv, plant = loop_of(job)
    every = job.rate
    answer = identified(op[::every], pv[::every], float(every))[0]
    return ThinnedRow((job.seed, job.cell), every, CELLS[job.cell][1], truth_of(plant, op), answer)


def report(rows: list[ThinnedRow]) -> list[str]:
    pairs = [pair for pair in combinations(rows, 2) if pair[0].loop == pair[1].loop]
    named = [(one.answer, other.answer) for one, other in pairs if one.answer.named and other.answer.named]
    same = [(one, other) for one, other in named if one.kind == other.kind and one.sized and other.sized]
    lines = by_rate(rows) + by_kind(rows)
    return lines + summary([
        at_least("same kind, pairs of rates both named", (one.kind == other.kind for one, other in named), 0.95),
        ["the same, backlash and stiction as one", share(family(one) == family(other) for one, other in named), "", ""],
        at_least("intervals overlap, pairs of one kind", (overlap(*pair) for pair in same), 0.97),
    ])  # fmt: skip


def family(answer: Answer) -> str:
    """Kind, of which backlash and stiction are one."""
    return BACKLASH if answer.kind == STICTION else answer.kind


def overlap(one: Answer, other: Answer) -> bool:
    """Whether the intervals of the size have something in common."""
    return max(one.interval[0], other.interval[0]) <= min(one.interval[1], other.interval[1])


def by_rate(rows: list[ThinnedRow]) -> list[str]:
    """What is named at each rate, and whether it is right."""
    found = []
    for every in THINNED:
        mine = [one for one in rows if one.every == every]
        named = [one for one in mine if one.answer.named]
        right = [one for one in named if one.answer.kind == one.truth.kind]
        holds = share(one.answer.holds(one.truth.size) for one in right if one.answer.sized)
        median = f"{np.median([one.answer.seconds for one in mine]):.1f}" if mine else "-"
        found.append((every, len(mine), len(named), share(one in right for one in named), holds, median))
    return table(("each scan", "records", "named", "kind right", "size holds", "median s"), found)


def by_kind(rows: list[ThinnedRow]) -> list[str]:
    """A line for each loop: what is named at each rate."""
    loops = dict.fromkeys(one.loop for one in rows)
    found = []
    for loop in loops:
        mine = [one for one in rows if one.loop == loop]
        true = mine[0].truth
        found.append((loop, f"{true.kind} {true.size:.3g}", mine[0].process, *(short(one.answer) for one in mine)))
    return table(("seed, cell", "truth", "process", *(f"each {every}" for every in THINNED)), found)


def short(answer: Answer) -> str:
    """Kind with interval."""
    ends = f" {answer.interval[0]:.3g} to {answer.interval[1]:.3g}" if answer.sized else ""
    return f"{answer.kind}{ends}, {answer.status or answer.reason}"


SUITES = (Suite("thinning", jobs, row, report),)
