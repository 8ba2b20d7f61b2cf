"""A monitor that runs elsewhere, as its JSON lines or its state file tell: what it says now, and said before."""

from __future__ import annotations

import json
import math
import threading
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lostmotion.errors import LostMotionError, ParameterError, one_line
from lostmotion.files.limits import most_bytes
from lostmotion.files.schema import parsed
from lostmotion.online import OnlineMonitor, messages
from lostmotion.online.packing import unpack
from lostmotion.online.service import KIND
from lostmotion.report.digits import digits

SHOWN = ("width", "left", "right", "slope_ratio")
POINTS = 1000  # of the history; every other one goes where there are more
EVENTS, NOTES = 50, 20  # that are remembered
LONGEST = 1 << 20  # bytes of a line
PIECE = 1 << 22  # bytes that are read at once


@dataclass(frozen=True)
class Said:
    """What a monitor says, as far as its file goes.

    Attributes
    ----------
    name : str
        Of the file.
    trouble : str
        Why nothing more is known; empty: all is well.
    start : mapping
        Source, columns, sampling time; empty: not told yet.
    report : mapping
        The latest one; empty: none yet.
    points : tuple of (time, float, float or None, float or None)
        Width with the ends of its interval; the time is an ISO text, seconds or None.
    events, notes : tuple of mapping
        The latest, newest first.
    lines : int
        Read so far.
    bad : int
        Lines that are none of a monitor.
    version : int
        Grows with whatever is new.
    """

    name: str
    trouble: str = ""
    start: Mapping[str, Any] | None = None
    report: Mapping[str, Any] | None = None
    points: tuple[tuple[Any, float, float | None, float | None], ...] = ()
    events: tuple[Mapping[str, Any], ...] = ()
    notes: tuple[Mapping[str, Any], ...] = ()
    lines: int = 0
    bad: int = 0
    version: int = 0

    @property
    def status(self) -> str:
        """State of the estimate in words."""
        if self.trouble:
            return "cannot be read"
        return (self.words("report", "status") or "waiting").replace("_", " ").lower()

    def words(self, *path: str) -> str:
        """Text or number in `start` or `report`, whatever the file holds; empty: none there."""
        return words_of({"start": self.start, "report": self.report}, *path)

    def said_before(self, which: str) -> list[tuple[str, str]]:
        """When (or in which line), and what, of "events" or "notes"."""
        own = self.events if which == "events" else self.notes
        return [(words_of(one, "time") or words_of(one, "line"), words_of(one, "message")) for one in own]

    def numbers(self) -> list[tuple[str, str, str]]:
        """Name, value and 95 % interval of what is estimated."""
        rows = []
        for name in SHOWN:
            value = number(self.report, name, "value")
            if value is None:
                continue
            error, low, high = (number(self.report, name, key) for key in ("standard_error", "low", "high"))
            shown = digits(value, error)[0] if error else f"{value:.4g}"
            ends = "" if low is None or high is None else f"{low:.4g} .. {high:.4g}"
            rows.append((name.replace("_", " "), shown, ends))
        return rows

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        names = ("time", "width", "low", "high")
        return {
            **{name: getattr(self, name) for name in ("name", "trouble", "status", "start", "report", "lines", "bad")},
            "points": [dict(zip(names, point, strict=True)) for point in self.points],
            "events": list(self.events),
            "notes": list(self.notes),
            "version": self.version,
        }


class Watched:
    """One file of a monitor. It is looked at when it is asked for; several threads may ask.

    Parameters
    ----------
    path : str
        JSON lines of ``lostmotion online``, or the file of its `--state`.
    """

    def __init__(self, path: str) -> None:
        self.path = Path(path)
        self._lock = threading.Lock()
        self._version = 0
        self._seen: tuple[int, int, int] | None = None
        self._forget()

    def _forget(self) -> None:
        self._offset, self._rest, self._trouble = 0, b"", ""
        self._start: Mapping[str, Any] | None = None
        self._report: Mapping[str, Any] | None = None
        self._points: list[tuple[Any, float, float | None, float | None]] = []
        self._events: deque[Mapping[str, Any]] = deque(maxlen=EVENTS)
        self._notes: deque[Mapping[str, Any]] = deque(maxlen=NOTES)
        self._lines = self._bad = 0

    def look(self) -> Said:
        """What it says by now."""
        with self._lock:
            try:
                self._follow()
                self._set_trouble("")
            except OSError as error:
                self._set_trouble(f"{self.path.name}: {(error.strerror or str(error)).lower()}.")
            except LostMotionError as error:
                self._set_trouble(one_line(str(error)))
            return Said(
                self.path.name, self._trouble, self._start, self._report, tuple(self._points),
                tuple(reversed(self._events)), tuple(reversed(self._notes)), self._lines, self._bad, self._version,
            )  # fmt: skip

    def _set_trouble(self, text: str) -> None:
        self._version += text != self._trouble
        self._trouble = text

    def _follow(self) -> None:
        facts = self.path.stat()
        seen = (facts.st_ino, facts.st_size, facts.st_mtime_ns)
        if seen == self._seen:
            return
        another = self._seen is not None and (facts.st_ino != self._seen[0] or facts.st_size < self._offset)
        self._seen = seen
        if another:
            self._forget()
        with self.path.open("rb") as file:
            if file.read(len(KIND)) == KIND.encode():
                self._take_state(facts.st_size)
                return
            file.seek(self._offset)
            while piece := file.read(PIECE):
                self._offset += len(piece)
                self._take(piece)
        self._version += 1

    def _take(self, piece: bytes) -> None:
        *whole, self._rest = (self._rest + piece).split(b"\n")
        if len(self._rest) > LONGEST:
            self._rest, self._bad = b"", self._bad + 1
        for line in whole:
            if line.strip():
                self._lines += 1
                self._hear(line)

    def _hear(self, line: bytes) -> None:
        try:
            message = parsed(line, LONGEST)
            json.dumps(message, ensure_ascii=False).encode()  # halves of characters can be shown nowhere
        except ValueError:
            message = None
        kind = message.get("kind") if isinstance(message, dict) else None
        if kind == "start":
            self._start = message
        elif kind == "report":
            self._report = message
            self._point(message)
        elif kind == "event":
            self._events.append(message)
        elif kind == "note":
            self._notes.append(message)
        else:
            self._bad += 1

    def _point(self, report: Mapping[str, Any]) -> None:
        value, low, high = (number(report, "width", key) for key in ("value", "low", "high"))
        if value is None and high is None:
            return
        time = report.get("time")
        when = time if isinstance(time, str | int | float) else None
        self._points.append((when, 0.0 if value is None else value, low, high))
        if len(self._points) > POINTS:
            self._points = self._points[::2]

    def _take_state(self, size: int) -> None:
        """The state says where it stands and what the widths of the periods were; events are not in it."""
        if size > most_bytes():
            raise ParameterError.expected("a state", f"{size} bytes", "give the file of --state")
        self._forget()
        _, blob = unpack(KIND, self.path.read_bytes())
        self._version += 1
        if not blob:
            return
        monitor = OnlineMonitor.from_bytes(blob)
        clock = monitor.timeline
        estimate = monitor.estimator.estimate if monitor.estimator.started else None
        self._report = messages.report(estimate, monitor.samples, clock)
        for time, value, weight in monitor.trend.to_dict()["points"]:
            half = 1.96 * weight**-0.5
            self._points.append((clock.text(clock.stamp(time)), value, max(value - half, 0.0), value + half))


def words_of(message: Mapping[str, Any], *path: str) -> str:
    """Text or number at a place of a message; empty: none there."""
    found: Any = message
    for name in path:
        found = found.get(name) if isinstance(found, dict) else None
    if isinstance(found, str):
        return one_line(found)[:1000]
    return f"{found:.10g}" if isinstance(found, int | float) and not isinstance(found, bool) else ""


def number(message: Mapping[str, Any] | None, name: str, key: str) -> float | None:
    """Finite number of a message; None where there is none."""
    group = (message or {}).get(name)
    value = group.get(key) if isinstance(group, dict) else None
    good = isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    return float(value) if good and value is not None and abs(value) < 1e12 else None
