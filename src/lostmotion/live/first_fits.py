"""First fits in a process beside: they take a tenth of a second each, and come for all loops at the same time."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from typing import Any, Self

from lostmotion.audit.runner.engine.processes import Processes
from lostmotion.audit.runner.engine.protocol import Done, Task
from lostmotion.errors import EngineError
from lostmotion.files.grid import Rows
from lostmotion.live.warm import warm
from lostmotion.online.monitor import OnlineMonitor
from lostmotion.online.service import Found, at_once

Item = tuple[bytes, Rows]


class FirstFits:
    """A worker that takes rows for a monitor; the same bits, because a monitor goes on from its bytes.

    Notes
    -----
    In the process of the link a fit, which is Python for the most part, would hold up values and rows of all other
    loops. Where the worker cannot be had the rows are taken here: late, but the same.
    """

    def __init__(self) -> None:
        self._engine = Processes(1)

    def __enter__(self) -> Self:
        with suppress(EngineError):
            self._asked(Task("lostmotion.live.first_fits:begun"), None)
        return self

    def __exit__(self, *_: object) -> None:
        self._engine.close()

    def take(self, monitor: OnlineMonitor, rows: Rows) -> Found:
        """Take rows; see :meth:`OnlineMonitor.take`. One call at a time."""
        try:
            answer = self._asked(Task("lostmotion.live.first_fits:taken"), (monitor.to_bytes(), rows))
        except EngineError:
            answer = None
        if answer is None:
            return at_once(monitor, rows)
        data, messages = answer
        return OnlineMonitor.from_bytes(data), messages

    def _asked(self, task: Task, item: Item | None) -> Any:
        for outcome in self._engine.run(task, [(item,)]):
            if isinstance(outcome, Done):
                return outcome.results[0]
        return None


def begun(_: object, items: Sequence[None]) -> list[None]:
    """Load what is compiled, in the worker."""
    warm()
    return [None for _ in items]


def taken(_: object, items: Sequence[Item]) -> list[tuple[bytes, list[dict[str, Any]]]]:
    """Monitors after their rows, and what they tell, in the worker."""
    found = []
    for data, rows in items:
        monitor, messages = at_once(OnlineMonitor.from_bytes(data), rows)
        found.append((monitor.to_bytes(), messages))
    return found
