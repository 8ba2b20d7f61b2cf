"""What a page keeps of a run: one narrow line for every loop, and why loops could not be judged."""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import lru_cache
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from lostmotion.store.judged import Judged
from lostmotion.store.rows import FINDINGS, Stage
from lostmotion.store.schema import assessment, loop, said

OF_LOOP = ("tag", "area", "type", "search")
OF_ROW = (  # all of them in the index assessment_page: the rows themselves are not read
    "verdict", "rule", "label", "split", "stage", "priority", "size_percent", "excluded_percent", "confidence",
    "probability", "period", "power", "harris", "variability", "travel", "manual", "limited", "missing",
)  # fmt: skip
Columns = dict[str, tuple[Any, ...]]  # by name, for data frames: rows one by one would take longer than the query
STAGES = {str(stage): stage for stage in Stage}


def leading(connection: Connection, number: int) -> tuple[Columns, Columns]:
    """Of every loop of a run the window that says most; and all loops.

    Parameters
    ----------
    connection : Connection
    number : int
        Of the run.

    Returns
    -------
    (dict, dict)
        Columns by name: "loop_id", "window_start" (as the driver has it) and OF_ROW; "loop_id" and OF_LOOP.
    """
    start = sa.type_coerce(assessment.c.window_start, sa.Text).label("window_start")
    columns = [assessment.c.loop_id, start, *(assessment.c[name] for name in OF_ROW)]
    rows = _columns(connection, sa.select(*columns).where(_says_most(connection, number)))
    loops = sa.select(loop.c.id.label("loop_id"), *(loop.c[name] for name in OF_LOOP))
    return rows, _columns(connection, loops)


def _columns(connection: Connection, asked: sa.Select[Any]) -> Columns:
    """Values as the driver has them, without SQLAlchemy's rows."""
    found = connection.execute(asked)
    names, rows = list(found.keys()), found.cursor.fetchall()
    return dict(zip(names, zip(*rows, strict=True) if rows else [()] * len(names), strict=True))


def judged(connection: Connection, number: int) -> Iterator[Judged]:
    """The same windows, with what is said of them in words."""
    columns = (getattr(assessment.c, name) for name in Judged._fields if name != "tag")
    asked = sa.select(loop.c.tag, *columns).join_from(assessment, loop, loop.c.id == assessment.c.loop_id)
    for values in connection.execute(asked.where(_says_most(connection, number))):
        tag, stage, verdict, rule, fit, error, reason, why, health = values
        yield Judged(tag, STAGES[stage], verdict, rule, bool(fit), error, reason, why, _texts(health))


@lru_cache(maxsize=4096)
def _texts(health: str) -> tuple[str, ...]:
    return tuple(json.loads(health))


def _says_most(connection: Connection, number: int) -> Any:
    """One window of each loop: highest priority, then assessed, a finding, latest."""
    here = assessment.c.run_id == number
    older = sa.select(assessment.c.loop_id).where(here & ~assessment.c.newest).limit(1)
    if connection.execute(older).first() is None:
        return here & assessment.c.newest
    order = (
        sa.func.coalesce(assessment.c.priority, -1.0).desc(),
        sa.case((assessment.c.stage == Stage.ASSESSED, 0), else_=1),
        sa.case((said(assessment).in_(FINDINGS), 0), else_=1),
        assessment.c.window_start.desc(),
    )
    place = sa.func.row_number().over(partition_by=assessment.c.loop_id, order_by=order).label("place")
    placed = sa.select(assessment.c.loop_id, assessment.c.window_start, place).where(here).subquery()
    first = sa.select(placed.c.loop_id, placed.c.window_start).where(placed.c.place == 1)
    return here & sa.tuple_(assessment.c.loop_id, assessment.c.window_start).in_(first)
