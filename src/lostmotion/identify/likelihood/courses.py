"""Courses in time, known up to their size, of what acts on the process beside the actuator."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, TypeAlias
from weakref import ref

import numpy as np

from lostmotion.arrays import FloatArray, IntArray, own_pages
from lostmotion.kernels.directional_lag import missing_travel


@dataclass(frozen=True)
class Swing:
    """A periodic load in a segment, rows start .. stop - 1; period in samples."""

    period: float
    start: int
    stop: int
    names: ClassVar[tuple[str, ...]] = ("sine", "cosine")
    sought: ClassVar[int] = 1

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
    sought: ClassVar[int] = 1

    def fill(self, courses: FloatArray) -> None:
        """One step, in courses (1, n) that are 0."""
        courses[0, self.row : self.stop] = 1.0

    def to_dict(self) -> dict[str, float]:
        """JSON-ready."""
        return {"step_at": self.row}


@dataclass(frozen=True, eq=False)
class Bend:
    """What a characteristic that bends adds to the position of the valve: its square and its cube, no straight line.

    Attributes
    ----------
    position : ndarray, shape (n,)
        Of the valve, in units of scaled OP.
    names : tuple of str
        Of the sizes.
    from_zero : bool
        It adds nothing at position 0: PV there is the offset, which may be known.
    """

    position: FloatArray
    from_zero: bool = False
    names: tuple[str, ...] = ("square", "cube")
    sought: ClassVar[int] = 0  # it has no time

    @cached_property
    def _places(self) -> tuple[float, float]:
        """Middle and range of the positions."""
        middle = 0.0 if self.from_zero else float(self.position.mean())
        return middle, float(np.ptp(self.position)) or 1.0

    @cached_property
    def _lines(self) -> list[tuple[float, float]]:
        """Straight line in the square and in the cube."""
        place = self._placed(self.position)
        return [_line(place, place**power, self.from_zero) for power in self._powers]

    @property
    def _powers(self) -> list[int]:
        return [_POWERS[name] for name in self.names]

    def _placed(self, position: FloatArray) -> FloatArray:
        middle, wide = self._places
        return (position - middle) / wide

    def fill(self, courses: FloatArray) -> None:
        """Square and cube of the place in the range, in courses (2, n)."""
        place = self._placed(self.position)
        for row, (power, (level, rise)) in enumerate(zip(self._powers, self._lines, strict=True)):
            np.power(place, power, out=courses[row])
            courses[row] -= level + rise * place

    def slopes(self, sizes: FloatArray, position: FloatArray) -> FloatArray:
        """Of the characteristic at positions (m,), over that of its straight line, for sizes (2,) of the courses."""
        place, wide = self._placed(position), self._places[1]
        slopes = np.ones(position.size)
        for size, power, (_, rise) in zip(sizes, self._powers, self._lines, strict=True):
            slopes += size / wide * (power * place ** (power - 1) - rise)
        return slopes


_POWERS = {"square": 2, "cube": 3}


def _line(x: FloatArray, y: FloatArray, from_zero: bool) -> tuple[float, float]:
    """Level and rise of the straight line through points, by least squares; with level 0 where asked."""
    if from_zero:
        return 0.0, float(x @ y) / max(float(x @ x), 1e-300)
    rise = float((x - x.mean()) @ y / max(float((x - x.mean()) @ x), 1e-300))
    return float(y.mean()) - rise * float(x.mean()), rise


@dataclass(frozen=True, eq=False)
class Asymmetry:
    """What a lag that differs with direction adds to the position of the valve.

    Behind a pole, z(k + 1) = z(k) + (1 - pole) (d + up |d| + outward |d| sign(z - centre)) with d(k) = x(k) - z(k): the
    last two terms are an input more of a process with one pole, known but for their sizes where z is.

    Attributes
    ----------
    position : ndarray, shape (n,)
        Of the valve, in units of scaled OP.
    segments : ndarray, shape (s, 2)
        Start and stop rows.
    pole : float
    up, outward : float
        Of the lag by which `z` was simulated: faster up than down, away from `centre` than back to it.
    centre : float or None
        Position at which the process rests; None: it stays on one side of it, where both directions are one.
    """

    position: FloatArray
    segments: IntArray
    pole: float
    up: float = 0.0
    outward: float = 0.0
    centre: float | None = None
    sought: ClassVar[int] = 0

    @property
    def names(self) -> tuple[str, ...]:
        """Of the sizes."""
        return ("up",) if self.centre is None else ("up", "outward")

    def fill(self, courses: FloatArray) -> None:
        """The inputs, in courses (1 or 2, n) that are 0."""
        found, centre = np.empty((2, self.position.size)), -np.inf if self.centre is None else self.centre
        for start, stop in self.segments.tolist():
            at = slice(start, stop)
            missing_travel(self.position[at], self.pole, self.up, self.outward, centre, found[:, at])
        courses[:] = found[: len(self.names)]


Event: TypeAlias = Swing | Step | Bend | Asymmetry


@dataclass(frozen=True)
class Loads:
    """What acts on the process beside the actuator, up to its size.

    Attributes
    ----------
    events : tuple of Swing, Step or Bend
        The time of each swing and step was sought and counts as a parameter.
    rows : int
        Of the data.
    """

    events: tuple[Event, ...]
    rows: int

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the sizes."""
        return tuple(name for event in self.events for name in event.names)

    @property
    def shapes(self) -> FloatArray:
        """Courses (m, rows) in the input of the process; only those asked for last are in memory."""
        return _latest.of(self)

    @property
    def sought(self) -> int:
        """Times that were sought."""
        return sum(event.sought for event in self.events)

    @property
    def bend(self) -> int | None:
        """Place of the characteristic among the events; None where it is straight."""
        return self.place_of(Bend)

    def place_of(self, event: type[Event]) -> int | None:
        """Place of the first of its type among the events; None where there is none."""
        return next((at for at, one in enumerate(self.events) if isinstance(one, event)), None)

    def to_dicts(self) -> tuple[dict[str, float], ...]:
        """Swings and steps, JSON-ready."""
        return tuple(event.to_dict() for event in self.events if isinstance(event, Swing | Step))

    def along(self, position: FloatArray) -> Loads:
        """The same, the characteristic that of a valve which went another way (n,)."""
        if not any(isinstance(event, Bend | Asymmetry) for event in self.events):
            return self
        return Loads(tuple(_along(event, position) for event in self.events), self.rows)

    def kept(self, index: list[int]) -> Loads | None:
        """Only some of the events; None where none is left."""
        return Loads(tuple(self.events[i] for i in index), self.rows) if index else None

    def joined(self, other: Loads | None) -> Loads:
        """Both."""
        return self if other is None else Loads((*self.events, *other.events), self.rows)


def _along(event: Event, position: FloatArray) -> Event:
    if isinstance(event, Bend):
        return replace(event, position=position)
    return replace(event, position=position) if isinstance(event, Asymmetry) else event


def courses_of(event: Event, rows: int) -> FloatArray:
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
