"""WatchStore: estimates of a running plant, written beside audits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from sqlalchemy.engine import Connection

from lostmotion.files.paths import is_file
from lostmotion.store import runs, watches, writing
from lostmotion.store.connect import lock
from lostmotion.store.rows import EstimateRow
from lostmotion.store.run_rows import LoopRow, RunState, WatchRow
from lostmotion.store.said import store_error
from lostmotion.store.schema import watch
from lostmotion.store.store import ROWS, Store


class WatchStore(Store):
    """A store that a watch writes into; see :class:`lostmotion.store.store.Store`."""

    def begin_watch(self, wanted: WatchRow, loops: Sequence[LoopRow]) -> int:
        """Number of the watch; loops that no audit has brought are added.

        Raises
        ------
        FileAccessError
            Another process watches one of the loops, or the store cannot be written.
        """
        with self._writing() as connection:
            lock(connection)
            self._ids = writing.add_loops(connection, loops)
            return watches.begin(connection, wanted, self.me, self.name)

    def put_estimates(self, number: int, rows: Sequence[EstimateRow] = ()) -> None:
        """Write estimates, and a beat of the heart also where there are none.

        Raises
        ------
        FileAccessError
            The store cannot be written, or another process has taken the watch over.
        """
        for first in range(0, max(len(rows), 1), ROWS):
            with self._of_watch(number) as connection:
                writing.put_estimates(connection, number, self._ids, rows[first : first + ROWS])

    def end_watch(self, number: int, note: str = "") -> None:
        """Stop a watch; the next one of the same goes on with it."""
        with self._of_watch(number) as connection:
            runs.end(connection, number, RunState.STOPPED, note, watch)

    @contextmanager
    def _of_watch(self, number: int) -> Iterator[Connection]:
        """Transaction on a connection of its own: one that is kept would write on into a file that was taken away."""
        if self.engine.dialect.name == "sqlite" and not is_file(Path(self.name)):
            raise store_error(self.name, "no such file", "put it back, or start again")
        try:
            with self._writing() as connection:
                runs.beat(connection, number, self.me, self.name, watch)
                yield connection
        finally:
            self.engine.dispose()
