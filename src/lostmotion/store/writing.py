"""What is written into the tables, inside a transaction of the coordinator. Everything may be written twice."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from datetime import datetime
from typing import Any

import sqlalchemy as sa
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.engine import Connection

from lostmotion.store.encoded import clean, encoded
from lostmotion.store.rows import AssessmentRow, EstimateRow, GroupRow, SpectrumRow, TraceRow
from lostmotion.store.run_rows import LoopRow, UnreadRow
from lostmotion.store.schema import assessment, estimate, loop, member, oscillation_group, spectrum, trace, unread

Ids = Mapping[str, int]  # of loops, by tag
RANKED = ("label", "split", "priority", "priority_reason", "rule")


def upsert(connection: Connection, table: sa.Table, rows: Sequence[Mapping[str, Any]]) -> None:
    """Insert rows, or put them in the place of those with the same key."""
    if not rows:
        return
    dialect: Any = postgresql if connection.dialect.name == "postgresql" else sqlite
    statement = dialect.insert(table)
    key = list(table.primary_key)
    rest = {column.name: statement.excluded[column.name] for column in table.columns if not column.primary_key}
    statement = statement.on_conflict_do_update(index_elements=key, set_=rest)
    connection.execute(statement, list(rows))


def put_loops(connection: Connection, loops: Iterable[LoopRow]) -> dict[str, int]:
    """Numbers of the loops by tag; new ones are counted on, in the order in which they come."""
    known = ids(connection)
    rows = []
    for one in loops:
        tag = clean(one.tag)
        known.setdefault(tag, len(known) + 1)
        rows.append({"id": known[tag], "search": _search(one)} | encoded(one))
    upsert(connection, loop, rows)
    return known


def add_loops(connection: Connection, loops: Iterable[LoopRow]) -> dict[str, int]:
    """Numbers of the loops by tag; those that are known stay as the loop list of an audit has them."""
    known = ids(connection)
    return put_loops(connection, [one for one in loops if clean(one.tag) not in known])


def ids(connection: Connection) -> dict[str, int]:
    """Numbers of all loops by tag."""
    return {str(tag): int(number) for tag, number in connection.execute(sa.select(loop.c.tag, loop.c.id))}


def _search(one: LoopRow) -> str:
    """Databases disagree about upper case beyond ASCII: it is gone before they see it."""
    return clean("\n".join((one.tag, one.area, one.loop_type, one.op, one.pv, one.sp)).casefold())


def put_unread(connection: Connection, run: int, rows: Sequence[UnreadRow]) -> None:
    """What of the source gives no loop, in the place of what was said before."""
    connection.execute(unread.delete().where(unread.c.run_id == run))
    if rows:
        values = [{"run_id": run, "number": number} | encoded(one) for number, one in enumerate(rows, 1)]
        connection.execute(unread.insert(), values)


def forget(connection: Connection, run: int, loops: Sequence[int]) -> None:
    """All that a run says about loops."""
    for table in (assessment, spectrum, trace):
        connection.execute(table.delete().where((table.c.run_id == run) & table.c.loop_id.in_(loops)))


def put_screened(
    connection: Connection,
    run: int,
    known: Ids,
    rows: Sequence[tuple[AssessmentRow, int | None]],
    spectra: Sequence[SpectrumRow],
) -> None:
    """All windows of some loops, in the place of what the run said about them.

    Parameters
    ----------
    connection : Connection
    run : int
    known : mapping of str to int
    rows : sequence of (AssessmentRow, int or None)
        With the run in which it was assessed, if it was.
    spectra : sequence of SpectrumRow
    """
    forget(connection, run, sorted({known[clean(row.tag)] for row, _ in rows}))
    last: dict[str, datetime] = {}
    for row, _ in rows:
        last[row.tag] = max(row.window_start, last.get(row.tag, row.window_start))
    values = [
        _of_run(run, known, row)
        | {"screened_in": run, "assessed_in": before, "newest": row.window_start == last[row.tag]}
        for row, before in rows
    ]
    if values:
        connection.execute(assessment.insert(), values)
    if spectra:
        connection.execute(spectrum.insert(), [_of_run(run, known, one) for one in spectra])


def put_assessed(
    connection: Connection, run: int, known: Ids, rows: Sequence[AssessmentRow], traces: Sequence[TraceRow]
) -> None:
    """Windows that were screened before; where their spectra lie stays."""
    keys = [(known[clean(row.tag)], row.window_start) for row in rows]
    before = _kept(connection, run, [loop_id for loop_id, _ in keys])
    values = [
        _of_run(run, known, row) | before[key] | {"assessed_in": run} for key, row in zip(keys, rows, strict=True)
    ]
    upsert(connection, assessment, values)
    upsert(connection, trace, [_of_run(run, known, one) for one in traces])


def _kept(connection: Connection, run: int, loops: Sequence[int]) -> dict[tuple[int, datetime], dict[str, Any]]:
    """What the screen has left of rows, beside themselves."""
    table = assessment.c
    asked = sa.select(table.loop_id, table.window_start, table.screened_in, table.newest)
    found = connection.execute(asked.where((table.run_id == run) & table.loop_id.in_(loops)))
    return {(one.loop_id, one.window_start): {"screened_in": one.screened_in, "newest": one.newest} for one in found}


def _of_run(run: int, known: Ids, row: AssessmentRow | SpectrumRow | TraceRow) -> dict[str, Any]:
    return {"run_id": run, "loop_id": known[clean(row.tag)]} | encoded(row, "tag")


def put_ranks(connection: Connection, run: int, known: Ids, rows: Sequence[AssessmentRow], *names: str) -> None:
    """Some fields of rows that are there."""
    table = assessment.c
    here = (table.run_id == run) & (table.loop_id == sa.bindparam("of_loop"))
    statement = assessment.update().where(here & (table.window_start == sa.bindparam("of_window")))
    statement = statement.values({name: sa.bindparam(f"new_{name}") for name in names})
    values = []
    for row in rows:
        new = encoded(row)
        key = {"of_loop": known[clean(row.tag)], "of_window": row.window_start}
        values.append(key | {f"new_{name}": new[name] for name in names})
    if values:
        connection.execute(statement, values)


def put_groups(connection: Connection, run: int, known: Ids, groups: Sequence[GroupRow]) -> None:
    """Groups of a run, in the place of those that were there."""
    for table in (member, oscillation_group):
        connection.execute(table.delete().where(table.c.run_id == run))
    members = [
        {"run_id": run, "number": group.number, "place": place, "loop_id": known[clean(tag)], "window_start": start,
         "likeness": likeness, "score": score}
        for group in groups
        for place, (tag, start, likeness, score) in enumerate(group.members, 1)
    ]  # fmt: skip
    if groups:
        values = [{"run_id": run, "number": one.number} | encoded(one, "number", "members") for one in groups]
        connection.execute(oscillation_group.insert(), values)
    if members:
        connection.execute(member.insert(), members)


def put_estimates(connection: Connection, watch: int, known: Ids, rows: Sequence[EstimateRow]) -> None:
    """Estimates of watched loops; one of the same moment takes the place of the one before."""
    values = [{"watch_id": watch, "loop_id": known[clean(row.tag)]} | encoded(row, "tag") for row in rows]
    upsert(connection, estimate, values)
