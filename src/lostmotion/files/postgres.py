"""A PostgreSQL server that does not answer, or never ends to: the connection is closed after a stated time.

libpq waits for an answer as long as the connection stands, and a limit that is set in the server (statement_timeout)
holds only where the server keeps it. So each call has a limit here, whatever comes meanwhile.
"""

from __future__ import annotations

import time
from collections.abc import Generator
from functools import cache
from typing import TYPE_CHECKING, Any

from lostmotion.files.limits import MOST_SECONDS, most_seconds

if TYPE_CHECKING:
    from sqlalchemy.engine import Engine

LOGIN = 10  # s for the login
CALLS = 10.0  # times most_seconds(): a query of a large plant takes minutes


def limit_answers(engine: Engine) -> None:
    """Connections of an engine give up on a server that does not answer in time; of psycopg, no other driver."""
    if engine.dialect.driver != "psycopg":
        return
    from sqlalchemy import event  # noqa: PLC0415  who has an engine has it

    def connect(_: Any, __: Any, words: Any, settings: dict[str, Any]) -> Any:
        settings.setdefault("connect_timeout", LOGIN)
        return _limited().connect(*words, **settings)

    event.listen(engine, "do_connect", connect)


@cache
def _limited() -> Any:
    import psycopg  # noqa: PLC0415  comes with lostmotion[postgres]

    class LimitedConnection(psycopg.Connection[Any]):
        """Connection on which no call waits for ever."""

        def wait(self, gen: Any, *args: Any, **settings: Any) -> Any:
            """Answer of a call, or OperationalError; the connection is closed then."""
            return super().wait(_in_time(self, gen, CALLS * most_seconds()), *args, **settings)

    def _in_time(connection: Any, gen: Any, seconds: float) -> Generator[Any, Any, Any]:
        until = time.monotonic() + seconds
        try:
            wanted = next(gen)
            while True:
                ready = yield wanted
                if time.monotonic() > until:
                    connection.close()
                    error = f"no answer within {seconds:g} s; {MOST_SECONDS} allows more"
                    raise psycopg.OperationalError(error)
                wanted = gen.send(ready)
        except StopIteration as end:
            return end.value

    return LimitedConnection
