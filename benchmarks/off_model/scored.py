"""Plants with a known truth: kind, size, and how often the answer is right, holds and misleads."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from .answer import CRASHED, NO_ANSWER, NONE, REFUSED, Answer
from .bars import at_least, at_most, share, summary, table

ACCUSED = 0.01  # of the range of OP: a size that is an accusation
LOST_MOTION = ("dead zone", "backlash", "stiction")
SHOWN_WRONG = 40  # lines


@dataclass(frozen=True)
class Truth:
    """What the plant is; sizes in units of OP. `left` and `right`: where the lines of a dead zone reach zero."""

    kind: str
    size: float
    op_range: float
    left: float = float("nan")
    right: float = float("nan")


@dataclass(frozen=True)
class ScoredRow:
    """Answer beside the truth; `groups` are the columns in which rows are put together."""

    name: str
    truth: Truth
    groups: dict[str, str]
    answer: Answer

    @property
    def accused(self) -> bool:
        """A healthy actuator with a lost motion of more than 1 % of the range of OP, or of an unknown size."""
        lost = self.truth.kind == NONE and self.answer.kind in LOST_MOTION
        return lost and not self.answer.size <= ACCUSED * self.truth.op_range

    @property
    def right(self) -> bool:
        """Kind; a healthy actuator may have a lost motion that is no accusation."""
        small = self.truth.kind == NONE and self.answer.kind in LOST_MOTION and not self.accused
        return small or self.answer.kind == self.truth.kind

    @property
    def sized_right(self) -> bool:
        """A faulty actuator whose kind is right, with a size."""
        return self.truth.kind != NONE and self.right and self.answer.sized

    @property
    def holds(self) -> bool:
        """Whether the interval of the size holds the truth."""
        return self.answer.holds(self.truth.size)

    @property
    def misleads(self) -> bool:
        """Status OK, and another kind or an interval of the size that misses."""
        if not (self.answer.ok and self.answer.named):
            return False
        return not self.right or (self.sized_right and not self.holds)

    @property
    def places(self) -> list[bool]:
        """Whether each interval of a break point (dead zone), or that of the width (backlash, stiction), holds."""
        if not self.sized_right:
            return []
        if not np.isfinite(self.truth.left):
            return [self.holds]
        true = {"left": self.truth.left, "right": self.truth.right}
        return [self.answer.ends[name][0] <= at <= self.answer.ends[name][1] for name, at in true.items()]

    def __str__(self) -> str:
        size = f" {self.truth.size:.3g}" if self.truth.kind != NONE else ""
        mark = " MISLEADS" if self.misleads else "" if self.right or not self.answer.named else " wrong kind"
        return f"{self.name}: {self.truth.kind}{size} -> {self.answer}{mark}"


def scored_report(rows: list[ScoredRow]) -> list[str]:
    """Table by group, those that mislead, and the summary against the bars."""
    lines: list[str] = []
    for column in rows[0].groups:
        lines += by_group(rows, column, lambda row, column=column: row.groups[column])
    wrong = [row for row in rows if row.misleads]
    if wrong:
        lines += ["Status OK and wrong:", "", *(f"- {row}" for row in wrong[:SHOWN_WRONG]), ""]
    return lines + summary([
        at_least("kind right, of those named", named_right(rows), 0.95),
        at_most("healthy, accused of more than 1 % of the range of OP", accusations(rows), 0.02),
        at_least("intervals of break points and plays hold", places(rows), 0.90),
        at_most("status OK and wrong", [row.misleads for row in rows], 0.02),
    ])  # fmt: skip


def by_group(rows: list[ScoredRow], title: str, group: Callable[[ScoredRow], str]) -> list[str]:
    """Counts of each group, and of all."""
    names = list(dict.fromkeys(sorted(group(row) for row in rows)))
    found = [(name, [row for row in rows if group(row) == name]) for name in names] + [("all", rows)]
    head = (
        title, "records", "named", "kind right, of named", "healthy, accused", "size holds",
        "break points and plays hold", "status OK", "OK and wrong", "no answer", "median s",
    )  # fmt: skip
    return table(head, [(name, *counts(some)) for name, some in found])


def counts(rows: list[ScoredRow]) -> list[object]:
    """Cells of one group."""
    return [
        len(rows), sum(row.answer.named for row in rows), share(named_right(rows)), share(accusations(rows)),
        share(row.holds for row in rows if row.sized_right), share(places(rows)), sum(row.answer.ok for row in rows),
        sum(row.misleads for row in rows), sum(row.answer.kind in (NO_ANSWER, REFUSED, CRASHED) for row in rows),
        f"{np.median([row.answer.seconds for row in rows]):.1f}",
    ]  # fmt: skip


def named_right(rows: Iterable[ScoredRow]) -> list[bool]:
    return [row.right for row in rows if row.answer.named]


def accusations(rows: Iterable[ScoredRow]) -> list[bool]:
    return [row.accused for row in rows if row.truth.kind == NONE]


def places(rows: Iterable[ScoredRow]) -> list[bool]:
    return [hit for row in rows for hit in row.places]
