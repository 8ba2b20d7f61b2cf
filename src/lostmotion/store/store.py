"""Store: results of audits in one database. The coordinator writes; pages ask."""

from __future__ import annotations

import contextlib
import os
import threading
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Self

import sqlalchemy as sa
from sqlalchemy.engine import Connection, Engine

from lostmotion.errors import FileAccessError, LostMotionError, ParameterError
from lostmotion.store import carry, news, queries, runs, writing
from lostmotion.store.alive import BEAT, coordinator
from lostmotion.store.asked import Asked
from lostmotion.store.connect import PATIENCE, connected, lock, shown, store_url
from lostmotion.store.encoded import clean, encoded
from lostmotion.store.rows import AssessmentRow, GroupRow, SpectrumRow, Stage, TraceRow
from lostmotion.store.run_rows import LoopRow, ReviewRow, ReviewState, RunRow, RunState, UnreadRow
from lostmotion.store.said import content, told
from lostmotion.store.schema import assessment, review

ROWS = 500  # of a transaction, about: more is no faster, and holds the writer's lock for longer


@dataclass(frozen=True)
class Screened:
    """All windows of one loop.

    Attributes
    ----------
    rows : tuple of AssessmentRow
        At least one: a loop without any is not done.
    spectra : tuple of SpectrumRow
    """

    rows: tuple[AssessmentRow, ...]
    spectra: tuple[SpectrumRow, ...] = ()


class Store(Asked):
    """Results of audits in a database; what can be asked of it stands in :class:`lostmotion.store.asked.Asked`.

    Parameters
    ----------
    address : str or path
        A file, ``sqlite:///plant.db`` or ``postgresql://user@host/plant``.
    write : bool
        Make it if it is not there. Without: it must be there, and is only read.
    patience : float
        Seconds in which a server may come up, and for which a lock is waited for.

    Raises
    ------
    FileAccessError
        No store, one of another version, or none that can be opened.
    """

    def __init__(self, address: str | os.PathLike[str], *, write: bool = True, patience: float = PATIENCE) -> None:
        self.name = shown(store_url(address))
        self.engine: Engine = connected(address, write=write, patience=patience)
        self.me = coordinator()
        self._ids: dict[str, int] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close all connections."""
        self.engine.dispose()

    @contextmanager
    def _writing(self, run: int | None = None) -> Iterator[Connection]:
        """Transaction; of a run: only while it is this coordinator's."""
        with (
            told(self.name),
            self.engine.connect().execution_options(writing=True) as connection,
            connection.begin(),
            content(self.name, self.engine),
        ):
            if run is not None:
                runs.beat(connection, run, self.me, self.name)
            yield connection

    # ------------------------------------------------------------------ runs
    def begin(self, wanted: RunRow, *, resume: bool = True) -> tuple[int, bool]:
        """Begin a run, or go on with the last one if it was not finished and is the same.

        Returns
        -------
        (int, bool)
            Number of the run, and whether it was begun before.

        Raises
        ------
        FileAccessError
            Another audit is at work in this store.
        """
        with self._writing() as connection:
            lock(connection)
            return runs.begin(connection, wanted, self.me, resume=resume, name=self.name)

    @contextmanager
    def beating(self, run: int, every: float = BEAT) -> Iterator[None]:
        """The heart of a run beats while the block is at work, also where that computes for minutes."""
        ended = threading.Event()

        def beats() -> None:
            while not ended.wait(every):
                with contextlib.suppress(LostMotionError), self._writing(run):  # told at the next writing
                    pass

        thread = threading.Thread(target=beats, name="heartbeat", daemon=True)
        thread.start()
        try:
            yield
        finally:
            ended.set()
            thread.join()

    def finish(self, run: int, state: RunState = RunState.FINISHED, note: str = "") -> None:
        """End a run; what is new in one that was finished is written down with its end."""
        with self._writing(run) as connection:
            before = queries.last_run(connection, run) if state is RunState.FINISHED else None
            if before is not None:
                news.keep(connection, run, before.number)
            runs.end(connection, run, state, note)

    # --------------------------------------------------------------- writing
    def put_loops(self, run: int, loops: Sequence[LoopRow], unread: Sequence[UnreadRow] = ()) -> None:
        """Loops of the source, and what of it gives none; must come before their rows.

        What the run says of loops that the source no longer has is forgotten.
        """
        with self._writing(run) as connection:
            lock(connection)  # who watches loops may add some
            self._ids = writing.put_loops(connection, loops)
            writing.put_unread(connection, run, unread)
            wanted = {self._ids[clean(one.tag)] for one in loops}
            gone = sorted(set(carry.stamps(connection, run)) - wanted)
            for first in range(0, len(gone), carry.BLOCK):
                writing.forget(connection, run, gone[first : first + carry.BLOCK])

    def put_screened(self, run: int, loops: Sequence[Screened]) -> None:
        """Rows of loops that were screened, in transactions of about 500; a loop's rows are written together.

        What an earlier run has assessed (same window, data, settings, code, definition) takes the place of a row.
        """
        part: list[Screened] = []
        for number, one in enumerate(loops, 1):
            part.append(one)
            if number == len(loops) or sum(len(of.rows) for of in part) >= ROWS:
                self._put_screened(run, part)
                part = []

    def _put_screened(self, run: int, loops: Sequence[Screened]) -> None:
        with self._writing(run) as connection:
            rows = [row for one in loops for row in one.rows]
            known = carry.assessed_before(
                connection, run, sorted({self._ids[clean(row.tag)] for row in rows}), self._before(connection, run)
            )
            spectra = [one for of in loops for one in of.spectra]
            writing.put_screened(connection, run, self._ids, [_carried(row, known) for row in rows], spectra)

    def _before(self, connection: Connection, run: int) -> list[int]:
        return carry.before(connection, run, period=False)

    def put_assessed(self, run: int, rows: Sequence[AssessmentRow], traces: Sequence[TraceRow] = ()) -> None:
        """Rows that were screened before, and now are assessed or failed."""
        for first in range(0, len(rows), ROWS):
            part = rows[first : first + ROWS]
            keys = {(row.tag, row.window_start) for row in part}
            with self._writing(run) as connection:
                own = [one for one in traces if (one.tag, one.window_start) in keys]
                writing.put_assessed(connection, run, self._ids, part, own)

    def put_ranks(self, run: int, rows: Sequence[AssessmentRow], *names: str) -> None:
        """Some fields of rows that are there; of a ranking its own."""
        for first in range(0, len(rows), ROWS):
            with self._writing(run) as connection:
                writing.put_ranks(connection, run, self._ids, rows[first : first + ROWS], *(names or writing.RANKED))

    def put_groups(self, run: int, groups: Sequence[GroupRow]) -> None:
        """Groups of a run, in the place of those that were there."""
        with self._writing(run) as connection:
            writing.put_groups(connection, run, self._ids, groups)

    def review(self, tag: str, state: ReviewState, who: str, note: str = "", at: datetime | None = None) -> None:
        """Put down what somebody has decided about a loop.

        Raises
        ------
        ParameterError
            No such loop.
        """
        with self._writing() as connection:
            lock(connection)
            loop_id = writing.ids(connection).get(tag)
            if loop_id is None:
                raise ParameterError.expected("a loop of the store", repr(tag), "check the tag")
            number = connection.execute(sa.select(sa.func.coalesce(sa.func.max(review.c.id), 0))).scalar_one() + 1
            values = encoded(ReviewRow(tag, state, who, at or datetime.now(UTC), note), "tag")
            connection.execute(review.insert().values(values | {"id": number, "loop_id": loop_id}))

    # ----------------------------------------------------------- what is done
    def done(self, run: int, wanted: Mapping[str, carry.Known]) -> set[str]:
        """Loops of the source that this run need not look at: done in it, or carried over now from an earlier one.

        A loop of this run whose stamp or definition is another now is not done.
        """
        with self._reading() as connection:
            here = carry.stamps(connection, run)
            known = {self._ids[clean(tag)]: one for tag, one in wanted.items()}
            done = {loop_id for loop_id, one in known.items() if here.get(loop_id) == one}
            missing = {loop_id: one for loop_id, one in known.items() if loop_id not in done}
            found = carry.unchanged(connection, run, missing)
        for earlier, loops in found.items():
            self._carry(run, earlier, loops)
            done.update(loops)
        return {tag for tag in wanted if self._ids[clean(tag)] in done}

    def _carry(self, run: int, earlier: int, loops: Sequence[int]) -> None:
        for first in range(0, len(loops), carry.BLOCK):
            part = loops[first : first + carry.BLOCK]
            with self._writing(run) as connection:
                writing.forget(connection, run, part)
                carry.copy(connection, earlier, run, part)

    def worth(self, run: int) -> list[tuple[str, datetime]]:
        """Windows that were screened only and are worth an assessment, the most valuable first."""
        with self._reading() as connection:
            columns = assessment.c
            asked = sa.select(columns.loop_id, columns.window_start)
            asked = asked.where((columns.run_id == run) & (columns.stage == Stage.SCREENED) & (columns.value > 0.0))
            order = (columns.value.desc(), columns.loop_id, columns.window_start)
            tags = {number: tag for tag, number in writing.ids(connection).items()}
            return [(tags[loop_id], start) for loop_id, start in connection.execute(asked.order_by(*order))]

    def spent(self, run: int) -> float:
        """Processor seconds of the rows that were assessed in this run itself."""
        with self._reading() as connection:
            mine = (assessment.c.run_id == run) & (assessment.c.assessed_in == run)
            found = connection.execute(sa.select(sa.func.coalesce(sa.func.sum(assessment.c.seconds), 0.0)).where(mine))
            return float(found.scalar_one())

    def chosen(self, run: int, keys: Iterable[tuple[str, datetime]]) -> list[AssessmentRow]:
        """Rows of some windows, in the order of the keys."""
        wanted = list(keys)
        with self._reading() as connection:
            lines = queries.at(connection, run, [(self._ids[tag], start) for tag, start in wanted])
        return [line.row for line in lines]


def _carried(
    row: AssessmentRow, known: Mapping[tuple[str, datetime, str, str], tuple[AssessmentRow, int]]
) -> tuple[AssessmentRow, int | None]:
    """The earlier assessment of the same data, with the stamp that its source has now."""
    before = known.get((clean(row.tag), row.window_start, row.fingerprint, row.definition))
    if before is None or row.stage is Stage.FAILED:
        return row, None
    return carry.with_stamp(before[0], row.stamp), before[1]


__all__ = ["FileAccessError", "Screened", "Store"]
