"""True sizes, measured from the motion of a stem in its own steps of time.

A step of the command brackets a size: the stem still stood at the largest turn before, and moved at the one after.
Where all brackets hold the size of the parameters, that is the true one; where they do not (a friction that depends on
speed, a model that forgets where it stuck), the median of their middles is.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numba import njit

Array = np.ndarray
PLACE, AT, WAY, FURTHEST, COUNT, STATES = range(6)  # of what a meter remembers
MOST_TURNS = 20_000
SAME_PLACE = 1e-9  # %: a stem that follows a rule stands exactly


class Meter(Protocol):
    """Watches a stem."""

    def see(self, command: float, place: float) -> None:
        """Next step of command and stem."""

    def forget(self) -> None:
        """The record begins here: what was measured before is not in it."""

    @property
    def brackets(self) -> Array:
        """Sizes between which the true one lies, shape (turns, 2), % of OP."""


def measured_size(brackets: Array, expected: float) -> float:
    """The expected size where no turn speaks against it, otherwise what the turns say; % of OP."""
    if np.all((brackets[:, 0] <= expected) & (expected <= brackets[:, 1])):
        return expected
    return float(np.median(brackets.mean(axis=1)))


@njit
def see_turn(state: Array, brackets: Array, command: float, place: float, least: float) -> None:
    """Write down a turn of the stem; moves within `least` are none."""
    moved = place - state[PLACE]
    if abs(moved) <= least:
        state[FURTHEST] = max(state[FURTHEST], (state[AT] - command) * state[WAY])
        return
    way = np.sign(moved)
    count = int(state[COUNT])
    if state[WAY] == -way and count < len(brackets):
        brackets[count, 0] = state[FURTHEST]
        brackets[count, 1] = abs(command - state[AT])
        state[COUNT] += 1
    state[PLACE], state[AT], state[WAY], state[FURTHEST] = place, command, way, 0.0


class Turns:
    """How far the command turns between the last move of a stem one way and its first move back.

    Parameters
    ----------
    place : float
        Command and stem at first, %.
    least : float
        Move that counts, %; more than what a bristle gives before it breaks away.
    """

    def __init__(self, place: float, least: float = SAME_PLACE) -> None:
        self.state, self.least = np.zeros(STATES), least
        self.state[[PLACE, AT]] = place
        self._brackets = np.zeros((MOST_TURNS, 2))

    def see(self, command: float, place: float) -> None:
        see_turn(self.state, self._brackets, command, place, self.least)

    def forget(self) -> None:
        self.state[COUNT] = 0

    @property
    def brackets(self) -> Array:
        return self._brackets[: int(self.state[COUNT])]

    @property
    def room(self) -> Array:
        """Where kernels write brackets, shape (MOST_TURNS, 2)."""
        return self._brackets


class Crossings:
    """How far the command goes while a stem behind a dead zone rests in its middle, from one side to the other.

    Parameters
    ----------
    middle : float
        Place of the stem inside the zone, %.
    """

    def __init__(self, middle: float) -> None:
        self.middle, self.side = middle, 0.0
        self.outside = middle  # last command beyond the zone
        self.inside: list[float] = []
        self.found: list[tuple[float, float]] = []

    def see(self, command: float, place: float) -> None:
        side = float(np.sign(place - self.middle))
        if side == 0:
            self.inside.append(command)
            return
        if side == -self.side:
            through = max(self.inside) - min(self.inside) if self.inside else 0.0
            self.found.append((through, abs(command - self.outside)))
        self.side, self.outside = side, command
        self.inside.clear()

    def forget(self) -> None:
        self.found.clear()

    @property
    def brackets(self) -> Array:
        return np.array(self.found).reshape(-1, 2)
