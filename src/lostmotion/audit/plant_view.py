"""PlantView and LoopView: what a report is made of, whatever store it comes from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from functools import cached_property

from lostmotion.audit.row_facts import order
from lostmotion.brief import Brief, counted
from lostmotion.plant import PlantLoop, Unread
from lostmotion.store.rows import DENIED, FAULTS, AssessmentRow, GroupRow, Stage, TraceRow

__all__ = ["DENIED", "FAULTS", "LoopView", "PlantView", "RunFacts", "SizePoint", "leading_rows"]


@dataclass(frozen=True)
class RunFacts:
    """What is said of a run before its results.

    Attributes
    ----------
    number : int
        From 1; 0: not from a store.
    plant : str
        Name of the plant, e.g. of the folder.
    sources : tuple of str
        Where the data lie.
    started, ended : datetime, optional
        UTC. None: not known, or not ended.
    code : str
        Version that decided.
    settings : tuple of (str, str)
        Name and value, as people read them.
    cpu_seconds : float, optional
    complete : bool
        False: it was stopped, or its budget was spent.
    store : str
        Where the results lie, without a password; for the commands that are proposed.
    previous : datetime, optional
        When the run with which this one is compared was started; None: there is none.
    """

    number: int = 0
    plant: str = ""
    sources: tuple[str, ...] = ()
    started: datetime | None = None
    ended: datetime | None = None
    code: str = ""
    settings: tuple[tuple[str, str], ...] = ()
    cpu_seconds: float | None = None
    complete: bool = True
    store: str = ""
    previous: datetime | None = None


@dataclass(frozen=True)
class SizePoint:
    """Size of a loop's lost motion in one run, or by an estimate on the running plant, in % of span.

    Attributes
    ----------
    tag : str
    run : int
        Of a live one: number of the watch.
    when : datetime
        Of the data: start of the window; of a live one its last sample.
    said : str
        As :attr:`lostmotion.store.rows.AssessmentRow.said`; of a live one its status.
    size, low, high : float, optional
        With the 95 % interval; None: not known.
    excluded : float, optional
        Largest size that is not excluded, where none was found.
    live : bool
        Of the running plant: it counts as no audit.
    """

    tag: str
    run: int
    when: datetime
    said: str
    size: float | None = None
    low: float | None = None
    high: float | None = None
    excluded: float | None = None
    live: bool = False


@dataclass(frozen=True, repr=False)
class PlantView(Brief):
    """All that a report of a plant shows: plain rows.

    Attributes
    ----------
    run : RunFacts
    loops : tuple of PlantLoop
    rows : tuple of AssessmentRow
        Of this run, ranked; any order, several windows of one loop too.
    groups : tuple of GroupRow
    traces : tuple of TraceRow
    history : tuple of SizePoint
        Of earlier runs and this one; any order.
    previous : tuple of AssessmentRow
        Of the last run before this one.
    unread : tuple of Unread
    growth : mapping of str to str
        A sentence about the trend of the size, by tag, where one is known.
    reviews : mapping of str to str
        State of the review, by tag ("accepted", "work order 4711").
    """

    run: RunFacts
    loops: tuple[PlantLoop, ...]
    rows: tuple[AssessmentRow, ...]
    groups: tuple[GroupRow, ...] = ()
    traces: tuple[TraceRow, ...] = ()
    history: tuple[SizePoint, ...] = ()
    previous: tuple[AssessmentRow, ...] = ()
    unread: tuple[Unread, ...] = ()
    growth: Mapping[str, str] = field(default_factory=dict)
    reviews: Mapping[str, str] = field(default_factory=dict)

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        return f"run {self.run.number}", counted(len(self.loops), "loop"), counted(len(self.rows), "row")

    @cached_property
    def by_tag(self) -> dict[str, PlantLoop]:
        """Loops by their tag; one is made up for a row without."""
        known = {loop.tag: loop for loop in self.loops}
        return known | {row.tag: PlantLoop(row.tag) for row in self.rows if row.tag not in known}

    @cached_property
    def leading(self) -> tuple[AssessmentRow, ...]:
        """One row a loop, the one that says most; highest priority first."""
        return leading_rows(self.rows)

    @cached_property
    def before(self) -> dict[str, AssessmentRow]:
        """That of the last run, by tag."""
        return {row.tag: row for row in leading_rows(self.previous)}

    def loop_view(self, tag: str) -> LoopView:
        """What is shown of one loop.

        Raises
        ------
        KeyError
            There is no row of it.
        """
        mine = [row for row in self.rows if row.tag == tag]
        row = leading_rows(mine)[0] if mine else None
        if row is None:
            raise KeyError(tag)
        return LoopView(
            loop=self.by_tag[tag],
            row=row,
            trace=self._trace(row),
            windows=tuple(sorted(mine, key=lambda one: one.window_start)),
            history=tuple(sorted((one for one in self.history if one.tag == tag), key=lambda one: one.when)),
            group=next((one for one in self.groups if tag in {member[0] for member in one.members}), None),
            run=self.run,
            growth=self.growth.get(tag, ""),
            review=self.reviews.get(tag, ""),
        )

    def _trace(self, row: AssessmentRow) -> TraceRow | None:
        mine = [one for one in self.traces if one.tag == row.tag]
        same = [one for one in mine if one.window_start == row.window_start]
        return next(iter(same or mine), None)


@dataclass(frozen=True)
class LoopView:
    """All that a page of one loop shows.

    Attributes
    ----------
    loop : PlantLoop
    row : AssessmentRow
        The one that says most.
    trace : TraceRow, optional
    windows : tuple of AssessmentRow
        All of this run, in order of time.
    history : tuple of SizePoint
        In order of time.
    group : GroupRow, optional
        With which it swings.
    run : RunFacts
    growth, review : str
        As in PlantView.
    notes : tuple of str
        What was assumed or left out.
    command : str
        What to type next; empty: as the verdict says.
    """

    loop: PlantLoop
    row: AssessmentRow
    trace: TraceRow | None = None
    windows: tuple[AssessmentRow, ...] = ()
    history: tuple[SizePoint, ...] = ()
    group: GroupRow | None = None
    run: RunFacts = field(default_factory=RunFacts)
    growth: str = ""
    review: str = ""
    notes: tuple[str, ...] = ()
    command: str = ""


def leading_rows(rows: tuple[AssessmentRow, ...] | list[AssessmentRow]) -> tuple[AssessmentRow, ...]:
    """Of every loop the row that says most (priority, then assessed, a finding, latest), the most urgent loop first."""
    best: dict[str, AssessmentRow] = {}
    for row in rows:
        if row.tag not in best or _says(row) > _says(best[row.tag]):
            best[row.tag] = row
    return tuple(sorted(best.values(), key=lambda row: (order(row), row.tag)))


def _says(row: AssessmentRow) -> tuple[float, bool, bool, datetime]:
    priority = -1.0 if row.priority is None else row.priority
    return priority, row.stage is Stage.ASSESSED, row.is_finding, row.window_start
