"""Rate limit: the speed at which the position catches up with a command that is far away."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from lostmotion.actuator.samples import Samples
from lostmotion.arrays import FloatArray

MIN_ROWS = 5  # of a run: speed of shorter ones is that of single samples
MIN_TOTAL_ROWS = 12  # of all runs together
MAX_SCATTER = 0.25  # quartile range of the speeds of runs over their median
STRAIGHT = 1.15  # speed of the first half of a run over that of the second: a lag of the first order slows down
NEARER = 1.6  # distance of the command at the beginning of a run over that at its end: enough for a lag to slow down
ALREADY_THERE = 2.0  # moves of a sample: nearer to its command than this the position slows down
MAX_FASTER = 1.4  # of the limit: 95 % of all moves are slower than this, or it is none
SLOW_COMMAND = 0.5  # of the speed: a command that itself moves so fast may set the speed


def rate_limit(samples: Samples) -> float:
    """Largest move of the position in a sample; inf where the record does not show one.

    The mean speed of runs in which the position moves towards a command that is far away and does not move. It must be
    the same from the first half of a run to the second, and from run to run.
    """
    runs = [run for run in _runs(samples) if run is not None]
    if not runs or sum(rows for _, rows in runs) < MIN_TOTAL_ROWS:
        return math.inf
    speeds = np.repeat([speed for speed, _ in runs], [rows for _, rows in runs])
    low, middle, high = np.quantile(speeds, [0.25, 0.5, 0.75])
    moves = np.abs(np.diff(samples.position))
    fastest = float(np.quantile(moves[moves > 0.1 * middle], 0.95))
    return float(middle) if high - low <= MAX_SCATTER * middle and fastest <= MAX_FASTER * middle else math.inf


def _runs(samples: Samples) -> list[tuple[float, int] | None]:
    """Speed and number of rows of each run."""
    moves = np.diff(samples.position)
    distance = samples.op[:-1] - samples.position[:-1]
    threshold = max(
        2.0 * samples.resolution, 0.002 * samples.op_range, min(3.0 * samples.rest_noise, 0.01 * samples.op_range)
    )
    with np.errstate(invalid="ignore"):
        away = (moves * np.sign(distance) > threshold) & (np.abs(distance) > ALREADY_THERE * np.abs(moves))
        away &= samples.fresh[1:] == 0.0
    edges = np.flatnonzero(np.diff(np.concatenate([[False], away, [False]]).astype(np.int8)))
    return [_speed(samples, first + 1, behind) for first, behind in zip(edges[::2], edges[1::2], strict=True)]


def _speed(samples: Samples, first: int, behind: int) -> tuple[float, int] | None:
    """Mean speed from row `first` to the one before `behind`, and its rows; None where it is no steady one."""
    position: FloatArray = samples.position[first : behind + 1]
    if len(position) <= MIN_ROWS:
        return None
    ends = (0, len(position) // 2, len(position) - 1)
    halves = [abs(position[b] - position[a]) / (b - a) for a, b in pairwise(ends)]
    speed = abs(position[-1] - position[0]) / (len(position) - 1)
    command = abs(samples.op[behind] - samples.op[first]) / (len(position) - 1)
    distance = np.abs(samples.op[[first, behind]] - position[[0, -1]])
    if (
        distance[0] < NEARER * distance[1]
        or halves[0] > STRAIGHT * halves[1]
        or halves[1] > STRAIGHT * halves[0]
        or command > SLOW_COMMAND * speed
    ):
        return None
    return float(speed), len(position) - 1
