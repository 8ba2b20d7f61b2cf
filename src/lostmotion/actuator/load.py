"""Lost motion under load: how far the position moves while the command stands still.

A load that reverses pushes the stem or the shaft from one side of its play to the other.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from lostmotion.actuator.samples import Samples
from lostmotion.arrays import FloatArray

MIN_ROWS = 12  # in which the command stands still: time to settle, and to be pushed
SETTLED_ROWS = 4  # without a move: the position has arrived
PUSHED = 4.0  # resolutions: the load moves the position by more
PUSHED_NOISE = 8.0  # standard deviations of the position: more than its range at rest
MIN_TURNS = 2  # moves in both directions, in all of the record


@dataclass(frozen=True)
class LoadMotion:
    """Range of the position at a constant command.

    Attributes
    ----------
    band : float
        Largest range at one command; the band is never seen wider than it is.
    interval : (float, float)
    offset : float
        Command minus the middle of that range.
    moves : int
        Reversals of the load that move the position.
    """

    band: float
    interval: tuple[float, float]
    offset: float
    moves: int


def load_motion(samples: Samples) -> LoadMotion | None:
    """Range of the settled position at a constant command; None where no load moves it."""
    quiet = max(1.01 * samples.resolution, 4.0 * samples.rest_noise, 2e-4 * samples.op_range)
    pushed = max(PUSHED * samples.resolution, PUSHED_NOISE * samples.noise, 2e-3 * samples.op_range)
    ranges, middles, turns = [], [], 0
    for first, behind in _constant(samples.op):
        position = _without_spikes(samples.position[first:behind])
        settled = _settled(position, quiet)
        if len(settled) < SETTLED_ROWS:
            continue
        ranges.append(float(settled.max() - settled.min()))
        middles.append(float(samples.op[first]) - 0.5 * float(settled.max() + settled.min()))
        turns += _turns(settled, pushed)
    if not ranges or turns < MIN_TURNS or max(ranges) < pushed:
        return None
    largest = int(np.argmax(ranges))
    seen = np.array([one for one in ranges if one > pushed])
    error = max(float(samples.resolution), float(np.median(max(ranges) - seen)), 2.0 * samples.rest_noise)
    return LoadMotion(ranges[largest], (ranges[largest] - error, ranges[largest] + error), middles[largest], turns)


def _without_spikes(position: FloatArray) -> FloatArray:
    """Median of three samples: a hit of the load is no range."""
    stacked = np.vstack([position[:-2], position[1:-1], position[2:]])
    return np.concatenate([position[:1], np.median(stacked, axis=0), position[-1:]])


def _constant(op: FloatArray) -> list[tuple[int, int]]:
    """Rows, first and behind the last, of each stretch in which OP stands still."""
    edges = np.concatenate([[0], np.flatnonzero(np.diff(op) != 0.0) + 1, [len(op)]])
    return [(int(a), int(b)) for a, b in pairwise(edges) if b - a >= MIN_ROWS]


def _settled(position: FloatArray, quiet: float) -> FloatArray:
    """Position from where it first stands still after a step of the command; its reaction is awaited first."""
    position = position[np.isfinite(position)]
    still = np.abs(np.diff(position)) <= quiet
    moved = np.flatnonzero(~still)
    start = int(moved[0]) if len(moved) else 0
    for row in range(start, len(position) - SETTLED_ROWS):
        if still[row : row + SETTLED_ROWS].all():
            return position[row:]
    return position[:0]


def _turns(position: FloatArray, pushed: float) -> int:
    """How often the position moves on in the other direction, by more than `pushed`."""
    turns, low, high, way = 0, position[0], position[0], 0
    for value in position:
        if value - low >= pushed and way <= 0:
            turns, way, high = turns + (way != 0), 1, value
        elif high - value >= pushed and way >= 0:
            turns, way, low = turns + (way != 0), -1, value
        high = max(high, value) if way >= 0 else value
        low = min(low, value) if way <= 0 else value
    return turns
