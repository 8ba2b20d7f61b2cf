"""Estimates of a watch on their way into a store: in batches, off the event loop, and never in the way of the watch."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from datetime import datetime
from typing import Any

from lostmotion.store.rows import EstimateRow
from lostmotion.store.run_rows import LoopRow, WatchRow
from lostmotion.store.watched import WatchStore

PATIENCE = 5.0  # s for which a lock of the store is waited for, before it is tried again with the next beat
MOST = 100_000  # estimates that wait for a store that is away; more: the oldest are let go, and counted

Tell = Callable[[str], None]


class Estimates:
    """Takes reports, writes estimates.

    Parameters
    ----------
    address : str
        Of the store, which is made if it is not there.
    wanted : WatchRow
    loops : sequence of LoopRow
    tell : callable
        Takes what a person should know about the store, once each.

    Raises
    ------
    FileAccessError
        The store cannot be used, or another process watches one of the loops into it.
    """

    def __init__(self, address: str, wanted: WatchRow, loops: Sequence[LoopRow], tell: Tell) -> None:
        self._wanted, self._loops, self._tell = wanted, loops, tell
        self._store = WatchStore(address, patience=PATIENCE)
        self._waiting: list[EstimateRow] = []
        self._lock, self._writing = threading.Lock(), threading.Lock()
        self._said, self._let_go = "", 0
        try:
            self.begin()
        except BaseException:
            self._store.close()
            raise

    @property
    def waiting(self) -> bool:
        """Estimates wait, and not for a store that is away."""
        return bool(self._waiting) and not self._said

    def begin(self) -> None:
        """Take the watch, or take it again after a long time without a beat."""
        self.number = self._store.begin_watch(self._wanted, self._loops)

    def take(self, message: dict[str, Any]) -> None:
        """Keep the estimate of a report, where it has one, until it is written."""
        row = estimate_of(message)
        if row is not None:
            with self._lock:
                self._waiting.append(row)

    def write(self) -> None:
        """Write what waits, and a beat of the heart. What cannot be written waits on."""
        with self._writing:
            with self._lock:
                rows, self._waiting = self._waiting, []
            try:
                self._store.put_estimates(self.number, rows)
            except Exception as error:  # noqa: BLE001  whatever the store has, the watch goes on
                self._keep(rows, str(error) or type(error).__name__)
            else:
                self._written(rows)

    def close(self) -> None:
        """Write what waits, and say that the watch has stopped, as far as the store lets us."""
        self.write()
        if not self._said:
            try:
                self._store.end_watch(self.number)
            except Exception as error:  # noqa: BLE001  as above
                self._tell(str(error))
        self._store.close()

    def _keep(self, rows: list[EstimateRow], why: str) -> None:
        with self._lock:
            waiting = rows + self._waiting
            self._let_go += max(len(waiting) - MOST, 0)
            self._waiting = waiting[-MOST:]
        if why != self._said:
            self._said = why
            self._tell(f"Estimates are not stored, and wait: {why}")

    def _written(self, rows: list[EstimateRow]) -> None:
        if not self._said:
            return
        gone = f"; {self._let_go} older ones were let go" if self._let_go else ""
        self._said, self._let_go = "", 0
        self._tell(f"Estimates are stored again, {len(rows)} that have waited{gone}.")


def estimate_of(message: dict[str, Any]) -> EstimateRow | None:
    """Row of a report; None where that is none, or has no estimate.

    Examples
    --------
    >>> width = {"value": 2.0, "standard_error": 0.1, "low": 1.8, "high": 2.2}
    >>> report = {"tag": "A", "kind": "report", "time": "2026-05-01T00:00:00.500Z", "sample": 9, "status": "OK"}
    >>> estimate_of({**report, "width": width, "left": None, "right": None}).high
    2.2
    >>> estimate_of({**report, "width": None})
    """
    width = message.get("width")
    if message.get("kind") != "report" or not width or width["value"] is None:
        return None
    left, right = ((message[side] or {}).get("value") for side in ("left", "right"))
    return EstimateRow(
        tag=message["tag"],
        at=datetime.fromisoformat(message["time"]),
        sample=message["sample"],
        status=message["status"],
        width=width["value"],
        low=width["low"],
        high=width["high"],
        standard_error=width["standard_error"],
        left=left,
        right=right,
    )
