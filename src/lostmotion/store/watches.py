"""Begin a watch of loops, or go on with one: any number of them, and audits, in one store, but each loop once."""

from __future__ import annotations

import json
from collections.abc import Collection
from dataclasses import replace

import sqlalchemy as sa
from sqlalchemy.engine import Connection, RowMapping

from lostmotion.errors import FileAccessError
from lostmotion.store.alive import where
from lostmotion.store.encoded import decoded, encoded
from lostmotion.store.rows import EstimateRow
from lostmotion.store.run_rows import RunState, WatchRow
from lostmotion.store.runs import OPEN, abandon, at_work, newest, now
from lostmotion.store.schema import estimate, loop, watch

SAME = ("source", "tags", "digest")  # what a watch that is gone on with has in common


def begin(connection: Connection, wanted: WatchRow, me: str, name: str) -> int:
    """Number of the watch: of the one that was stopped or killed, where it is the same.

    Raises
    ------
    FileAccessError
        Another process watches one of the loops into this store.
    """
    moment = now(connection)
    asked = sa.select(watch).where(watch.c.state.in_(OPEN)).order_by(watch.c.id.desc())
    left = [one for one in connection.execute(asked).mappings() if _common(one, wanted.tags)]
    for one in left:
        if one["coordinator"] != me and at_work(one, moment):
            raise FileAccessError(
                f"expected loops that nobody else watches into the store {name!r}, got {_common(one, wanted.tags)[0]} "
                f"of watch {one['id']} of {where(one['coordinator'])}, whose heart beats; stop it, or leave them out"
            )
    values = encoded(wanted)
    again = next((one["id"] for one in left if all(one[key] == values[key] for key in SAME)), None)
    abandon(connection, [one["id"] for one in left if one["id"] != again], moment, watch)
    mine = {"state": RunState.RUNNING, "heartbeat": moment, "coordinator": me, "ended": None, "note": ""}
    if again is not None:
        connection.execute(watch.update().where(watch.c.id == again).values(mine))
        return int(again)
    number = newest(connection, watch) + 1
    connection.execute(watch.insert().values(encoded(replace(wanted, number=number, began=moment)) | mine))
    return number


def _common(one: RowMapping, tags: Collection[str]) -> list[str]:
    return sorted(set(json.loads(one["tags"])) & set(tags))


def watches(connection: Connection) -> list[WatchRow]:
    """Watches, the newest first."""
    return [
        decoded(WatchRow, one) for one in connection.execute(sa.select(watch).order_by(watch.c.id.desc())).mappings()
    ]


def estimates(connection: Connection, tag: str, limit: int | None = None) -> list[tuple[int, EstimateRow]]:
    """Estimates of a loop with the number of their watch, the newest first."""
    asked = sa.select(estimate).join(loop).where(loop.c.tag == tag).order_by(estimate.c.at.desc(), estimate.c.watch_id)
    found = connection.execute(asked.limit(limit)).mappings()
    return [(one["watch_id"], decoded(EstimateRow, one, tag=tag)) for one in found]
