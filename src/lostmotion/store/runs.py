"""Begin, go on with, keep alive and end a run: one coordinator at a time. What runs and watches have in common."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from datetime import UTC, datetime

import sqlalchemy as sa
from sqlalchemy.engine import Connection, RowMapping

from lostmotion.errors import FileAccessError
from lostmotion.store.alive import lives, where
from lostmotion.store.encoded import encoded
from lostmotion.store.run_rows import RunRow, RunState
from lostmotion.store.schema import run

SAME = ("source", "digest", "code", "since", "until", "screen_only")  # what a run that is gone on with has in common
OPEN = (RunState.RUNNING, RunState.STOPPED)


def now(connection: Connection) -> datetime:
    """The clock that all coordinators of a store share."""
    if connection.dialect.name == "postgresql":
        moment: datetime = connection.execute(sa.select(sa.func.clock_timestamp())).scalar_one()
        return moment.astimezone(UTC)
    return datetime.now(UTC)


def begin(connection: Connection, wanted: RunRow, me: str, *, resume: bool, name: str) -> tuple[int, bool]:
    """Number of the run, and whether it was begun before.

    Raises
    ------
    FileAccessError
        Another audit is at work.
    """
    moment = now(connection)
    open_runs = connection.execute(sa.select(run).where(run.c.state.in_(OPEN)).order_by(run.c.id.desc())).mappings()
    left = open_runs.all()
    _refuse_living(left, moment, name)
    last = left[0] if left else None
    again = resume and last is not None and newest(connection) == last["id"] and _same(last, wanted)
    abandon(connection, [one["id"] for one in left[1 if again else 0 :]], moment)
    values = {"state": RunState.RUNNING, "heartbeat": moment, "coordinator": me, "ended": None, "note": ""}
    if again and last is not None:
        values |= {"engine": wanted.engine, "workers": wanted.workers, "settings": wanted.settings}
        connection.execute(run.update().where(run.c.id == last["id"]).values(values))
        return int(last["id"]), True
    number = newest(connection) + 1
    new = encoded(replace(wanted, number=number, began=moment))
    connection.execute(run.insert().values(new | values))
    return number, False


def newest(connection: Connection, of: sa.Table = run) -> int:
    """Number of the run (or watch) that began last; 0: none."""
    return int(connection.execute(sa.select(sa.func.coalesce(sa.func.max(of.c.id), 0))).scalar_one())


def _refuse_living(left: Iterable[RowMapping], moment: datetime, name: str) -> None:
    for one in left:
        if at_work(one, moment):
            raise FileAccessError(
                f"expected a store {name!r} in which no audit is at work, got run {one['id']} "
                f"of {where(one['coordinator'])}, whose heart beats; wait for its end, or stop it"
            )


def at_work(one: RowMapping, moment: datetime) -> bool:
    """Whether the coordinator of a run (or watch) lives."""
    return one["state"] == RunState.RUNNING and lives(one["coordinator"], one["heartbeat"], moment)


def _same(last: RowMapping, wanted: RunRow) -> bool:
    values = encoded(wanted)
    return all(last[one] == values[one] for one in SAME)


def abandon(connection: Connection, numbers: list[int], moment: datetime, of: sa.Table = run) -> None:
    """Nobody will go on with them."""
    if numbers:
        values = {"state": RunState.ABANDONED, "ended": moment}
        connection.execute(of.update().where(of.c.id.in_(numbers)).values(values))


def beat(connection: Connection, number: int, me: str, name: str, of: sa.Table = run) -> None:
    """One beat of the heart; at the beginning of every transaction that writes, too.

    Raises
    ------
    FileAccessError
        Another process has taken the run (or watch) over: this one was silent for too long.
    """
    mine = (of.c.id == number) & (of.c.coordinator == me) & (of.c.state == RunState.RUNNING)
    done = connection.execute(of.update().where(mine).values(heartbeat=now(connection)))
    if done.rowcount != 1:
        other = "audit" if of is run else "process"
        raise FileAccessError(
            f"expected {of.name} {number} of the store {name!r} to be this one's, got one that another {other} has "
            "taken over; let that one finish"
        )


def end(connection: Connection, number: int, state: RunState, note: str, of: sa.Table = run) -> None:
    """The run (or watch) is over."""
    values = {"state": state, "ended": now(connection), "note": note}
    connection.execute(of.update().where(of.c.id == number).values(values))
