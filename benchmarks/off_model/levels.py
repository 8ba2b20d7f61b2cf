"""60 levels: an integrating process under PI with a play, a drifting load and noise, no set-point moves; 4 h at 1 s.

PV in % of span, noise of 0.05 to 0.1; the play is 1.5 to 4 of OP.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .answer import NONE, identified
from .bars import at_least, at_most, share, summary, table
from .loops import drift, truth_of
from .plant import BACKLASH, STICTION, Actuator, Array, Controller, Plant, closed_loop
from .scored import ScoredRow
from .suites import Job, Suite, drawn_jobs

ROWS = 14_400
BEFORE = 3_600  # s that are not recorded
CELLS = 12
PLAY = (1.5, 4.0)
STICKING = (BACKLASH, STICTION)


@dataclass(frozen=True)
class LevelRow(ScoredRow):
    """Of a play any of the kinds that stick has a size to judge."""

    @property
    def family(self) -> bool:
        """Backlash or stiction, with a size."""
        return self.answer.kind in STICKING and self.answer.sized

    @property
    def denied(self) -> bool:
        """Said to be sound, or to have less than it has."""
        excluded = self.answer.excluded.get(BACKLASH, np.inf)
        return self.answer.kind == NONE or excluded < self.truth.size

    def __str__(self) -> str:
        excluded = self.answer.excluded.get(BACKLASH, np.inf)
        return f"{super().__str__()}; excluded above {excluded:.3g}{', DENIED' if self.denied else ''}"


def loop_of(job: Job) -> tuple[Array, Array, Plant]:
    """OP, PV, plant. The closed-loop time is 60 to 300 s, the gain of the controller 1 to 4."""
    rng = np.random.default_rng([job.seed, job.cell, 3])
    pace = float(np.exp(rng.uniform(np.log(60.0), np.log(300.0))))
    gain = float(np.exp(rng.uniform(0.0, np.log(4.0))))
    valve = Actuator(BACKLASH, width=rng.uniform(*PLAY))
    plant = Plant(valve, 1.0 / (gain * pace), 1.0, 1.0, dead_time=rng.uniform(0.0, 0.1) * pace, integrates=True)
    rows = BEFORE + ROWS
    load = drift(rng, rows, rng.uniform(1.0, 4.0), rng.uniform(600.0, 3600.0))
    noise = rng.normal(scale=rng.uniform(0.05, 0.1), size=rows)
    op, pv = closed_loop(plant, 1.0, np.zeros(rows), noise, load, Controller(gain, 4.0 * pace))
    return op[BEFORE:] + 50.0, pv[BEFORE:] + 50.0, plant


def jobs(seeds: Sequence[int]) -> list[list[Job]]:
    return drawn_jobs("levels", CELLS, (1,), seeds)


def row(job: Job) -> LevelRow:
    op, pv, plant = loop_of(job)
    return LevelRow(f"level {job.cell}, seed {job.seed}", truth_of(plant, op), {}, identified(op, pv, 1.0)[0])


def report(rows: list[LevelRow]) -> list[str]:
    kinds = dict.fromkeys((one.answer.kind, one.answer.status) for one in rows)
    found = []
    for kind, status in kinds:
        mine = [one for one in rows if (one.answer.kind, one.answer.status) == (kind, status)]
        holds = share(one.holds for one in mine if one.family)
        found.append((kind, status, len(mine), holds, sum(one.denied for one in mine)))
    lines = table(("kind", "status", "records", "size holds", "denied"), sorted(found))
    return lines + summary([
        at_least("intervals hold, of those sized", (one.holds for one in rows if one.family), 0.90),
        at_most("denied", (one.denied for one in rows), 0.05),
    ])  # fmt: skip


SUITES = (Suite("levels", jobs, row, report),)
