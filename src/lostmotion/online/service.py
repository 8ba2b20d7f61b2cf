"""Follow a source, keep the state, tell what happens: until the end, a signal, or an error."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from pathlib import Path
from threading import Event
from typing import Any, BinaryIO, Self

from lostmotion.arguments import positive
from lostmotion.errors import DataError, FileAccessError, LostMotionError, ParameterError
from lostmotion.files.grid import Rows
from lostmotion.files.layout import Layout
from lostmotion.files.schema import anything, checked, group, table
from lostmotion.files.writer import lock_file, refuse, sweep, write_bytes
from lostmotion.online.monitor import OnlineMonitor
from lostmotion.online.packing import STATE, pack, unpack
from lostmotion.online.source import RowSource
from lostmotion.online.stored import REMEDY, WHAT, Check, check_position

HEADER = group(settings=table(anything), position=table(anything))
POLL = 0.5  # s between looks at a file that does not grow
SAVE_EVERY = 1.0  # s: while catching up the state is not written more often than this

Make = Callable[[Layout], OnlineMonitor]
Found = tuple[OnlineMonitor, list[dict[str, Any]]]  # monitor after some rows, and what it tells
Take = Callable[[OnlineMonitor, Rows], Found]


def at_once(monitor: OnlineMonitor, rows: Rows) -> Found:
    """Take rows here and now."""
    return monitor, monitor.take(rows)


class Kept:
    """State file: position in the source and monitor, replaced in one step.

    Parameters
    ----------
    path : Path or None
        None: nothing is kept.
    settings : dict
        What the service was started with, JSON-ready; another start must say the same.
    check : callable
        Gives the sampling time of a position in the source, None where it has none yet; refuses what is no position.

    Raises
    ------
    DataError
        The file is something else, or damaged.
    ParameterError
        It was made with other settings.
    FileAccessError
        It cannot be read, or another process works with it.
    """

    def __init__(self, path: Path | None, settings: dict[str, Any], check: Check = check_position) -> None:
        self.path, self._check = path, check
        self.settings = json.loads(json.dumps(settings))
        self.position: dict[str, Any] | None = None
        self.monitor: OnlineMonitor | None = None
        self._saved = -float("inf")
        self._lock: BinaryIO | None = None
        if path is None:
            return
        refuse(path, force=True)
        self._lock = lock_file(path)
        try:
            sweep(path)
            if path.exists():
                self._load(path)
        except LostMotionError:
            self.close()
            raise

    def close(self) -> None:
        """Let another process work with the file."""
        if self._lock is not None:
            self._lock.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _load(self, path: Path) -> None:
        try:
            data = path.read_bytes()
        except OSError as error:
            raise FileAccessError(f"expected a readable {path}, got {error.strerror}; check the path") from error
        header, blob = unpack(STATE, data)
        checked(header, HEADER, WHAT, REMEDY)
        stored = header["settings"]
        for name, value in self.settings.items():
            if stored.get(name) != value:
                got = f"{str(stored.get(name))[:100]} in {path}"
                raise ParameterError.expected(f"{name} = {value}", got, "start as before, or with another state file")
        dt = self._check(header["position"])
        self.position = header["position"]
        self.monitor = OnlineMonitor.from_bytes(blob) if blob else None
        if self.monitor is not None and dt != self.monitor.dt:
            raise DataError.expected(f"dt = {self.monitor.dt:g} s in the position of {WHAT}", "another", REMEDY)

    def save(self, source: RowSource, monitor: OnlineMonitor | None, hurry: bool = True) -> None:
        """Write the state; without `hurry` not more often than once a second."""
        now = time.monotonic()
        if self.path is None or (not hurry and now - self._saved < SAVE_EVERY):
            return
        header = {"settings": self.settings, "position": source.position}
        write_bytes(self.path, pack(STATE, header, monitor.to_bytes() if monitor is not None else b""), force=True)
        self._saved = now


class Service:
    """One loop in service.

    Parameters
    ----------
    source : RowSource
        Where rows come from: a Follower, or a loop of a server.
    kept : Kept
        State to go on from, and where it is written.
    make : callable
        ``make(layout)`` gives the monitor of a new start.
    emit : callable
        Takes each message, a JSON-ready dictionary, in order. After a kill the messages since the state was last
        written come once more: the same, told by kind and sample.
    width_limit : float, optional
        Limit of the width from now on.
    """

    def __init__(
        self,
        source: RowSource,
        kept: Kept,
        make: Make,
        emit: Callable[[dict[str, Any]], None],
        width_limit: float | None = None,
    ) -> None:
        self.source, self.kept, self.emit = source, kept, emit
        self.monitor = kept.monitor
        self.width_limit = None if width_limit is None else positive("width_limit", width_limit)
        self._events = 0
        self._make = make
        self._begun = False
        self._unsaved = False

    @property
    def quiet(self) -> bool:
        """There is an estimate that tells, nothing has happened in this run, the width is not above its limit."""
        return self.monitor is not None and self.monitor.calm and not self._events

    def run(self, follow: bool, stop: Event) -> None:
        """Work until `stop` is set or, without `follow`, until the end of the file.

        Raises
        ------
        LostMotionError
            The source cannot be read further; what was read is kept.
        """
        at_end = False
        while not stop.is_set():
            if self.turn(at_end=at_end):
                continue
            self.save()
            if at_end:
                self._tell_last()
                break
            at_end = self.source.ended or not follow
            if not at_end:
                self.source.wait(POLL, stop)
        self.save()

    def turn(self, take: Take = at_once, *, at_end: bool = False) -> bool:
        """Take what is there; whether anything was.

        Parameters
        ----------
        take : callable
            Gives the monitor after some rows, the same wherever it does that.
        at_end : bool
            Nothing comes any more.

        Raises
        ------
        LostMotionError
            As in :meth:`run`.
        """
        rows = self._read(at_end)
        if not len(rows) and not self.source.more:
            return False
        self._take(rows, take)
        return True

    def save(self) -> None:
        """Write the state, if anything has come since."""
        self._save(hurry=True)

    def _read(self, at_end: bool) -> Rows:
        most = self.monitor.to_report if self.monitor is not None and self._begun else 0  # 0: the layout only
        try:
            rows = self.source.finish(most) if at_end else self.source.read(most)
        except LostMotionError:
            self._save(hurry=True)
            raise
        if self.source.layout is not None and not self._begun:
            self._begin(self.source.layout)
        return rows

    def _begin(self, layout: Layout) -> None:
        self._begun = True
        resumed = self.monitor is not None
        if self.monitor is None:
            self.monitor = self._make(layout)
        self.monitor.width_limit = self.width_limit
        self.emit(
            {
                "kind": "start",
                "source": self.source.name,
                "op": layout.op,
                "pv": layout.pv,
                "time_column": layout.time,
                "mode": layout.mode,
                "dt": layout.dt,
                "sample": self.monitor.samples,
                "message": " ".join(layout.notes) if not resumed else f"Goes on after sample {self.monitor.samples}.",
            }
        )

    def _tell_last(self) -> None:
        """Report at the end; with a state the rows since the last report wait for those of the next start."""
        if self.monitor is None or self.kept.path is not None:
            return
        for message in self.monitor.last():
            self.emit(message)

    def _take(self, rows: Rows, take: Take) -> None:
        assert self.monitor is not None  # noqa: S101  there are no rows without a layout
        for note in rows.notes:
            self.emit({"kind": "note", "line": note.line, "message": note.text})
        self.monitor, found = take(self.monitor, rows)
        for message in found:
            self.emit(message)
        self._events += sum(message["kind"] == "event" for message in found)
        self._unsaved = self._unsaved or len(rows) > 0
        if found:
            self._save(hurry=not self.source.more)

    def _save(self, hurry: bool) -> None:
        if self._unsaved and self._begun:
            self.kept.save(self.source, self.monitor, hurry)
            self._unsaved = not hurry
