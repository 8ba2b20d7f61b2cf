"""Processes of this machine, one thread each. A dead worker costs its batch a try, not the run."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from typing import Any

from lostmotion.audit.runner.engine.protocol import Done, Lost, Task, Tried, done, one_line
from lostmotion.workers import Outcome, Pool, WorkerDiedError


class Processes:
    """Engine of processes on this machine.

    Parameters
    ----------
    workers : int
    """

    name = "processes"

    def __init__(self, workers: int) -> None:
        self.workers = workers
        self._pool = Pool(workers)

    def run(self, task: Task, batches: Iterable[tuple[Any, ...]]) -> Iterator[Done | Lost]:
        """Outcome of each item, as batches are done; see :class:`lostmotion.audit.runner.engine.Engine`."""
        source, again, pool = map(Tried, batches), deque[Tried](), self._pool
        pool.share(task)
        try:
            while True:
                while pool.free and (batch := again.popleft() if again else next(source, None)) is not None:
                    pool.give(batch, done, batch.items)
                if not pool.busy:
                    return
                parts, outcome = _outcome(pool.take())
                again.extend(parts)
                yield from outcome
        finally:  # a run that is broken off leaves workers with batches that nobody waits for
            pool.drop()

    def close(self) -> None:
        """End all workers at once."""
        self._pool.close()


def _outcome(one: Outcome) -> tuple[list[Tried], list[Done | Lost]]:
    """What becomes of a batch: what is tried again, and what is done."""
    batch: Tried = one.call
    if one.error is None:
        return [], [Done(batch.items, one.value)]
    died = isinstance(one.error, WorkerDiedError)
    again, lost = batch.after_death() if died else batch.after_error(one_line(one.error))
    return again, list(lost)
