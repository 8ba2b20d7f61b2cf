"""Courses in time, known up to their size, of what acts on the process beside the actuator."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar
from weakref import ref

import numpy as np

from lostmotion.arrays import FloatArray, own_pages


@dataclass(frozen=True)
class Swing:
    """A periodic load in a segment, rows start .. stop - 1; period in samples."""

    period: float
    start: int
    stop: int
    names: ClassVar[tuple[str, ...]] = ("sine", "cosine")

    def fill(self, courses: FloatArray) -> None:
        """Sine and cosine, in courses (2, n) that are 0."""
        phase = 2.0 * np.pi / self.period * np.arange(self.stop - self.start)
        np.sin(phase, out=courses[0, self.start : self.stop])
        np.cos(phase, out=courses[1, self.start : self.stop])

    def to_dict(self) -> dict[str, float]:
        """JSON-ready."""
        return {"period": self.period}


@dataclass(frozen=True)
class Step:
    """A load that changes once, at a row of the data, and stays until the end of its segment."""

    row: int
    start: int
    stop: int
    names: ClassVar[tuple[str, ...]] = ("step",)

    def fill(self, courses: FloatArray) -> None:
        """One step, in courses (1, n) that are 0."""
        courses[0, self.row : self.stop] = 1.0

    def to_dict(self) -> dict[str, float]:
        """JSON-ready."""
        return {"step_at": self.row}


@dataclass(frozen=True)
class Loads:
    """What acts on the process beside the actuator, up to its size.

    Attributes
    ----------
    events : tuple of Swing or Step
        The time of each was sought and counts as a parameter.
    rows : int
        Of the data.
    """

    events: tuple[Swing | Step, ...]
    rows: int

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the sizes."""
        return tuple(name for event in self.events for name in event.names)

    @property
    def shapes(self) -> FloatArray:
        """Courses (m, rows) in the input of the process; only those asked for last are in memory."""
        return _latest.of(self)

    def kept(self, index: list[int]) -> Loads | None:
        """Only some of the events; None where none is left."""
        return Loads(tuple(self.events[i] for i in index), self.rows) if index else None

    def joined(self, other: Loads | None) -> Loads:
        """Both."""
        return self if other is None else Loads((*self.events, *other.events), self.rows)


def courses_of(event: Swing | Step, rows: int) -> FloatArray:
    """Courses (names, rows) of one event."""
    courses = np.zeros((len(event.names), rows))
    event.fill(courses)
    return courses


class _Latest:
    """The courses that were made last, as long as the loads they belong to live: those of all fits fill the memory."""

    def __init__(self) -> None:
        self._held: tuple[ref[Loads], FloatArray] | None = None

    def of(self, loads: Loads) -> FloatArray:
        """Made, or those made before."""
        held = self._held
        if held is not None and held[0]() is loads:
            return held[1]
        self._held = held = None  # before the new ones are made
        shapes = own_pages((len(loads.names), loads.rows))
        at = 0
        for event in loads.events:
            event.fill(shapes[at : at + len(event.names)])
            at += len(event.names)
        self._held = ref(loads, self._forget), shapes
        return shapes

    def clear(self) -> None:
        """Hold none."""
        self._held = None

    def _forget(self, gone: ref[Loads]) -> None:
        held = self._held
        if held is not None and held[0] is gone:
            self._held = None


_latest = _Latest()


def forget() -> None:
    """Give back the memory of the courses made last, where what comes next needs room and not them."""
    _latest.clear()
