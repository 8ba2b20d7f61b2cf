"""Sample numbers <-> times, through gaps that were cut and clocks that began anew."""

from __future__ import annotations

from typing import Any

import numpy as np

from lostmotion.files.grid import Rows
from lostmotion.files.times import time_text

MOST_ANCHORS = 256  # jumps of the clock that are remembered, so that the state does not grow
JUMP = 2.0  # sampling times by which a step must differ from one to be a jump


class Timeline:
    """Times of the samples taken so far, in constant memory.

    Parameters
    ----------
    dt : float
        Sampling time in seconds.
    calendar : str
        See :class:`lostmotion.files.layout.Layout`.

    Examples
    --------
    >>> line = Timeline(2.0)
    >>> line.take(0, Rows(np.array([10.0, 12.0, 100.0, 102.0]), np.zeros(4), np.zeros(4)))
    >>> line.at(2), line.at(4), line.running
    (12.0, 102.0, 102.0)
    """

    def __init__(self, dt: float, calendar: str = "") -> None:
        self.dt, self.calendar = dt, calendar
        self._anchors: list[tuple[int, float]] = []  # number of a sample, from 1, and its time
        self._last = float("nan")
        self._shift = 0.0

    @property
    def state(self) -> dict[str, Any]:
        """What the next rows need, JSON-ready."""
        last = None if np.isnan(self._last) else self._last
        return {"anchors": [list(anchor) for anchor in self._anchors], "last": last, "shift": self._shift}

    @state.setter
    def state(self, stored: dict[str, Any]) -> None:
        self._anchors = [(int(sample), float(time)) for sample, time in stored["anchors"]]
        self._last = float("nan") if stored["last"] is None else float(stored["last"])
        self._shift = float(stored["shift"])

    def take(self, before: int, rows: Rows) -> None:
        """Take rows, after `before` samples."""
        if not len(rows):
            return
        previous = np.concatenate([[self._last], rows.time[:-1]])
        jumps = ~(np.abs(rows.time - previous - self.dt) <= JUMP * self.dt)
        for k in np.flatnonzero(jumps):
            self._anchor(before + int(k) + 1, float(rows.time[k]))
        for k in rows.breaks:
            if not np.isnan(previous[k]):
                self._shift += float(previous[k]) + self.dt - float(rows.time[k])
        self._last = float(rows.time[-1])

    def anchor(self, sample: int) -> None:
        """Keep the time of the sample just taken: clocks drift."""
        self._anchor(sample, self._last)

    @property
    def now(self) -> float:
        """Time of the last sample."""
        return self._last

    @property
    def running(self) -> float:
        """Seconds that go on where the clock began anew, for trends."""
        return self._last + self._shift

    def stamp(self, running: float) -> float:
        """Time on the present clock of a moment in :attr:`running` seconds."""
        return running - self._shift

    def at(self, sample: int) -> float:
        """Time of a sample, from 1 on, not later than the last; NaN before there is one."""
        earlier = [anchor for anchor in self._anchors if anchor[0] <= sample] or self._anchors[:1]
        if not earlier:
            return float("nan")
        number, time = earlier[-1]
        return time + (sample - number) * self.dt

    def text(self, time: float) -> str | float | None:
        """Time for a message: a date where there is a calendar, seconds where there is none."""
        if not np.isfinite(time):
            return None
        return time_text(time, self.calendar) if self.calendar else round(time, 6)

    def _anchor(self, sample: int, time: float) -> None:
        self._anchors = [*self._anchors, (sample, time)][-MOST_ANCHORS:]
