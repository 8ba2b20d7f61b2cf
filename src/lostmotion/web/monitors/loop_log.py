"""Messages of one loop, as a monitor prints them: the latest, and what is worth being remembered."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import Any

from lostmotion.web.monitors.said import Point, Said, Silence, is_plausible, moment_of, number, remembered, words_of

POINTS = 1000  # of the history; every other one goes where there are more
EVENTS, NOTES = 50, 20  # that are remembered


class LoopLog:
    """One loop of a file.

    Parameters
    ----------
    name, tag : str
        Of the file, and of the loop.
    """

    def __init__(self, name: str, tag: str) -> None:
        self.name, self.tag = name, tag
        self.silence = Silence()
        self.version = 0
        self._start: Mapping[str, Any] | None = None
        self._report: Mapping[str, Any] | None = None
        self._failure = ""
        self._points: list[Point] = []
        self._events: deque[Mapping[str, Any]] = deque(maxlen=EVENTS)
        self.notes: deque[Mapping[str, Any]] = deque(maxlen=NOTES)

    def hear(self, message: Mapping[str, Any], by: float) -> bool:
        """Take a message that was written `by` then (s since 1970) at the latest; whether it is one of a monitor."""
        kind = message.get("kind")
        if kind == "start":
            self._start, self._failure = message, ""
        elif kind == "report":
            if not is_plausible(message):
                return False
            self._report = message
            self.silence.take(message, number({"start": self._start}, "start", "dt"))
            self.add(message.get("time"), *(number(message, "width", key) for key in ("value", "low", "high")))
        elif kind == "event":
            self._events.append(remembered(message))
        elif kind == "note":
            self.notes.append(remembered(message))
        elif kind == "failed":
            self._failure = words_of(message, "message") or "it does not say why"
        else:
            return False
        self.silence.heard = by
        self.version += 1
        return True

    def take_report(self, report: Mapping[str, Any]) -> None:
        """The latest one, of what keeps its own widths."""
        self._report = report

    def add(self, time: Any, value: float | None, low: float | None, high: float | None) -> None:
        """A point of the width."""
        if value is None and high is None:
            return
        when = time if isinstance(time, str | int | float) else None
        self._points.append((when, 0.0 if value is None else value, low, high))
        if len(self._points) > POINTS:
            self._points = self._points[::2]

    @property
    def told(self) -> float | None:
        """When its last report was made by its own clock, s since 1970; None: it does not say so."""
        return moment_of((self._report or {}).get("time"))

    def settle(self, by: float, latest: float | None) -> None:
        """Of lines that were there before anybody looked: the latest report of all was written `by` then."""
        behind = 0.0 if self.told is None or latest is None else latest - self.told
        self.silence.heard = by - behind

    def said(self, now: float, link: str = "", notes: tuple[Mapping[str, Any], ...] = (), **of_file: Any) -> Said:
        """What it says by now; `link` and `notes` are of the link that it shares with others."""
        return Said(
            self.name, self.tag, link=link, failure=self._failure, start=self._start, report=self._report,
            points=tuple(self._points), events=tuple(reversed(self._events)),
            notes=(*reversed(self.notes), *notes), heard=self.silence.heard, every=self.silence.every,
            silent=self.silence.lasts(now), **of_file,
        )  # fmt: skip
