"""Set points, loads and the operator's hand: of the base case, and as ingredients have them.

A set point is a value for each row, in % from 50. A slow load is a value for each row and one more, a wave a value for
each fine step; both in % of OP, added to the flow through the valve.
"""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter

from one_ingredient.draw import Case, Streams
from one_ingredient.valves import FINE_STEP, FINE_STEPS, Array

LEVEL_HOLD = 120  # rows: the inflow of a level stands so long
LARGEST_WALK = 25.0  # %


def steps(case: Case, streams: Streams) -> Array:
    """Steps to places within the reach, of uneven length; at rest at first."""
    set_point, row, rng = np.empty(case.rows), 0, streams.set_point
    while row < case.rows:
        length = int(case.hold * rng.uniform(0.6, 1.4)) + 1
        set_point[row : row + length] = rng.uniform(-case.pv_reach, case.pv_reach)
        row += length
    set_point[: int(case.hold * 0.3)] = 0
    return set_point


def constant(case: Case, _streams: Streams) -> Array:
    """At rest."""
    return np.zeros(case.rows)


def ramps(case: Case, streams: Streams) -> Array:
    """From place to place, always moving."""
    steps(case, streams)  # only so that the places are those drawn behind the base case's steps
    ends = np.arange(0, case.rows + int(case.hold), int(case.hold))
    places = streams.set_point.uniform(-case.pv_reach, case.pv_reach, len(ends))
    return np.interp(np.arange(case.rows), ends, places)


def sine(case: Case, streams: Streams) -> Array:
    """One period."""
    period = case.wanted_lag * streams.change.uniform(6, 15)
    return case.pv_reach * np.sin(2 * np.pi * np.arange(case.rows) / period)


def two_values(case: Case, streams: Streams) -> Array:
    """A pseudo-random binary sequence."""
    length = int(case.wanted_lag * streams.change.uniform(1.5, 3))
    signs = streams.change.choice([-1, 1], case.rows // length + 1)
    return np.repeat(signs, length)[: case.rows] * case.pv_reach * 0.6


def of_a_master(case: Case, streams: Streams) -> Array:
    """The output of a master controller: slow, with its noise, new in each row."""
    slow = slow_noise(streams.change.normal(size=case.rows), case.wanted_lag * 4)
    return case.pv_reach * 0.6 * slow + streams.change.normal(size=case.rows) * 0.02 * case.pv_reach


def slow_noise(white: Array, lag: float) -> Array:
    """White noise behind a lag, in rows, with the deviation of the white noise."""
    kept = np.exp(-1 / lag)
    return np.asarray(lfilter([np.sqrt(1 - kept * kept)], [1.0, -kept], white))


def slow_load(case: Case, streams: Streams) -> Array:
    """Of the base case."""
    return case.load_deviation * slow_noise(streams.load.normal(size=case.rows + 1), case.load_lag)


def walk(case: Case, streams: Streams) -> Array:
    """A random walk."""
    slow_load(case, streams)  # only so that the walk is drawn behind it
    moves = streams.load.normal(size=case.rows + 1)
    return np.clip(np.cumsum(moves) * streams.change.uniform(0.05, 0.15), -LARGEST_WALK, LARGEST_WALK)


def inflow_steps(case: Case, streams: Streams) -> Array:
    """Steps of what flows into a tank."""
    inflows = streams.change.uniform(-10, 10, case.rows // LEVEL_HOLD + 2)
    return slow_load(case, streams) + np.repeat(inflows, LEVEL_HOLD)[: case.rows + 1]


def day_and_night(case: Case, streams: Streams) -> Array:
    """Another load, and a rougher one, in every second fifth of the record."""
    day = (np.arange(case.rows + 1) // (case.rows // 5)) % 2
    more = day * streams.change.uniform(5, 10)
    return slow_load(case, streams) + more + day * streams.change.normal(size=case.rows + 1) * 0.8


def fine_times(case: Case) -> Array:
    """Of the fine steps, in rows."""
    return np.arange(case.rows * FINE_STEPS) * FINE_STEP


def no_wave(_case: Case, times: Array, _ultimate_period: float, _streams: Streams) -> Array:
    """Of the base case."""
    return np.zeros(times.size)


def wave_near_ringing(_case: Case, times: Array, ultimate_period: float, streams: Streams) -> Array:
    """A sine with about the period at which the loop would ring."""
    size = streams.change.uniform(1, 4)
    return size * np.sin(2 * np.pi * times / (ultimate_period * streams.change.uniform(0.8, 1.6)))


def slower_wave(_case: Case, times: Array, ultimate_period: float, streams: Streams) -> Array:
    """A sine with up to three times that period."""
    size = streams.change.uniform(1, 4)
    return size * np.sin(2 * np.pi * times / (ultimate_period * streams.change.uniform(0.9, 3)))


def square_wave(case: Case, times: Array, _ultimate_period: float, streams: Streams) -> Array:
    """A load that goes on and off."""
    size = streams.change.uniform(1, 4)
    return size * np.sign(np.sin(2 * np.pi * times / (case.wanted_lag * streams.change.uniform(6, 20))))


def sawtooth(case: Case, times: Array, _ultimate_period: float, streams: Streams) -> Array:
    """A load that rises evenly and falls at once."""
    size = streams.change.uniform(2, 6)
    return size * (2 * ((times / (case.wanted_lag * streams.change.uniform(6, 20))) % 1) - 1)


def automatic(case: Case, _streams: Streams) -> tuple[Array, Array]:
    """Whether the operator has the valve, and the OP that he gives (NaN: he leaves it); of the base case."""
    return np.zeros(case.rows, dtype=bool), np.full(case.rows, np.nan)


def now_and_then(case: Case, streams: Streams) -> tuple[Array, Array]:
    """Spells of the operator, who leaves OP where it is at first and then moves it."""
    (manual, output), rng, begin = automatic(case, streams), streams.change, int(case.hold)
    while begin < case.rows:
        length = int(case.hold * rng.uniform(0.5, 2))
        manual[begin : begin + length] = True
        row = begin + int(length * 0.2)
        while row < min(begin + length, case.rows):
            end = row + int(rng.uniform(2, 6) * case.wanted_lag) + 1
            output[row : min(end, begin + length)] = 50 + rng.uniform(-case.reach, case.reach)
            row = end
        begin += int(length + case.hold * rng.uniform(1, 4))
    return manual, output


def bump_test(case: Case, streams: Streams) -> tuple[Array, Array]:
    """The operator moves OP in steps, over the whole record."""
    manual, output, row = np.ones(case.rows, dtype=bool), np.full(case.rows, np.nan), 0
    while row < case.rows:
        length = int(case.wanted_lag * streams.change.uniform(2, 8)) + 1
        output[row : row + length] = 50 + streams.change.uniform(-case.reach, case.reach)
        row += length
    return manual, output
