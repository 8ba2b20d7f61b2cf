"""What a monitor says of one loop, and whether it still says anything."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

from lostmotion.errors import one_line
from lostmotion.report.digits import digits
from lostmotion.report.plant.words import seconds_words

SHOWN = ("width", "left", "right", "slope_ratio")
LATE = 3.0  # times as long as from report to report: then something has ended
LEAST = 30.0  # s of silence that mean nothing
LEFT_OUT = ("missing", "manual", "saturated", "frozen")  # of the counts of a report: samples that taught nothing
SIGNED = ("left", "right")  # of them those that may be negative
LEAST_SIZE, LARGEST_SIZE = 1e-12, 1e12  # of a size that is none of 0: beyond, no valve and no chart has any
LONGEST = 1000  # characters of a text that is remembered
MOST_VALUES = 500  # of a report: it has some 100
LATEST = datetime(9000, 1, 1, tzinfo=UTC).timestamp()
Point = tuple[Any, float, float | None, float | None]


@dataclass(frozen=True)
class Said:
    """What a monitor says of a loop, as far as its file goes.

    Attributes
    ----------
    name : str
        Of the file.
    tag : str
        Of the loop; empty: the monitor watches one only, and does not name it.
    trouble : str
        Why nothing more is known; empty: all is well.
    link : str
        Why the monitor has no link to its server; empty: it has one, or needs none.
    failure : str
        Why the monitor has given the loop up; empty: it has not.
    start : mapping
        Source, columns, sampling time; empty: not told yet.
    report : mapping
        The latest one; empty: none yet.
    points : tuple of (time, float, float or None, float or None)
        Width with the ends of its interval; the time is an ISO text, seconds or None.
    events, notes : tuple of mapping
        The latest, newest first; notes are of the loop and of the link.
    heard : float, optional
        When something was last heard of the loop, s since 1970.
    every : float, optional
        s from one sign of life to the next; None: not known yet.
    silent : bool
        The next one is long due.
    lines, bad : int
        Of the whole file: read so far, and those that are none of a monitor.
    version : int
        Grows with whatever is new.
    """

    name: str
    tag: str = ""
    trouble: str = ""
    link: str = ""
    failure: str = ""
    start: Mapping[str, Any] | None = None
    report: Mapping[str, Any] | None = None
    points: tuple[Point, ...] = ()
    events: tuple[Mapping[str, Any], ...] = ()
    notes: tuple[Mapping[str, Any], ...] = ()
    heard: float | None = None
    every: float | None = None
    silent: bool = False
    lines: int = 0
    bad: int = 0
    version: int = 0

    @property
    def title(self) -> str:
        """What people call it."""
        return self.tag or self.words("start", "source") or self.name

    @property
    def status(self) -> str:
        """State in words: what keeps the estimate from being true goes before what it says."""
        told = (
            ("cannot be read", self.trouble), ("given up", self.failure), ("silent", self.silent),
            ("no link", self.link),
        )  # fmt: skip
        reported = (self.words("report", "status") or "waiting").replace("_", " ").lower()
        return next((words for words, there in told if there), reported)

    @property
    def warnings(self) -> list[str]:
        """Sentences about what is wrong with the monitor, not with the valve."""
        silence = ""
        if self.silent and self.every is not None:
            due = seconds_words(self.every)
            silence = f"Nothing was heard since {self.last_heard}, though something was due every {due}. "
            silence += "The monitor has ended, or its data have."
        link = self.link and f"The monitor has no link to its server: {self.link}"
        failure = self.failure and f"The monitor has given this loop up: {self.failure}"
        return [text for text in (self.trouble, failure, silence, link) if text]

    @property
    def last_heard(self) -> str:
        """When, in words; empty: never."""
        if self.heard is None or not 0.0 <= self.heard < LATEST:
            return ""
        return f"{datetime.fromtimestamp(self.heard, UTC):%Y-%m-%d %H:%M:%S} UTC"

    @property
    def used(self) -> str:
        """How many samples came, and how many of them taught nothing; empty: not told."""
        counts = (self.report or {}).get("counts")
        known = {name: count_of(counts, name) for name in ("samples", *LEFT_OUT)}
        if not known["samples"]:
            return ""
        out = [f"{count} {'with OP at a limit' if name == 'saturated' else name}" for name, count in known.items()
               if count and name != "samples"]  # fmt: skip
        return f"{known['samples']} samples" + (f", of these not learned from: {', '.join(out)}" if out else "")

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
        plain = ("name", "tag", "trouble", "link", "failure", "status", "silent", "start", "report", "lines", "bad")
        return {
            **{name: getattr(self, name) for name in plain},
            "heard": None if not self.last_heard else datetime.fromtimestamp(self.heard or 0.0, UTC).isoformat(),
            "every": self.every,
            "points": [dict(zip(names, point, strict=True)) for point in self.points],
            "events": list(self.events),
            "notes": list(self.notes),
            "version": self.version,
        }


@dataclass
class Silence:
    """Whether a loop is heard of as often as it was.

    Attributes
    ----------
    heard, every : float, optional
        s since 1970, and s from one sign of life to the next.
    """

    heard: float | None = None
    every: float | None = None
    _last: tuple[float | None, int] = field(default=(None, 0))

    def take(self, report: Mapping[str, Any], dt: float | None) -> None:
        """A report: from its time and that of the one before, or from its samples, comes how often they come."""
        moment, sample = moment_of(report.get("time")), count_of(report, "sample")
        before, earlier = self._last
        self._last = moment, sample
        if moment is not None and before is not None and moment > before:
            self.every = moment - before
        elif dt is not None and sample > earlier:
            self.every = dt * (sample - earlier)

    def lasts(self, now: float) -> bool:
        """Whether the next sign of life is long due."""
        if self.heard is None or self.every is None:
            return False
        return now - self.heard > max(LATE * self.every, LEAST)


def moment_of(time: Any) -> float | None:
    """Seconds since 1970 of an ISO text with its zone; None: it is another time, or none."""
    if not isinstance(time, str):
        return None
    try:
        moment = datetime.fromisoformat(time)
        return moment.timestamp() if moment.tzinfo is not None else None
    except (ValueError, OverflowError):
        return None


def words_of(message: Mapping[str, Any], *path: str) -> str:
    """Text or number at a place of a message; empty: none there."""
    found: Any = message
    for name in path:
        found = found.get(name) if isinstance(found, dict) else None
    if isinstance(found, str):
        return one_line(found)[:LONGEST]
    return f"{found:.10g}" if isinstance(found, int | float) and not isinstance(found, bool) else ""


def is_plausible(report: Mapping[str, Any]) -> bool:
    """Whether the time and the sizes of a report can be those of a monitor: only such can be drawn."""
    time = report.get("time")
    if isinstance(time, int | float) and not 0.0 <= time < LATEST:
        return False
    return all(_is_size(report.get(name), name in SIGNED) for name in SHOWN)


def _is_size(group: Any, signed: bool) -> bool:
    given = group if isinstance(group, dict) else {}
    found = [given[key] for key in ("value", "standard_error", "low", "high") if _is_number(given.get(key))]
    sizes = all(value == 0 or LEAST_SIZE <= abs(value) < LARGEST_SIZE for value in found)
    return sizes and (signed or not _is_number(given.get("value")) or given["value"] >= 0)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def is_small(message: Any) -> bool:
    """Whether a message has no more values, however deep, than one of a monitor."""
    inside, count = [message], 0
    while inside and count <= MOST_VALUES:
        one = inside.pop()
        count += 1
        inside += one.values() if isinstance(one, dict) else one if isinstance(one, list) else ()
    return count <= MOST_VALUES


def remembered(message: Mapping[str, Any]) -> dict[str, Any]:
    """Single values of a message, its texts cut: what of the many that are remembered can be shown."""
    single = {name: value for name, value in message.items() if not isinstance(value, dict | list)}
    return {name: value[:LONGEST] if isinstance(value, str) else value for name, value in single.items()}


def number(message: Mapping[str, Any] | None, name: str, key: str) -> float | None:
    """Finite number of a message; None where there is none."""
    group = (message or {}).get(name)
    value = group.get(key) if isinstance(group, dict) else None
    good = isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    return float(value) if good and value is not None and abs(value) < LARGEST_SIZE else None


def count_of(message: Any, name: str) -> int:
    """Whole number of a message; 0 where there is none."""
    value = message.get(name) if isinstance(message, dict) else None
    return value if isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 1 << 53 else 0
