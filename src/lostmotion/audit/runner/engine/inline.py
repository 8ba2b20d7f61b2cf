"""In this process, one after another: for debugging. What kills its worker kills the audit."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from lostmotion.audit.runner.engine.protocol import Done, Lost, Task, Tried, done, one_line
from lostmotion.errors import EngineError, SetupError


class Inline:
    """No workers."""

    name = "inline"
    workers = 1

    def run(self, task: Task, batches: Iterable[tuple[Any, ...]]) -> Iterator[Done | Lost]:
        """Outcome of each item, in order."""
        from threadpoolctl import threadpool_limits  # noqa: PLC0415  workers need it not

        with threadpool_limits(1):
            for items in batches:
                yield from _outcome(task, Tried(items))

    def close(self) -> None:
        """Nothing to be ended."""


def _outcome(task: Task, batch: Tried) -> Iterator[Done | Lost]:
    try:
        yield Done(batch.items, done(task, batch.items))
    except SetupError as error:
        raise EngineError(str(error)) from error
    except Exception as error:  # noqa: BLE001  whatever it is, it is said of the item
        again, lost = batch.after_error(one_line(error))
        yield from lost
        for part in again:
            yield from _outcome(task, part)
