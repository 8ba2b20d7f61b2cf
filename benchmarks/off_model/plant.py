"""Plants in fine steps: an actuator, a characteristic, a process with lags that may differ with direction.

It shares nothing with the package. The fine step is at most 1/20 of the fastest time constant and of a row.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit

Array = np.ndarray

NONE, DEAD_ZONE, BACKLASH, STICTION = KINDS = ("none", "dead zone", "backlash", "stiction")
MOTION, SPEED = DIRECTIONS = ("motion", "speed")  # what the time constant depends on: see Plant.direction
FINE = 20  # steps in the shorter of a row and the fastest time constant


@dataclass(frozen=True)
class Actuator:
    """What stands between command and process, in units of OP.

    Attributes
    ----------
    kind : str
        One of `KINDS`.
    left, right : float
        Where the lines of a dead zone reach zero.
    still : float
        A dead zone is still to so many times its break points, then on the line: 1 is no jump at break-away.
    width : float
        Of the play, or S of a stiction.
    jump : float
        J of a stiction.
    taper : float
        Play at OP = `RANGE` / 2 and at -`RANGE` / 2: so much, as a share, wider and narrower than `width`.
    """

    kind: str = NONE
    left: float = 0.0
    right: float = 0.0
    still: float = 1.0
    width: float = 0.0
    jump: float = 0.0
    taper: float = 0.0

    @property
    def size(self) -> float:
        """Full width of the lost motion."""
        return self.right - self.left if self.kind == DEAD_ZONE else self.width


@dataclass(frozen=True)
class Plant:
    """A process behind an actuator; times in seconds.

    Attributes
    ----------
    gain : float
        PV per OP; of an integrating process per second.
    up, down : float
        Time constants of the first lag; `down` is used where PV falls, or its magnitude does (`direction`).
    direction : str
        "motion": up is a rising output; "speed": up is an output that moves away from zero.
    second : float
        Time constant of the second lag, 0 for none.
    dead_time : float
    bend : float
        The gain grows by this share from the middle to the end of the range: 0.5 is 1 : 3 over the range.
    integrates : bool
        No first lag, but an integral.
    """

    actuator: Actuator
    gain: float
    up: float
    down: float
    direction: str = MOTION
    second: float = 0.0
    dead_time: float = 0.0
    bend: float = 0.0
    integrates: bool = False

    def fine_steps(self, dt: float) -> int:
        """Steps in a row."""
        lags = [] if self.integrates else [self.up, self.down]
        fastest = min([dt, *lags, *([self.second] if self.second else [])])
        return int(np.ceil(FINE * dt / fastest - 1e-9))


class Controller(NamedTuple):
    """PI; `reset` in seconds."""

    gain: float
    reset: float
    low: float = -np.inf
    high: float = np.inf


RANGE = 120.0  # of OP


def open_loop(plant: Plant, dt: float, op: Array, load: Array | None = None) -> Array:
    """PV without noise on the rows of OP, which is held from its row to the next; from rest."""
    nothing = np.zeros(op.size)
    _, pv = _simulated(plant, dt, op, nothing, nothing, load, None, 0.0)
    return pv


def closed_loop(
    plant: Plant,
    dt: float,
    set_point: Array,
    noise: Array,
    load: Array | None,
    controller: Controller,
    step: float = 0.0,
) -> tuple[Array, Array]:
    """OP and PV with noise (added to it, rounded to `step`) under a PI controller, one scan a row."""
    return _simulated(plant, dt, np.zeros(set_point.size), set_point, noise, load, controller, step)


def _simulated(
    plant: Plant,
    dt: float,
    op: Array,
    set_point: Array,
    noise: Array,
    load: Array | None,
    controller: Controller | None,
    step: float,
) -> tuple[Array, Array]:
    valve, steps = plant.actuator, plant.fine_steps(dt)
    h = dt / steps
    decays = np.array([0.0 if lag == 0.0 else 1.0 - np.exp(-h / lag) for lag in (plant.up, plant.down, plant.second)])
    numbers = np.array([valve.left, valve.right, valve.still, valve.width, valve.jump, 2.0 * valve.taper / RANGE])
    pi = Controller(0.0, 1.0) if controller is None else controller
    return _rows(
        np.asarray(op, float), set_point, noise, np.zeros(op.size) if load is None else load,
        KINDS.index(valve.kind), numbers, plant.gain * (h if plant.integrates else 1.0), plant.bend / RANGE,
        decays, plant.direction == SPEED, plant.integrates, steps, round(plant.dead_time / h),
        controller is not None, np.array([pi.gain, dt / pi.reset, pi.low, pi.high]), step,
    )  # fmt: skip


@njit(cache=True)
def _rows(  # noqa: C901, PLR0912 - one kernel, no calls
    op, set_point, noise, load, kind, numbers, gain, bend, decays, by_speed, integrates, steps, dead, closed, pi, step
):
    left, right, still, width, jump, taper = numbers
    n = op.size
    u, pv = np.empty(n), np.empty(n)
    waiting = np.zeros(dead + 1)  # places of the actuator that the dead time holds back
    place = force = first = second = output = error = command = 0.0
    for row in range(n):
        measured = second + noise[row]
        if step > 0.0:
            measured = step * np.round(measured / step)
        pv[row] = measured
        last = command
        if closed:
            now = set_point[row] - measured
            output = min(max(output + pi[0] * (now - error + pi[1] * now), pi[2]), pi[3])
            error, command = now, output
        else:
            command = op[row]
        u[row] = command
        if kind == 0:
            place = command
        elif kind == 1:
            if command > still * right:
                place = command - right
            elif command < still * left:
                place = command - left
            else:
                place = 0.0
        elif kind == 2:
            half = 0.5 * width * (1.0 + taper * command)
            place = min(max(place, command - half), command + half)
        else:  # stiction: stuck for (S + J) / 2 behind the command, then (S - J) / 2 behind it
            force += command - last
            if abs(force) > 0.5 * (width + jump):
                force = np.sign(force) * 0.5 * (width - jump)
                place = command - force
        moved = place + bend * place * place
        for fine in range(steps):
            at = (row * steps + fine) % (dead + 1)
            waiting[at] = moved
            arrived = waiting[(at + 1) % (dead + 1)]
            if integrates:
                first += gain * (arrived + load[row])
            else:
                aim = gain * (arrived + load[row])
                rises = first * (aim - first) >= 0.0 if by_speed else aim >= first
                first += (aim - first) * (decays[0] if rises else decays[1])
            second = second + (first - second) * decays[2] if decays[2] > 0.0 else first
    return u, pv


def held_levels(rng: np.random.Generator, rows: int, levels: tuple[float, float], hold: tuple[float, float]) -> Array:
    """Random levels, each held for so many rows (drawn between two numbers, at least one row)."""
    found: list[float] = []
    while len(found) < rows:
        found += [rng.uniform(*levels)] * max(1, round(rng.uniform(*hold)))
    return np.array(found[:rows])
