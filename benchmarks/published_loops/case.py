"""A row of the tables: which plant, valve and course of events."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from published_loops.plants import Plant
from published_loops.signals import Signal
from published_loops.valves import Valve

LITTLE_NOISE, MUCH_NOISE = 0.003, 0.05  # of the swing of PV


@dataclass(frozen=True)
class Course:
    """What happens to a loop beside its valve.

    Attributes
    ----------
    words : str
        For the page.
    set_point, load, on_pv : callable, optional
        Signals.
    share : float
        Deviation of the noise, of the swing of PV.
    noise : float
        The same in %, in place of a share.
    colour : float
        Pole of the noise.
    sensor : callable
        PV as it is told.
    """

    words: str
    set_point: Signal | None = None
    load: Signal | None = None
    on_pv: Signal | None = None
    share: float = LITTLE_NOISE
    noise: float = 0.0
    colour: float = 0.0
    sensor: Callable[[float], float] = float


@dataclass(frozen=True)
class Case:
    """A loop to be simulated.

    Attributes
    ----------
    name : str
        Plant, valve and course, and a number where these come again with another seed.
    """

    name: str
    plant: Plant
    valve: Valve
    rows: int
    course: Course
