"""Where a sticking valve slips, and what its steps have in common with lagged signals, from the slips alone.

Between two slips the position is constant, so a sum of products with a lagged signal is a sum over slips of the
position times a difference of the signal's running sum: some hundred terms instead of all rows.

After a slip at the command v in direction d the position is v - d (S - J) / 2; the valve goes on in that direction
from v + d J, and back from v - d S. Kano's valve follows the command until it turns, He's stays after every sample
(both of :mod:`lostmotion.kernels.stiction`, with the same arithmetic).
"""

from __future__ import annotations

import numpy as np
from numba import njit

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.likelihood import all_pole
from lostmotion.kernels.stiction import KANO


@njit(cache=True, nogil=True)
def trace(
    model: int, u: FloatArray, band: float, jump: float, start: float, x: FloatArray, sums: FloatArray, slips: IntArray
) -> tuple[int, int]:
    """Position `x` (n,) from rest at `start`, and its running sum from 0 on `sums` (n + 1,).

    `slips` (n,) gets the rows at which the position changes, in order. Returns their number, and how many of them turn.
    """
    behind, reach = 0.5 * (band - jump), 0.5 * (band + jump)
    position, above, below = start, start + reach, start - reach
    direction = moving = 0.0
    count = turns = 0
    last = u[0]
    sums[0] = total = 0.0
    for k in range(u.size):
        v = u[k]
        if moving != 0.0:  # Kano's only
            if moving * (v - last) > 0.0:
                position = v - moving * behind
                slips[count] = k
                count += 1
            else:
                above = last + jump if moving > 0.0 else last + band
                below = last - band if moving > 0.0 else last - jump
                moving = 0.0
        if moving == 0.0 and (v > above or v < below):
            turned = 1.0 if v > above else -1.0
            turns += direction * turned < 0.0
            direction = turned
            position = v - direction * behind
            above = v + jump if direction > 0.0 else v + band
            below = v - band if direction > 0.0 else v - jump
            slips[count] = k
            count += 1
            if model == KANO:
                moving = direction
        x[k] = position
        total += position
        sums[k + 1] = total
        last = v
    return count, turns


@njit(cache=True, nogil=True)
def _complete(
    x: FloatArray,
    totals: FloatArray,
    first: int,
    last: int,
    start: int,
    stop: int,
    past: FloatArray,
    gram: FloatArray,
) -> None:
    """The rest of both tables from their first rows and columns: a lag more on either side drops and adds a product."""
    inputs = gram.shape[0]
    for i in range(1, past.shape[0]):
        for j in range(1, inputs):
            past[i, j] = (
                past[i - 1, j - 1]
                + (totals[start - i + 1] - totals[start - i]) * x[first - j]
                - (totals[stop - i + 1] - totals[stop - i]) * x[last - j]
            )
    for j in range(inputs):
        gram[j, 0] = gram[0, j]
    for i in range(1, inputs):
        before, after = x[first - i], x[last - i]
        for j in range(i, inputs):
            gram[i, j] = gram[i - 1, j - 1] + before * x[first - j] - after * x[last - j]
            gram[j, i] = gram[i, j]


@njit(cache=True, nogil=True)
def add_slip_table(
    x: FloatArray,
    sums: FloatArray,
    slips: IntArray,
    count: int,
    totals: FloatArray,
    outputs: int,
    delay: int,
    inputs: int,
    start: int,
    stop: int,
    table: FloatArray,
) -> None:
    """:func:`lostmotion.kernels.products.add_lagged_table` of a position that changes at `count` of `slips` only.

    `sums` and `totals` (n + 1,) are the running sums of the position and of y, from 0 on; all rows k - delay - lag are
    inside the record.
    """
    past = np.zeros((outputs + 1, inputs))
    gram = np.zeros((inputs, inputs))
    ones = np.zeros(inputs)
    for j in range(inputs):
        low, high = start - delay - j, stop - delay - j
        ones[j] = sums[high] - sums[low]
    first, last = start - delay, stop - delay
    with_totals = np.zeros(outputs + inputs)  # at lags from -outputs on
    with_itself = np.zeros(inputs)  # at lags inputs - 1 to 0
    begin = 0  # of the stretch of constant position
    for m in range(count + 1):
        end = slips[m] if m < count else x.size
        value = x[begin]
        if begin >= first and end <= last - inputs + 1:  # slices from their own start: they run in lanes
            ahead, behind = totals[end + delay - outputs :], totals[begin + delay - outputs :]
            for i in range(outputs + inputs):
                with_totals[i] += value * (ahead[i] - behind[i])
            ahead, behind = sums[end - inputs + 1 :], sums[begin - inputs + 1 :]
            for i in range(inputs):
                with_itself[i] += value * (ahead[i] - behind[i])
        else:
            low, high = max(begin, first), min(end, last)
            if low < high:
                for i in range(outputs + 1):
                    past[i, 0] += value * (totals[high + delay - i] - totals[low + delay - i])
                for j in range(inputs):
                    gram[0, j] += value * (sums[high - j] - sums[low - j])
            for j in range(1, inputs):
                low, high = max(begin, first - j), min(end, last - j)
                if low < high:
                    past[0, j] += value * (totals[high + delay + j] - totals[low + delay + j])
        begin = end
    for i in range(outputs + 1):
        past[i, 0] += with_totals[outputs - i]
    for j in range(inputs):
        gram[0, j] += with_itself[inputs - 1 - j]
        if j > 0:
            past[0, j] += with_totals[outputs + j]
    _complete(x, totals, first, last, start, stop, past, gram)
    table[0] += ones
    table[-1] += past[0]
    table[1 : outputs + 1] += past[1:]
    table[outputs + 1 : outputs + 1 + inputs] += gram


@njit(cache=True, nogil=True)
def pattern(
    model: int,
    u: FloatArray,
    band: float,
    jump: float,
    start: float,
    last_slip: FloatArray,
    side: FloatArray,
    bounds: FloatArray,
) -> tuple[int, float, int]:
    """The position x = last_slip - side (S - J) / 2 in two parts (n,), and the bands and jumps with the same slips.

    `side` is the direction of the last motion. `bounds` (lowest and highest band, lowest and highest jump) is narrowed:
    a valve stays where it is up to its band or jump, and slips beyond. Before its first slip, in direction d at the
    command v, it rests at (S + J) / 2 behind v, nearly: in the middle of the places from which it slips there and not
    before. Returns the row of the first slip (n where there is none), that first position and the number of turns.
    """
    reach = 0.5 * (band + jump)
    direction = moving = 0.0
    anchor = last = lowest = highest = u[0]
    level, first, turns = start, u.size, 0
    for k in range(u.size):
        v = u[k]
        if moving != 0.0:
            if moving * (v - last) > 0.0:
                level = v
            else:
                anchor = last
                moving = 0.0
        if moving == 0.0:
            slipped = True
            if direction == 0.0:
                if abs(v - start) > reach:
                    direction = 1.0 if v > start else -1.0
                    if direction > 0.0:
                        edge = 0.5 * (min(v, lowest + 2.0 * reach) + highest)
                    else:
                        edge = 0.5 * (max(v, highest - 2.0 * reach) + lowest)
                    start = edge - direction * reach
                    last_slip[:k] = edge - direction * band
                    side[:k] = -direction
                    first = k
                else:
                    lowest, highest = min(lowest, v), max(highest, v)
                    slipped = False
            else:
                ahead = direction * (v - anchor)
                if ahead > jump:
                    bounds[3] = min(bounds[3], ahead)
                elif -ahead > band:
                    bounds[1] = min(bounds[1], -ahead)
                    direction = -direction
                    turns += 1
                else:
                    bounds[0] = max(bounds[0], -ahead)
                    bounds[2] = max(bounds[2], ahead)
                    slipped = False
            if slipped:
                level = anchor = v
                if model == KANO:
                    moving = direction
        last_slip[k] = level
        side[k] = direction
        last = v
    return first, start, turns


@njit(cache=True, nogil=True)
def first_positions(u: FloatArray, band: float, jump: float) -> FloatArray:
    """From where a valve can slip for the first time at one row or another, in all ways that `u` (n,) allows, in order.

    It slips first where u is higher, or lower, than ever before, as long as u has stayed within S + J.
    """
    reach = 0.5 * (band + jump)
    found = np.empty(2 * u.size)
    count = 0
    lowest = highest = u[0]
    for k in range(1, u.size):
        v = u[k]
        if v > highest:
            found[count] = 0.5 * (min(v, lowest + 2.0 * reach) + highest) - reach
            count += 1
            highest = v
        elif v < lowest:
            found[count] = 0.5 * (max(v, highest - 2.0 * reach) + lowest) + reach
            count += 1
            lowest = v
        if highest - lowest > 2.0 * reach:
            break
    return np.sort(found[:count])


@njit(cache=True, nogil=True)
def through_process(x: FloatArray, numerator: FloatArray, a: FloatArray, skipped: int, out: FloatArray) -> None:
    """Write numerator/A x from rest into `out` (n - skipped,) without its first rows; x (n,) changes at few of them."""
    n, late = x.size, numerator.size
    steps = np.cumsum(numerator)
    drive, settled = np.zeros(n + late), np.zeros(n + late)  # settled: changes that have passed the whole numerator
    before = 0.0
    for k in range(n):
        change = x[k] - before
        if change != 0.0:
            part = drive[k : k + late]
            for i in range(late):
                part[i] += change * steps[i]
            settled[k + late] += change
            before = x[k]
    total = 0.0
    for k in range(n):
        total += settled[k]
        drive[k] += total * steps[-1]
    all_pole(a, drive[:n], settled)
    out[:] = settled[skipped:n]
