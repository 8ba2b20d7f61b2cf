"""Linear processes with dead time, and what may stand behind them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy import signal

Array = np.ndarray
ZERO = 1e-9


class StateSpace(NamedTuple):
    """Process from row to row: x(k+1) = A x + b u, y = c x + d u, u delayed by so many rows."""

    a: Array
    b: Array
    c: Array
    d: float
    delay: int


@dataclass(frozen=True)
class Process:
    """From the place of the stem to PV, both away from rest, in %.

    Parameters
    ----------
    numerator, denominator : tuple of float
        Powers of s, the highest first; of a sampled process those of 1/z, the lowest first.
    dead_time : float
        In seconds; of a sampled process in rows.
    sampled : bool
        Whether it is given from row to row.
    bend : float
        Of PV behind it: y + bend y^2 (1/%).
    """

    numerator: tuple[float, ...]
    denominator: tuple[float, ...]
    dead_time: float = 0.0
    sampled: bool = False
    bend: float = 0.0

    @property
    def gain(self) -> float:
        """At rest; NaN of an integrating process."""
        if self.sampled:
            below = float(np.sum(self.denominator))
            return float(np.sum(self.numerator)) / below if abs(below) > ZERO else float("nan")
        below = self.denominator[-1]
        return self.numerator[-1] / below if abs(below) > ZERO else float("nan")

    def state_space(self, seconds: float) -> StateSpace:
        """With a stem that stands for a row of so many seconds."""
        if self.sampled:
            longest = max(len(self.numerator), len(self.denominator))
            padded = [np.pad(one, (0, longest - len(one))) for one in (self.numerator, self.denominator)]
            a, b, c, d = signal.tf2ss(*padded)
            delay = round(self.dead_time)
        else:
            system = signal.tf2ss(self.numerator, self.denominator)
            a, b, c, d, _ = signal.cont2discrete(system, seconds)
            delay = round(self.dead_time / seconds)
        return StateSpace(a, b[:, 0], c[0], float(d[0, 0]), delay)

    def slower(self, times: float) -> Process:
        """All its times longer; a sampled one as it is, since its time is the row."""
        if self.sampled:
            return self
        order = len(self.denominator) - 1
        longer = tuple(one * times ** (order - k) for k, one in enumerate(self.denominator))
        top = len(self.numerator) - 1
        upper = tuple(one * times ** (top - k) for k, one in enumerate(self.numerator))
        return Process(upper, longer, self.dead_time * times, bend=self.bend)


def lags(gain: float, *times: float, dead_time: float = 0.0, bend: float = 0.0) -> Process:
    """K e^-Ls / ((T1 s + 1) (T2 s + 1) ..)."""
    denominator: Array = np.ones(1)
    for time in times:
        denominator = np.polymul(denominator, [time, 1.0])
    return Process((gain,), tuple(map(float, denominator)), dead_time, bend=bend)


def integrating(gain: float, dead_time: float = 0.0) -> Process:
    """K e^-Ls / s."""
    return Process((gain,), (1.0, 0.0), dead_time)


def response(space: StateSpace, frequencies: Array) -> Array:
    """Of the sampled process at frequencies in rad/row, with the row that the controller waits for an answer.

    A stem given in row k moves PV of row k + 1 at the earliest; a process with a direct term has that row in its delay.
    """
    z = np.exp(1j * frequencies)
    states = np.linalg.solve(z[:, None, None] * np.eye(len(space.b)) - space.a, space.b[:, None])[:, :, 0]
    late = space.delay + (1 if space.d else 0)
    return np.asarray((states @ space.c + space.d) * z**-late)
