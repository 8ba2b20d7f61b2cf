"""A valve in a control loop: PI controller, process, load, noise, row by row.

The controller scans once a row: it takes PV and gives OP, the stem moves, and the process answers from the next row on.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from published_loops.meters import Meter
from published_loops.plants import Plant
from published_loops.valves import Valve

Array = np.ndarray
REST = 50.0  # %: OP and PV where nothing acts
BEFORE = 400  # rows that pass before the record begins
KICK = 60  # rows of each of two kicks at the beginning of these, so that a loop that can swing does
LOWEST, HIGHEST = 0.0, 100.0  # % of OP


@dataclass(frozen=True)
class Driven:
    """What acts on a loop, in % and away from rest.

    Attributes
    ----------
    set_point, load : ndarray, shape (rows,)
        The load is added to the stem.
    noise : ndarray, shape (BEFORE + rows,)
        Added to PV.
    sensor : callable
        PV as it is told.
    """

    set_point: Array
    load: Array
    noise: Array
    sensor: Callable[[float], float] = float

    def begun_before(self) -> Driven:
        """All of the same length: before the record the first values of set point and load hold."""
        held = [np.r_[np.full(BEFORE, one[0]), one] for one in (self.set_point, self.load)]
        return Driven(held[0], held[1], self.noise, self.sensor)


@dataclass(frozen=True)
class Recorded:
    """OP, PV, set point and stem, each of shape (rows,), in %; what watched the stem."""

    op: Array
    pv: Array
    sp: Array
    stem: Array
    meter: Meter


def closed_loop(plant: Plant, valve: Valve, driven: Driven) -> Recorded:
    """Run a loop."""
    signals, space = driven.begun_before(), plant.process.state_space(plant.seconds)
    rows, integral, state = len(signals.load), 0.0, np.zeros(len(space.b))
    kick = 2.5 * valve.size + 2 if valve.size > 0 else 0.0
    stem, waiting = valve.stem(REST, plant.seconds), deque([0.0] * (space.delay + 1))
    found = np.empty((3, rows))
    for k in range(rows):
        if k == BEFORE:
            stem.meter.forget()
        y = float(space.c @ state + space.d * (waiting[0] + signals.load[k]))
        pv = signals.sensor(REST + y + plant.process.bend * y * y + signals.noise[k])
        error = REST + signals.set_point[k] - pv
        integral += _integrated(plant, error, integral)
        op = REST + plant.gain * error + integral
        if k < 2 * KICK:
            op += kick if k < KICK else -kick
        op = min(max(op, LOWEST), HIGHEST)
        place = stem.move(op)
        late = waiting[0]
        waiting.append(place - REST)
        waiting.popleft()
        state = space.a @ state + space.b * ((late if space.d else waiting[0]) + signals.load[k])
        found[:, k] = op, pv, place
    op_rows, pv_rows, stem_rows = found[:, BEFORE:]
    return Recorded(op_rows, pv_rows, REST + driven.set_point, stem_rows, stem.meter)


def _integrated(plant: Plant, error: float, integral: float) -> float:
    """What a row adds to the integral: nothing while that would drive OP further beyond its end."""
    more = plant.gain * plant.seconds / plant.reset * error
    wanted = plant.gain * error + integral + more
    inside = LOWEST <= REST + wanted <= HIGHEST
    return more if inside or wanted * error < 0 else 0.0
