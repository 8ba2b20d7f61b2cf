"""What is new since an earlier run."""

from __future__ import annotations

from dataclasses import dataclass

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from lostmotion.store.changed import differences
from lostmotion.store.rows import FAULTS, AssessmentRow, Stage
from lostmotion.store.schema import assessment, loop

COMPARED = ("window_start", "window_end", "stage", "verdict", "size", "low", "high", "size_percent", "severity")


@dataclass(frozen=True)
class New:
    """One loop that is another than it was.

    Attributes
    ----------
    tag : str
    what : str
        Of :data:`lostmotion.store.changed.ORDER`.
    before, after : str
        Verdicts; empty: the loop was not in that run.
    severity_before, severity_after : str
    """

    tag: str
    what: str
    before: str
    after: str
    severity_before: str
    severity_after: str


def news(connection: Connection, number: int, earlier: int, limit: int | None = None) -> list[New]:
    """Loops that differ between two runs, what matters most first; the last window of each loop counts.

    Nothing where there is no earlier run: everything would be new.
    """
    if not earlier:
        return []
    in_question = _in_question(number, earlier)
    before, now = (_rows(connection, one, in_question) for one in (earlier, number))
    return [_new(*one) for one in differences(before, now)[:limit]]


def _in_question(number: int, earlier: int) -> sa.CompoundSelect[tuple[int]]:
    """Loops that may have changed: in one of the runs only, or with a fault in one and another verdict or size."""
    now, before = assessment.alias("now"), assessment.alias("before")
    of_runs = assessment.c.run_id.in_((number, earlier)) & assessment.c.newest
    alone = sa.select(assessment.c.loop_id).where(of_runs).group_by(assessment.c.loop_id)
    apart = _ends(now)[0] > _ends(before)[1], _ends(now)[1] < _ends(before)[0]
    both = sa.select(now.c.loop_id).join(before, before.c.loop_id == now.c.loop_id)
    both = both.where((now.c.run_id == number) & now.c.newest & (before.c.run_id == earlier) & before.c.newest)
    both = both.where(now.c.verdict.in_(FAULTS) | before.c.verdict.in_(FAULTS))
    both = both.where(sa.or_(now.c.verdict != before.c.verdict, *apart))
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
    return [AssessmentRow(**values | {"stage": Stage(values["stage"])}) for values in found]


def _new(what: str, before: AssessmentRow | None, now: AssessmentRow | None) -> New:
    tag = next(row.tag for row in (now, before) if row is not None)
    verdicts = ["" if row is None else row.verdict for row in (before, now)]
    severities = ["" if row is None else row.severity for row in (before, now)]
    return New(tag, what, verdicts[0], verdicts[1], severities[0], severities[1])
