"""AuditRun: what one audit has found, as its store has it."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from lostmotion import _verbs
from lostmotion.audit.history import LoopHistory, history
from lostmotion.audit.live_points import live_estimates
from lostmotion.audit.plant_view import PlantView
from lostmotion.audit.row_facts import order
from lostmotion.audit.rules import finding_of
from lostmotion.audit.run_view import view_of
from lostmotion.brief import Brief, counted
from lostmotion.errors import DataError, ParameterError
from lostmotion.plant import PlantLoop, Unread
from lostmotion.store.changed import New
from lostmotion.store.rows import AssessmentRow, GroupRow, Stage, TraceRow
from lostmotion.store.run_rows import LoopRow, RunRow
from lostmotion.store.store import Store
from lostmotion.summary import Summary


@dataclass(frozen=True, eq=False, repr=False)
class AuditRun(Brief):
    """Result of :func:`lostmotion.audit`: a run of the store. Frozen; prints, draws and tabulates itself.

    Attributes
    ----------
    store : str
        Address of the store.
    run : RunRow
        When, of what, how it ended.
    rows : tuple of AssessmentRow
        One for each loop and window, the most urgent first; what was not ranked last.
    loops : tuple of PlantLoop
        Those of the run.
    groups : tuple of GroupRow
        Loops that swing together.
    unread : tuple of Unread
        What of the source gives no loop.
    news : tuple of New
        What is new since the finished run before.

    Notes
    -----
    History and pictures are read from the store when they are asked for.
    """

    store: str
    run: RunRow
    rows: tuple[AssessmentRow, ...]
    loops: tuple[PlantLoop, ...] = field(repr=False)
    groups: tuple[GroupRow, ...] = field(repr=False)
    unread: tuple[Unread, ...] = field(repr=False)
    news: tuple[New, ...] = field(repr=False)

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        return (
            f"run {self.run.number} of {self.store}",
            counted(len(self.loops), "loop"),
            counted(len(self.rows), "row"),
        )

    @classmethod
    def of(cls, address: str | os.PathLike[str], number: int | None = None) -> AuditRun:
        """A run of a store, without the data; None: the last one.

        Raises
        ------
        FileAccessError
            No store, or one of another version.
        DataError
            No such run.
        """
        with Store(address, write=False) as store:
            runs = {run.number: run for run in store.runs()}
            last = store.last_run()
            wanted = last.number if number is None and last is not None else number
            if wanted is None or wanted not in runs:
                known = ", ".join(str(one) for one in sorted(runs)) or "none"
                raise DataError.expected(
                    f"a run of {store.name}", number, f"it has {known}; run `lostmotion audit` first"
                )
            rows = sorted(store.rows(wanted), key=lambda row: (order(row), row.tag, row.window_start))
            tags = {row.tag for row in rows}
            loops = tuple(as_loop(loop) for loop in store.loops() if loop.tag in tags)
            unread = tuple(Unread(one.where, one.why, one.failed) for one in store.unread(wanted))
            return cls(
                os.fspath(address), runs[wanted], tuple(rows), loops, store.groups(wanted), unread,
                tuple(store.news(wanted)),
            )  # fmt: skip

    @property
    def findings(self) -> tuple[AssessmentRow, ...]:
        """Rows that name something wrong with the loop, the most urgent first.

        A fault of its actuator, or what a rule of the audit says of its measurement, its tuning or its travel. A swing
        that comes from elsewhere is none.
        """
        return tuple(row for row in self.rows if row.is_finding)

    @property
    def failures(self) -> tuple[AssessmentRow | Unread, ...]:
        """Loops that could not be looked at, and files that could not be read."""
        return (
            *(row for row in self.rows if row.stage is Stage.FAILED),
            *(one for one in self.unread if one.failed),
        )

    @cached_property
    def previous(self) -> tuple[AssessmentRow, ...]:
        """Rows of the finished run before."""
        with Store(self.store, write=False) as store:
            before = store.last_run(self.run.number)
            return () if before is None else tuple(store.rows(before.number))

    def loop(self, tag: str) -> LoopHistory:
        """What this run and those before it say of one loop.

        Raises
        ------
        ParameterError
            No such loop in this run.
        """
        if tag not in {row.tag for row in self.rows}:
            raise ParameterError.expected("a loop of the run", repr(tag), "see .table()")
        with Store(self.store, write=False) as store:
            found = [row for run, row in store.history(tag) if run.number <= self.run.number]
            live = [row for _, row in live_estimates(store, self.run, tag)]
        return history(list(reversed(found)), live)

    @cached_property
    def view(self) -> PlantView:
        """What reports show: these rows, with pictures and history of the most urgent loops."""
        return view_of(self)

    def traces(self, tags: Sequence[str]) -> tuple[TraceRow, ...]:
        """Pictures of some loops."""
        with Store(self.store, write=False) as store:
            return tuple(trace for tag in tags for trace in store.traces(self.run.number, tag))

    def table(self) -> Any:
        """Polars frame of the rows, in their order: percentages of span, times in UTC."""
        return _verbs.frame(self.view)

    def summary(self) -> Summary:
        """Report as text: what could not be judged, what was found, what to do first."""
        return Summary(_verbs.text(self.view), self.view)

    def plot(self, **options: Any) -> Any:
        """Figure: verdicts, ranking with sizes, health. Needs the extra ``lostmotion[plot]``."""
        return _verbs.plot(self.view, **options)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready: the run, its rows as in :meth:`table`, findings, groups, news, what could not be read.

        Numbers that JSON does not know are None: of a size that is not excluded, any size is possible.
        """
        found = {
            "store": self.store,
            "run": self.run.number,
            "state": str(self.run.state),
            "loops": len(self.loops),
            "assessments": self.table().to_dicts(),
            "findings": [
                {"tag": row.tag, "window_start": row.window_start, "said": row.said, "finding": finding_of(row.said)}
                for row in self.findings
            ],
            "groups": [
                {"number": one.number, "period": one.period, "source": one.source, "confidence": one.confidence,
                 "why": one.why, "members": [member[0] for member in one.members]}
                for one in self.groups
            ],
            "news": [vars(one) for one in self.news],
            "unread": [vars(one) for one in self.unread],
        }  # fmt: skip
        return {name: _plain(value) for name, value in found.items()}

    def _repr_html_(self) -> str:
        """Headline and table, for notebooks."""
        return _verbs.panel(self.view).html()

    def __str__(self) -> str:
        return self.summary()


def as_loop(loop: LoopRow) -> PlantLoop:
    """Loop of the store as one of a plant."""
    return PlantLoop(**vars(loop))


def _plain(value: Any) -> Any:
    """As strict JSON has it: times as text, numbers that are not finite as None."""
    if isinstance(value, dict):
        return {name: _plain(one) for name, one in value.items()}
    if isinstance(value, list):
        return [_plain(one) for one in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value.isoformat() if hasattr(value, "isoformat") else value
