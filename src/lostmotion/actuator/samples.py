"""Samples of command and position, with what is known of the noise and the resolution of the position."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.records import LoopRecord

MAX_ROWS = 2500  # longer records are read at their most informative stretch of so many rows: a fit takes seconds
SETTLING_ROWS = 60  # at most, a tenth of the record: the state of the actuator before the first row is not known
INTEGER_SHARE = 0.99  # of the steps of the position that are whole numbers of one resolution
FINEST = 2e-5  # of the range of OP: no position is taken for more exact
QUIETEST = 0.1  # share of the steps from which the noise of a position at rest is taken
NORMAL_TENTH = 0.1257  # of the absolute value of a normal number: 10 % are smaller
SECOND_DIFFERENCE = 2.449  # standard deviation of the second difference of white noise, sqrt(6)


@dataclass(frozen=True, eq=False)
class Samples:
    """Command and position of one actuator.

    Attributes
    ----------
    op, position : ndarray, shape (n,)
        NaN where a sample is missing.
    dt : float
        Sampling time in seconds.
    fresh : ndarray, shape (n,)
        1 where a row does not follow its predecessor.
    resolution : float
        Smallest step of the position where it is quantised, else 0.
    noise : float
        Standard deviation of the position, from second differences; too large where it moves in jumps.
    rest_noise : float
        The same from the quietest tenth of the steps: that of a position which holds for a tenth of the time.
    """

    op: FloatArray
    position: FloatArray
    dt: float
    fresh: FloatArray
    resolution: float = field(init=False)
    noise: float = field(init=False)
    rest_noise: float = field(init=False)

    def __post_init__(self) -> None:
        steps = np.abs(np.diff(self.position))
        steps = steps[np.isfinite(steps)]
        resolution = step_size(steps)
        second = np.abs(np.diff(self.position, 2))
        floor = FINEST * self.op_range
        noise = 1.4826 * float(np.nanmedian(second)) / SECOND_DIFFERENCE if np.isfinite(second).any() else 0.0
        quiet = float(np.quantile(steps, QUIETEST)) / (NORMAL_TENTH * np.sqrt(2.0)) if len(steps) else 0.0
        object.__setattr__(self, "resolution", resolution)
        object.__setattr__(self, "noise", max(0.29 * resolution, floor, noise))
        object.__setattr__(self, "rest_noise", max(quiet, 0.0 if resolution else floor))

    def __len__(self) -> int:
        return len(self.op)

    @property
    def op_range(self) -> float:
        """Range of OP in the record."""
        return float(np.nanmax(self.op) - np.nanmin(self.op))

    @property
    def settling(self) -> int:
        """Rows at the beginning that do not count."""
        return min(len(self) // 10, SETTLING_ROWS)

    @property
    def finest(self) -> float:
        """Smallest standard deviation that a residual of the position may have."""
        return max(0.25 * self.resolution, FINEST * self.op_range)

    @property
    def longest_delay(self) -> float:
        """Longest dead time that is searched, in samples: one sample, or 1.5 s."""
        return max(1.0, 1.5 / self.dt)

    def most_informative(self) -> Samples:
        """Stretch of at most MAX_ROWS rows in which OP moves most."""
        if len(self) <= MAX_ROWS:
            return self
        travel = np.concatenate([[0.0], np.cumsum(np.abs(np.nan_to_num(np.diff(self.op))))])
        first = int(np.argmax(travel[MAX_ROWS - 1 :] - travel[: len(self) - MAX_ROWS + 1]))
        rows = slice(first, first + MAX_ROWS)
        return Samples(self.op[rows].copy(), self.position[rows].copy(), self.dt, self.fresh[rows].copy())


def step_size(steps: FloatArray) -> float:
    """Resolution of which all of these steps are whole numbers; 0 where there is none.

    Examples
    --------
    >>> step_size(np.array([0.0, 0.5, 1.0, 0.0, 2.5])), step_size(np.array([0.1, 0.1234, 0.317]))
    (0.5, 0.0)
    """
    moves = steps[steps > 1e-9 * max(float(steps.max(initial=0.0)), 1e-300)]
    if len(moves) < 3:
        return 0.0
    smallest = float(moves.min())
    whole = moves / smallest
    return smallest if float(np.mean(np.abs(whole - np.round(whole)) < 0.02)) >= INTEGER_SHARE else 0.0


def samples_of(record: LoopRecord) -> Samples:
    """Command and position of a record that has a position."""
    fresh = np.zeros(len(record))
    fresh[list(record.gaps)] = 1.0
    position = record.position if record.position is not None else record.pv
    op, position = np.array(record.op), np.array(position)
    position[np.isnan(op)] = np.nan
    return Samples(op, position, record.dt, fresh)
