"""What pages ask: runs, the table of a run, counts, one loop over runs, groups, spectra and traces."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from lostmotion.errors import ParameterError
from lostmotion.store.carry import assessment_row, run_row
from lostmotion.store.encoded import coded, decoded
from lostmotion.store.rows import AssessmentRow, GroupRow, SpectrumRow, TraceRow
from lostmotion.store.run_rows import LoopRow, ReviewRow, ReviewState, RunRow, RunState, UnreadRow
from lostmotion.store.schema import (
    assessment,
    loop,
    member,
    oscillation_group,
    review,
    run,
    said,
    spectrum,
    trace,
    unread,
)

COUNTED = ("said", "severity", "label", "split", "stage")
SORTED = tuple(one.name for one in coded(AssessmentRow) if one.kind not in ("json", "bytes"))
SHOWN = (RunState.FINISHED, RunState.STOPPED, RunState.RUNNING)  # what counts as the last run, if none is finished
LOOP = [column.label(f"loop_{column.name}") for column in loop.columns if column.name != "search"]


@dataclass(frozen=True)
class Filter:
    """Which rows of a run; None: all.

    Attributes
    ----------
    area, loop_type, said, severity, label, split, stage : str, optional
        `said`: by the rule or the diagnosis that decides, as :attr:`lostmotion.store.rows.AssessmentRow.said`.
    text : str
        Part of the tag, the area, the type or a name of a column, upper case or not.
    review : str, optional
        State of the last review ("new": none yet, too).
    newest : bool
        Only the last window of each loop.
    """

    area: str | None = None
    loop_type: str | None = None
    said: str | None = None
    severity: str | None = None
    label: str | None = None
    split: str | None = None
    stage: str | None = None
    text: str = ""
    review: str | None = None
    newest: bool = False


@dataclass(frozen=True)
class Line:
    """A row of the table of a run.

    Attributes
    ----------
    loop : LoopRow
    row : AssessmentRow
    review : ReviewState
        The last one.
    """

    loop: LoopRow
    row: AssessmentRow
    review: ReviewState


@dataclass(frozen=True)
class Lines:
    """One page of the table.

    Attributes
    ----------
    total : int
        Rows that the filter leaves, of all pages.
    lines : tuple of Line
    """

    total: int
    lines: tuple[Line, ...] = field(default_factory=tuple)


LAST_REVIEW = sa.select(sa.func.max(review.c.id)).scalar_subquery()
STAMP = sa.select(run.c.id, run.c.state, run.c.heartbeat, run.c.ended, LAST_REVIEW).order_by(run.c.id.desc()).limit(1)


def stamp(connection: Connection) -> tuple[Any, ...]:
    """The newest run and the last review.

    Audits write in the newest run only, and each transaction of theirs is a beat of its heart; one that abandons
    earlier runs begins or goes on with the newest. Reviews are numbered, and only added.
    """
    return tuple(connection.execute(STAMP).first() or ())


def runs(connection: Connection, limit: int | None = None) -> list[RunRow]:
    """Runs, the newest first."""
    asked = sa.select(run).order_by(run.c.id.desc()).limit(limit)
    return [run_row(values) for values in connection.execute(asked).mappings()]


def one_run(connection: Connection, number: int) -> RunRow | None:
    """A run by its number."""
    found = connection.execute(sa.select(run).where(run.c.id == number)).mappings().first()
    return None if found is None else run_row(found)


def last_run(connection: Connection, before: int | None = None) -> RunRow | None:
    """The newest finished run (before another one); without one the newest that has begun."""
    asked = sa.select(run).order_by(run.c.id.desc()).limit(1)
    asked = asked if before is None else asked.where(run.c.id < before)
    for states in (SHOWN[:1], SHOWN):
        found = connection.execute(asked.where(run.c.state.in_(states))).mappings().first()
        if found is not None:
            return run_row(found)
    return None


def lines(
    connection: Connection,
    number: int,
    chosen: Filter,
    sort: str = "priority",
    *,
    descending: bool = True,
    limit: int = 50,
    offset: int = 0,
) -> Lines:
    """Page of the table of a run; what has no value in the column that is sorted by comes last.

    Raises
    ------
    ParameterError
        No such column.
    """
    conditions, joined = _conditions(number, chosen)
    table = assessment.join(loop, loop.c.id == assessment.c.loop_id)
    total = connection.execute(
        sa.select(sa.func.count()).select_from(table if joined else assessment).where(conditions)
    )
    order = _order(sort, descending=descending)
    keys = sa.select(assessment.c.loop_id, assessment.c.window_start).where(conditions)
    keys = keys.select_from(table if joined or sort in ("tag", "area") else assessment)
    found = connection.execute(keys.order_by(*order).limit(limit).offset(offset)).all()
    return Lines(total.scalar_one(), at(connection, number, [(loop_id, start) for loop_id, start in found]))


def _order(sort: str, *, descending: bool) -> list[Any]:
    if sort == "area":
        column: Any = loop.c.area
    elif sort == "tag":
        column = loop.c.tag
    elif sort in SORTED:
        column = assessment.c[sort]
    else:
        raise ParameterError.expected(f"one of {', '.join(SORTED)}, area", repr(sort), "sort by one of these")
    first = (column.desc() if descending else column.asc()).nulls_last()
    return [first, assessment.c.loop_id, assessment.c.window_start]


def _conditions(number: int, chosen: Filter) -> tuple[Any, bool]:
    """Condition on the rows, and whether it needs the loops."""
    words = {name: getattr(chosen, name) for name in COUNTED}
    conditions = [assessment.c.run_id == number]
    conditions += [_counted(name) == word for name, word in words.items() if word is not None]
    of_loop = [
        column == wanted
        for column, wanted in ((loop.c.area, chosen.area), (loop.c.type, chosen.loop_type))
        if wanted is not None
    ]
    if chosen.text:
        of_loop.append(loop.c.search.contains(chosen.text.casefold(), autoescape=True))
    if chosen.newest:
        conditions.append(assessment.c.newest)
    if chosen.review is not None:
        conditions.append(_reviewed(chosen.review))
    return sa.and_(*conditions, *of_loop), bool(of_loop)


def _counted(name: str) -> Any:
    """Column of COUNTED."""
    return said(assessment) if name == "said" else assessment.c[name]


def _reviewed(state: str) -> Any:
    """Loops whose last review says so."""
    last = sa.select(sa.func.max(review.c.id)).group_by(review.c.loop_id)
    said = sa.select(review.c.loop_id).where(review.c.id.in_(last))
    if state == ReviewState.NEW:
        return assessment.c.loop_id.not_in(said.where(review.c.state != ReviewState.NEW))
    return assessment.c.loop_id.in_(said.where(review.c.state == state))


def at(
    connection: Connection, number: int, keys: Sequence[tuple[int, datetime]], brief: bool = False
) -> tuple[Line, ...]:
    """Rows of some loops and windows, in the order of these keys; not more than a few hundred. `brief`: no evidence."""
    loops = sorted({loop_id for loop_id, _ in keys})
    asked = sa.select(*LOOP, assessment).join_from(assessment, loop, loop.c.id == assessment.c.loop_id)
    starts = sorted({start for _, start in keys})
    here = (assessment.c.run_id == number) & assessment.c.loop_id.in_(loops) & assessment.c.window_start.in_(starts)
    states = last_reviews(connection, loops)
    found, left_out = {}, {"evidence": ()} if brief else {}
    result = connection.execute(asked.where(here))
    names = tuple(result.keys())
    for line in result:
        values = dict(zip(names, line, strict=True))  # looked into hundreds of times: a mapping of the driver is slow
        one = loop_row(values)
        row = decoded(AssessmentRow, values, tag=one.tag, **left_out)
        found[values["loop_id"], row.window_start] = Line(one, row, states.get(values["loop_id"], ReviewState.NEW))
    return tuple(found[key] for key in keys)


def loop_row(values: Any) -> LoopRow:
    """Row of a loop, of a query with `LOOP`."""
    return decoded(LoopRow, {one.column: values[f"loop_{one.column}"] for one in coded(LoopRow)})


def last_reviews(connection: Connection, loops: Sequence[int] | None = None) -> dict[int, ReviewState]:
    """State of each loop that was reviewed; None: of all."""
    asked = sa.select(review.c.loop_id, review.c.state).order_by(review.c.id)
    asked = asked if loops is None else asked.where(review.c.loop_id.in_(loops))
    return {loop_id: ReviewState(state) for loop_id, state in connection.execute(asked)}


def reviews(connection: Connection, tag: str) -> list[ReviewRow]:
    """Reviews of a loop, the oldest first."""
    asked = sa.select(review, loop.c.tag).join(loop).where(loop.c.tag == tag).order_by(review.c.id)
    return [decoded(ReviewRow, values) for values in connection.execute(asked).mappings()]


def counts(connection: Connection, number: int) -> dict[str, dict[str, int]]:
    """Rows of a run by what is said, severity, label, split and stage: how many of each word."""
    columns = [_counted(name) for name in COUNTED]
    asked = sa.select(*columns, sa.func.count()).where(assessment.c.run_id == number).group_by(*columns)
    found: dict[str, dict[str, int]] = {name: {} for name in COUNTED}
    for *words, count in connection.execute(asked):
        for name, word in zip(COUNTED, words, strict=True):
            found[name][word] = found[name].get(word, 0) + count
    return found


def areas(connection: Connection, number: int) -> list[tuple[str, str, str, int]]:
    """Area, what is said, severity, and how many rows of a run: what a treemap shows."""
    columns = (loop.c.area, said(assessment).label("said"), assessment.c.severity)
    asked = sa.select(*columns, sa.func.count()).select_from(assessment.join(loop, loop.c.id == assessment.c.loop_id))
    asked = asked.where(assessment.c.run_id == number).group_by(*columns).order_by(*columns)
    return [(area, word, severity, count) for area, word, severity, count in connection.execute(asked)]


def rows(connection: Connection, number: int) -> Iterator[AssessmentRow]:
    """All rows of a run by tag and window."""
    asked = sa.select(loop.c.tag, assessment).join_from(assessment, loop, loop.c.id == assessment.c.loop_id)
    asked = asked.where(assessment.c.run_id == number).order_by(loop.c.tag, assessment.c.window_start)
    for values in connection.execution_options(yield_per=500).execute(asked).mappings():
        yield assessment_row(values)


def history(connection: Connection, tag: str, limit: int | None = None) -> list[tuple[RunRow, AssessmentRow]]:
    """What the runs said of one loop, the newest run first, the windows of a run in their order."""
    runs_of = [column.label(f"of_run_{column.name}") for column in run.columns]
    asked = sa.select(loop.c.tag, assessment, *runs_of).select_from(assessment.join(loop).join(
        run, run.c.id == assessment.c.run_id
    ))  # fmt: skip
    asked = asked.where(loop.c.tag == tag).order_by(assessment.c.run_id.desc(), assessment.c.window_start).limit(limit)
    return [
        (run_row({column.name: values[f"of_run_{column.name}"] for column in run.columns}), assessment_row(values))
        for values in connection.execute(asked).mappings()
    ]


def windows(connection: Connection, number: int, tag: str) -> list[AssessmentRow]:
    """Windows of a loop in a run, in their order."""
    asked = sa.select(loop.c.tag, assessment).join_from(assessment, loop, loop.c.id == assessment.c.loop_id)
    asked = asked.where((assessment.c.run_id == number) & (loop.c.tag == tag)).order_by(assessment.c.window_start)
    return [assessment_row(values) for values in connection.execute(asked).mappings()]


def one_loop(connection: Connection, tag: str) -> LoopRow | None:
    """A loop as the last loop list had it."""
    values = connection.execute(sa.select(*LOOP).where(loop.c.tag == tag)).mappings().first()
    return None if values is None else loop_row(values)


def loops(connection: Connection) -> list[LoopRow]:
    """All loops of the store by tag."""
    return [loop_row(values) for values in connection.execute(sa.select(*LOOP).order_by(loop.c.tag)).mappings()]


def groups(connection: Connection, number: int) -> tuple[GroupRow, ...]:
    """Groups of a run with their members."""
    asked = sa.select(member, loop.c.tag).join(loop).where(member.c.run_id == number)
    members: dict[int, list[tuple[str, datetime, float, float]]] = {}
    for one in connection.execute(asked.order_by(member.c.number, member.c.place)):
        members.setdefault(one.number, []).append((one.tag, one.window_start, one.likeness, one.score))
    own = sa.select(oscillation_group).where(oscillation_group.c.run_id == number).order_by(oscillation_group.c.number)
    return tuple(
        decoded(GroupRow, values, number=values["number"], members=tuple(members.get(values["number"], ())))
        for values in connection.execute(own).mappings()
    )


def spectra(connection: Connection, number: int, tags: Iterable[str] | None = None) -> Iterator[SpectrumRow]:
    """Spectra of a run by tag and window; those that were carried over lie in the run that made them."""
    asked = _kept_in(spectrum, assessment.c.screened_in, number)
    if tags is not None:  # their numbers first: by tag SQLite looks at all loops of the run
        mine = list(connection.scalars(sa.select(loop.c.id).where(loop.c.tag.in_(list(tags)))))
        asked = asked.where(assessment.c.loop_id.in_(mine))
    for values in connection.execution_options(yield_per=500).execute(asked).mappings():
        yield decoded(SpectrumRow, values)


def traces(connection: Connection, number: int, tag: str) -> list[TraceRow]:
    """Traces of a loop in a run, by window."""
    asked = _kept_in(trace, assessment.c.assessed_in, number).where(loop.c.tag == tag)
    return [decoded(TraceRow, values) for values in connection.execute(asked).mappings()]


def _kept_in(table: sa.Table, made_in: Any, number: int) -> sa.Select[Any]:
    same = (table.c.loop_id == assessment.c.loop_id) & (table.c.window_start == assessment.c.window_start)
    joined = assessment.join(table, same & (table.c.run_id == made_in)).join(loop, loop.c.id == assessment.c.loop_id)
    asked = sa.select(loop.c.tag, table).select_from(joined).where(assessment.c.run_id == number)
    return asked.order_by(loop.c.tag, assessment.c.window_start)


def unreadable(connection: Connection, number: int) -> list[UnreadRow]:
    """What of the source gave no loop."""
    asked = sa.select(unread).where(unread.c.run_id == number).order_by(unread.c.number)
    return [decoded(UnreadRow, values) for values in connection.execute(asked).mappings()]
