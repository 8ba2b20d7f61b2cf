"""What is new since an earlier run: worked out and kept when a run ends, so that pages only read it."""

from __future__ import annotations

import json
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from lostmotion.store.changed import New, differences
from lostmotion.store.encoded import encoded
from lostmotion.store.rows import FINDINGS, AssessmentRow, Stage
from lostmotion.store.schema import assessment, change, comparison, loop, said
from lostmotion.store.writing import ids

COMPARED = (
    "window_start", "window_end", "stage", "verdict", "rule", "size", "low", "high", "size_percent", "severity",
    "excluded_percent", "fit_for_use", "indices",
)  # fmt: skip


def news(connection: Connection, number: int, earlier: int, limit: int | None = None) -> list[New]:
    """Loops that differ between two runs, what matters most first; the last window of each loop counts.

    Nothing where there is no earlier run: everything would be new. Of two runs that were not compared when the later
    one ended it is worked out now.
    """
    if not earlier:
        return []
    compared_with = sa.select(comparison.c.earlier_id).where(comparison.c.run_id == number)
    if connection.scalar(compared_with) == earlier:
        return _kept(connection, number, limit)
    return worked_out(connection, number, earlier, limit)


def worked_out(connection: Connection, number: int, earlier: int, limit: int | None = None) -> list[New]:
    """The same from the rows of both runs."""
    in_question = _in_question(number, earlier)
    before, now = (_rows(connection, one, in_question) for one in (earlier, number))
    return [_new(*one) for one in differences(before, now)[:limit]]


def keep(connection: Connection, number: int, earlier: int) -> None:
    """Write down what is new in a run whose rows no longer change, in the place of what was said before."""
    for table in (change, comparison):
        connection.execute(table.delete().where(table.c.run_id == number))
    _count(connection)
    known = ids(connection)
    values = [
        {"run_id": number, "place": place, "loop_id": known[one.tag]} | encoded(one, "tag")
        for place, one in enumerate(worked_out(connection, number, earlier), 1)
    ]
    if values:
        connection.execute(change.insert(), values)
    connection.execute(comparison.insert().values(run_id=number, earlier_id=earlier))


def _count(connection: Connection) -> None:
    """Bring the statistics of PostgreSQL up to date: it does so a minute after rows came, which is too late."""
    if connection.dialect.name == "postgresql":
        connection.execute(sa.text(f"ANALYZE {assessment.name}"))


def _kept(connection: Connection, number: int, limit: int | None) -> list[New]:
    columns = (change.c[name] for name in New.__annotations__ if name != "tag")
    asked = sa.select(loop.c.tag, *columns).join_from(change, loop, loop.c.id == change.c.loop_id)
    asked = asked.where(change.c.run_id == number).order_by(change.c.place).limit(limit)
    return [New(*values) for values in connection.execute(asked).cursor.fetchall()]  # texts: as the driver has them


def _in_question(number: int, earlier: int) -> sa.CompoundSelect[tuple[int]]:
    """Loops that may have changed: in one of the runs only, or with a finding in one and another one or size."""
    now, before = assessment.alias("now"), assessment.alias("before")
    of_runs = assessment.c.run_id.in_((number, earlier)) & assessment.c.newest
    alone = sa.select(assessment.c.loop_id).where(of_runs).group_by(assessment.c.loop_id)
    apart = _ends(now)[0] > _ends(before)[1], _ends(now)[1] < _ends(before)[0]
    both = sa.select(now.c.loop_id).join(before, before.c.loop_id == now.c.loop_id)
    both = both.where((now.c.run_id == number) & now.c.newest & (before.c.run_id == earlier) & before.c.newest)
    is_, was = said(now), said(before)
    both = both.where(is_.in_(FINDINGS) | was.in_(FINDINGS)).where(sa.or_(is_ != was, *apart))
    return sa.union_all(alone.having(sa.func.count() < 2), both)


def _ends(of: sa.FromClause) -> tuple[sa.ColumnElement[float], sa.ColumnElement[float]]:
    """Interval in % of span, a breath narrower: the rule itself decides what is on the edge."""
    each = of.c.size_percent / sa.func.nullif(of.c.size, 0.0)
    return of.c.low * each * (1.0 + 1e-9), of.c.high * each * (1.0 - 1e-9)


def _rows(connection: Connection, number: int, loops: sa.CompoundSelect[tuple[int]]) -> list[AssessmentRow]:
    columns = assessment.c
    asked = sa.select(loop.c.tag, *(columns[name] for name in COMPARED)).join(loop, loop.c.id == columns.loop_id)
    asked = asked.where((columns.run_id == number) & columns.newest & columns.loop_id.in_(loops))
    found = (dict(values) for values in connection.execute(asked).mappings())
    return [_row(values) for values in found]


def _row(values: dict[str, Any]) -> AssessmentRow:
    return AssessmentRow(**values | {"stage": Stage(values["stage"]), "indices": json.loads(values["indices"])})


def _new(what: str, before: AssessmentRow | None, now: AssessmentRow | None) -> New:
    tag = next(row.tag for row in (now, before) if row is not None)
    words = ["" if row is None else row.said for row in (before, now)]
    severities = ["" if row is None else row.severity for row in (before, now)]
    return New(tag, what, words[0], words[1], severities[0], severities[1])
