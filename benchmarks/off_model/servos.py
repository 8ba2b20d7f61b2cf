"""Servos against a load that is reversed: command and measured position, with a play that a look at the data shows.

Range of position at a constant command: 17 ticks of servo 5, 9 to 11 of servos 1 and 2, of 200 ticks moved
(../shared/actuators/README.md). "OK, none" is the one answer that is wrong.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .answer import NONE, Answer, identified
from .bars import at_most, summary, table
from .places import ACTUATORS
from .suites import Job, Suite

FOLDER = "servos"
DT = 0.1  # s
SERVOS = (("single", 5), ("nocomp2", 1), ("nocomp2", 2))  # the others reverse the load


@dataclass(frozen=True)
class ServoRow:
    """Answer to one servo."""

    servo: str
    answer: Answer

    @property
    def wrong(self) -> bool:
        """A sound actuator with status OK."""
        return self.answer.ok and self.answer.fitted == NONE

    def __str__(self) -> str:
        return f"{self.servo}: {self.answer}, fitted {self.answer.fitted}"


def read(name: str, servo: int) -> tuple[np.ndarray, np.ndarray]:
    """Command and position in ticks; the rows before the first position are left out."""
    with (ACTUATORS / FOLDER / f"{name}.csv").open(newline="", encoding="utf-8") as stream:
        rows = [(row[f"target pos ({servo})"], row[f"pos ({servo})"]) for row in csv.DictReader(stream)]
    found = np.array([[float(command), float(position)] for command, position in rows if position])
    return found[:, 0], found[:, 1]


def jobs(_: Sequence[int]) -> list[list[Job]]:
    return [[Job("servos", cell)] for cell in range(len(SERVOS))]


def row(job: Job) -> ServoRow:
    name, servo = SERVOS[job.cell]
    return ServoRow(f"{name}, servo {servo}", identified(*read(name, servo), DT)[0])


def report(rows: list[ServoRow]) -> list[str]:
    lines = table(
        ("servo", "preferred", "fitted", "status"),
        [(one.servo, one.answer.kind, one.answer.fitted, one.answer.status or one.answer.reason) for one in rows],
    )
    return lines + summary([at_most("status OK with kind none", [one.wrong for one in rows], 0.0)])


SUITES = (Suite("servos", jobs, row, report, FOLDER),)
