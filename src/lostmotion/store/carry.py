"""What an earlier run has done with the same loop, data, settings and code is carried over, not done again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from lostmotion.store.encoded import decoded
from lostmotion.store.rows import AssessmentRow, Stage
from lostmotion.store.run_rows import RunRow
from lostmotion.store.schema import assessment, loop, run

BLOCK = 400  # loops of a statement: SQLite allows 999 variables where it is old


@dataclass(frozen=True)
class Known:
    """What decides, beside the settings and the code, whether a loop must be looked at again.

    Attributes
    ----------
    stamp : str
        Of its data in the source; empty: not known without reading.
    definition : str
        Of what the loop list says.
    """

    stamp: str
    definition: str


def in_run(connection: Connection, number: int) -> dict[int, Known | None]:
    """Loops that a run has rows of, by number; None: its rows differ in stamp, or some failed."""
    columns = assessment.c
    asked = sa.select(columns.loop_id, columns.stamp, columns.definition, columns.stage).where(columns.run_id == number)
    found: dict[int, Known | None] = {}
    for loop_id, stamp, definition, stage in connection.execute(asked):
        one = None if stage == Stage.FAILED else Known(stamp, definition)
        found[loop_id] = one if found.get(loop_id, one) == one else None
    return found


def stamps(connection: Connection, number: int) -> dict[int, Known]:
    """The same of the run that is gone on with: what failed in it is done, too."""
    columns = assessment.c
    asked = sa.select(columns.loop_id, columns.stamp, columns.definition).where(columns.run_id == number)
    return {loop_id: Known(stamp, definition) for loop_id, stamp, definition in connection.execute(asked)}


def before(connection: Connection, number: int, *, period: bool) -> list[int]:
    """Earlier runs with the same settings and code, the newest first; `period`: and the same since and until."""
    asked = connection.execute(sa.select(run).where(run.c.id == number)).mappings().one()
    same = (run.c.digest == asked["digest"]) & (run.c.code == asked["code"]) & (run.c.id < number)
    for name in ("since", "until") if period else ():
        same &= run.c[name].is_not_distinct_from(asked[name])
    return list(connection.scalars(sa.select(run.c.id).where(same).order_by(run.c.id.desc())))


def unchanged(connection: Connection, number: int, wanted: Mapping[int, Known]) -> dict[int, list[int]]:
    """Loops whose rows can be carried over without reading, by the run that has them."""
    left = {loop_id: one for loop_id, one in wanted.items() if one.stamp}
    found: dict[int, list[int]] = {}
    for earlier in before(connection, number, period=True):
        if not left:
            break
        there = in_run(connection, earlier)
        same = [loop_id for loop_id, one in left.items() if there.get(loop_id) == one]
        if same:
            found[earlier] = same
        for loop_id in same:
            del left[loop_id]
    return found


def copy(connection: Connection, earlier: int, number: int, loops: Sequence[int]) -> None:
    """Rows of an earlier run as rows of this one; spectra and traces stay where they are."""
    names = [column.name for column in assessment.columns if column.name != "run_id"]
    columns = [assessment.c[name] for name in names]
    chosen = (assessment.c.run_id == earlier) & assessment.c.loop_id.in_(loops)
    rows = sa.select(sa.literal(number), *columns).where(chosen).order_by(assessment.c.loop_id)
    connection.execute(assessment.insert().from_select(["run_id", *names], rows))


def assessed_before(
    connection: Connection, number: int, loops: Sequence[int], earlier: Sequence[int]
) -> dict[tuple[str, datetime, str, str], tuple[AssessmentRow, int]]:
    """Assessed rows of earlier runs by tag, window, fingerprint and definition, with the run that made them."""
    columns = assessment.c
    asked = sa.select(loop.c.tag, assessment).join_from(assessment, loop, columns.loop_id == loop.c.id)
    asked = asked.where(columns.loop_id.in_(loops) & (columns.stage == Stage.ASSESSED) & (columns.run_id < number))
    allowed = set(earlier)
    found: dict[tuple[str, datetime, str, str], tuple[AssessmentRow, int]] = {}
    for values in connection.execute(asked.order_by(columns.run_id.desc())).mappings():
        key = (values["tag"], values["window_start"], values["fingerprint"], values["definition"])
        if values["run_id"] in allowed and values["fingerprint"] and key not in found:
            found[key] = assessment_row(values), values["assessed_in"]
    return found


def assessment_row(values: Mapping[Any, Any]) -> AssessmentRow:
    """Row of an assessment, of a query that names the tag."""
    return decoded(AssessmentRow, values)


def run_row(values: Mapping[Any, Any]) -> RunRow:
    """Row of a run."""
    return decoded(RunRow, values)


def with_stamp(row: AssessmentRow, stamp: str) -> AssessmentRow:
    """The same, of a source that was written again without another value in the window."""
    return replace(row, stamp=stamp)
