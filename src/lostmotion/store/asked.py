"""What can be asked of a store, each in a transaction of its own."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from datetime import datetime
from typing import Any

from sqlalchemy.engine import Connection, Engine

from lostmotion.store import queries, watches
from lostmotion.store.changed import New
from lostmotion.store.judged import Judged
from lostmotion.store.news import news
from lostmotion.store.overview import Columns, judged, leading
from lostmotion.store.queries import Filter, Line, Lines
from lostmotion.store.rows import AssessmentRow, EstimateRow, GroupRow, SpectrumRow, TraceRow
from lostmotion.store.run_rows import LoopRow, ReviewRow, ReviewState, RunRow, UnreadRow, WatchRow
from lostmotion.store.said import content, told


class Asked:
    """Questions of pages; `run` is the number of a run. Without an answer: None or nothing, no error."""

    name: str
    engine: Engine

    @contextmanager
    def _reading(self) -> Iterator[Connection]:
        with (
            told(self.name),
            self.engine.connect() as connection,
            connection.begin(),
            content(self.name, self.engine, LookupError, ArithmeticError, TypeError),
        ):
            yield connection

    def stamp(self) -> tuple[Any, ...]:
        """What changes with every review and every write of an audit; as long as it is the same so is every answer."""
        with self._reading() as connection:
            return queries.stamp(connection)

    def runs(self, limit: int | None = None) -> list[RunRow]:
        """Runs, the newest first."""
        with self._reading() as connection:
            return queries.runs(connection, limit)

    def run(self, number: int) -> RunRow | None:
        """A run by its number."""
        with self._reading() as connection:
            return queries.one_run(connection, number)

    def last_run(self, before: int | None = None) -> RunRow | None:
        """The newest finished run (before another one); without one the newest that has begun."""
        with self._reading() as connection:
            return queries.last_run(connection, before)

    def lines(self, run: int, chosen: Filter | None = None, **how: Any) -> Lines:
        """Page of the table; `how`: sort, descending, limit, offset as :func:`lostmotion.store.queries.lines` has them.

        Raises
        ------
        ParameterError
            No such column to sort by.
        """
        with self._reading() as connection:
            return queries.lines(connection, run, chosen or Filter(), **how)

    def leading(self, run: int) -> tuple[Columns, Columns]:
        """One narrow line a loop, of its window that says most, and all loops, as columns."""
        with self._reading() as connection:
            return leading(connection, run)

    def judged(self, run: int) -> list[Judged]:
        """Whether each loop was judged, and what is said of its data."""
        with self._reading() as connection:
            return list(judged(connection, run))

    def at(self, run: int, keys: Sequence[tuple[int, datetime]], brief: bool = False) -> tuple[Line, ...]:
        """Lines of some loops (by number) and windows, in this order; `brief`: without the lines of evidence."""
        with self._reading() as connection:
            return queries.at(connection, run, keys, brief)

    def states(self) -> dict[int, ReviewState]:
        """Last review of every loop that was reviewed, by number."""
        with self._reading() as connection:
            return queries.last_reviews(connection)

    def windows(self, run: int, tag: str) -> list[AssessmentRow]:
        """All windows of a loop in a run."""
        with self._reading() as connection:
            return queries.windows(connection, run, tag)

    def counts(self, run: int) -> dict[str, dict[str, int]]:
        """Rows by what is said, severity, label, split and stage: how many of each word."""
        with self._reading() as connection:
            return queries.counts(connection, run)

    def areas(self, run: int) -> list[tuple[str, str, str, int]]:
        """Area, what is said, severity, and how many rows."""
        with self._reading() as connection:
            return queries.areas(connection, run)

    def rows(self, run: int) -> list[AssessmentRow]:
        """All rows of a run by tag and window."""
        with self._reading() as connection:
            return list(queries.rows(connection, run))

    def loop(self, tag: str) -> LoopRow | None:
        """A loop as the last loop list had it."""
        with self._reading() as connection:
            return queries.one_loop(connection, tag)

    def loops(self) -> list[LoopRow]:
        """All loops of the store by tag."""
        with self._reading() as connection:
            return queries.loops(connection)

    def history(self, tag: str, limit: int | None = None) -> list[tuple[RunRow, AssessmentRow]]:
        """What the runs said of one loop, the newest first."""
        with self._reading() as connection:
            return queries.history(connection, tag, limit)

    def watches(self) -> list[WatchRow]:
        """Watches of a running plant, the newest first."""
        with self._reading() as connection:
            return watches.watches(connection)

    def estimates(self, tag: str, limit: int | None = None) -> list[tuple[int, EstimateRow]]:
        """What watches said of one loop, the newest first, each with the number of its watch."""
        with self._reading() as connection:
            return watches.estimates(connection, tag, limit)

    def groups(self, run: int) -> tuple[GroupRow, ...]:
        """Groups of a run with their members."""
        with self._reading() as connection:
            return queries.groups(connection, run)

    def spectra(self, run: int, tags: Iterable[str] | None = None) -> list[SpectrumRow]:
        """Spectra of a run by tag and window."""
        with self._reading() as connection:
            return list(queries.spectra(connection, run, tags))

    def traces(self, run: int, tag: str) -> list[TraceRow]:
        """Traces of a loop in a run, by window."""
        with self._reading() as connection:
            return queries.traces(connection, run, tag)

    def unread(self, run: int) -> list[UnreadRow]:
        """What of the source gave no loop."""
        with self._reading() as connection:
            return queries.unreadable(connection, run)

    def reviews(self, tag: str) -> list[ReviewRow]:
        """Reviews of a loop, the oldest first."""
        with self._reading() as connection:
            return queries.reviews(connection, tag)

    def news(self, run: int, earlier: int | None = None, limit: int | None = None) -> list[New]:
        """What is new in a run since another one; without: since the last finished one before it."""
        with self._reading() as connection:
            if earlier is None:
                found = queries.last_run(connection, run)
                earlier = found.number if found else 0
            return news(connection, run, earlier, limit)
