"""Where a sticking valve slips, and what its steps have in common with lagged signals, from the slips alone.

Between two slips the position is constant, so a sum of products with a lagged signal is a sum over slips of the
position times a difference of the signal's running sum: some hundred terms instead of all rows.

After a slip at the command v in direction d the position is v - d (S - J) / 2; the valve goes on in that direction
from v + d J, and back from v - d S. Kano's valve follows the command until it turns, He's stays after every sample, and
so it does where the command comes in a ramp (all of :mod:`lostmotion.kernels.stiction`, with the same arithmetic).
"""

from __future__ import annotations

import numpy as np
from numba import njit

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.lanes import WIDTH, address, load, plus_product, spread, store
from lostmotion.kernels.products import complete, explained
from lostmotion.kernels.stiction import HE_RAMP, KANO, SHORTEST_SLIP, mean_on_ramp, slips_on_ramp

LAGS = 4 * WIDTH  # of which sums are made at a time


@njit(cache=True, nogil=True)
def trace(
    model: int,
    u: FloatArray,
    band: float,
    jump: float,
    start: float,
    x: FloatArray,
    sums: FloatArray,
    slips: IntArray,
    changes: FloatArray,
) -> tuple[int, int]:
    """Position `x` (n,) from rest at `start`, and its running sum from 0 on `sums` (n + 1 or more).

    `slips` and `changes` (n + 1,) get the rows at which the position changes, in order, and how far it falls there.
    Returns their number, and how many of them turn.
    """
    if model == KANO:
        return _trace_kano(u, band, jump, start, x, sums, slips, changes)
    if model == HE_RAMP:
        return _trace_on_ramp(u, band, jump, start, x, sums, slips, changes)
    return _trace_he(u, band, jump, start, x, sums, slips, changes)


@njit(cache=True, nogil=True)
def _trace_kano(
    u: FloatArray,
    band: float,
    jump: float,
    start: float,
    x: FloatArray,
    sums: FloatArray,
    slips: IntArray,
    changes: FloatArray,
) -> tuple[int, int]:
    behind, reach = 0.5 * (band - jump), 0.5 * (band + jump)
    position, above, below = start, start + reach, start - reach
    direction = moving = 0.0
    count = turns = 0
    last = u[0]
    sums[0] = total = 0.0
    for k in range(u.size):
        v = u[k]
        if moving != 0.0:
            if moving * (v - last) > 0.0:
                slips[count], changes[count] = k, position
                position = v - moving * behind
                changes[count] -= position
                count += 1
            else:
                above = last + jump if moving > 0.0 else last + band
                below = last - band if moving > 0.0 else last - jump
                moving = 0.0
        if moving == 0.0 and (v > above or v < below):
            moving = 1.0 if v > above else -1.0
            turns += direction * moving < 0.0
            direction = moving
            slips[count], changes[count] = k, position
            position = v - direction * behind
            changes[count] -= position
            count += 1
        x[k] = position
        total += position
        sums[k + 1] = total
        last = v
    return count, turns


@njit(cache=True, nogil=True)
def _trace_he(
    u: FloatArray,
    band: float,
    jump: float,
    start: float,
    x: FloatArray,
    sums: FloatArray,
    slips: IntArray,
    changes: FloatArray,
) -> tuple[int, int]:
    """Without branches: where the valve slips often, a processor would guess half of them wrong."""
    behind, reach = 0.5 * (band - jump), 0.5 * (band + jump)
    position, above, below = start, start + reach, start - reach
    direction = 0.0
    count = turns = 0
    sums[0] = total = 0.0
    for k in range(u.size):
        v = u[k]
        up = v > above
        slipped = up | (v < below)
        turned = 1.0 if up else -1.0
        after = v - behind if up else v + behind
        highest = v + jump if up else v + band
        lowest = v - band if up else v - jump
        slips[count], changes[count] = k, position - after  # overwritten by the next unless it slips
        count += slipped
        turns += slipped & (direction * turned < 0.0)
        direction = turned if slipped else direction
        position = after if slipped else position
        above = highest if slipped else above
        below = lowest if slipped else below
        x[k] = position
        total += position
        sums[k + 1] = total
    return count, turns


@njit(cache=True, nogil=True)
def _trace_on_ramp(
    u: FloatArray,
    band: float,
    jump: float,
    start: float,
    x: FloatArray,
    sums: FloatArray,
    slips: IntArray,
    changes: FloatArray,
) -> tuple[int, int]:
    """A slip between two rows changes the mean position of the row in which it ends, and of the next."""
    reach = 0.5 * (band + jump)
    long = max(jump, SHORTEST_SLIP * reach)
    position = mean = last = start
    direction = 0.0
    count = turns = 0
    sums[0] = total = 0.0
    for k in range(u.size):
        v, before = u[k], mean
        mean = position
        if abs(v - position) > reach:
            number, way, at = slips_on_ramp(last, v, position, reach, long)
            turns += direction * way < 0.0
            direction = way
            mean = mean_on_ramp(position, way, number, at, long, v - last)
            position += way * number * long
        if mean != before:
            slips[count], changes[count] = k, before - mean
            count += 1
        x[k] = mean
        total += mean
        sums[k + 1] = total
        last = v
    return count, turns


@njit(cache=True, nogil=True)
def _add_shifted(
    changes: FloatArray,
    slips: IntArray,
    low: int,
    high: int,
    running: FloatArray,
    offset: int,
    out: FloatArray,
) -> None:
    """Add to `out` (m,) the sums over slips from `low` to `high` of their change times `running` at slip + offset + i.

    m is a multiple of LAGS: that many sums at a time stay in registers.
    """
    weights, rows, values, sums = address(changes), address(slips), address(running), address(out)
    for i in range(0, out.size, LAGS):
        at = i + offset
        s0, s1 = load(sums, i), load(sums, i + WIDTH)
        s2, s3 = load(sums, i + 2 * WIDTH), load(sums, i + 3 * WIDTH)
        for m in range(low, high):
            change, begin = spread(weights[m]), rows[m] + at
            s0 = plus_product(s0, change, load(values, begin))
            s1 = plus_product(s1, change, load(values, begin + WIDTH))
            s2 = plus_product(s2, change, load(values, begin + 2 * WIDTH))
            s3 = plus_product(s3, change, load(values, begin + 3 * WIDTH))
        store(sums, i, s0)
        store(sums, i + WIDTH, s1)
        store(sums, i + 2 * WIDTH, s2)
        store(sums, i + 3 * WIDTH, s3)


@njit(cache=True, nogil=True)
def add_slip_table(
    x: FloatArray,
    sums: FloatArray,
    slips: IntArray,
    changes: FloatArray,
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

    `sums` and `totals` (n + 1 + LAGS or more) are the running sums of the position and of y, from 0 on; all rows
    k - delay - lag are inside the record. Summed by parts: the sum of x(k) f(k) from `first` to before `last` is
    x(last - 1) F(last) - x(first) F(first) and, for every slip between them, its change times F there.
    """
    first, last = start - delay, stop - delay
    past, gram = np.empty((outputs + 1, inputs)), np.empty((inputs, inputs))
    with_totals = np.zeros((outputs + inputs + LAGS - 1) // LAGS * LAGS)  # at lags from -outputs on
    with_itself = np.zeros((inputs + LAGS - 1) // LAGS * LAGS)  # at lags inputs - 1 to 0
    low, high = int(np.searchsorted(slips[:count], first, "right")), int(np.searchsorted(slips[:count], last))
    late = low + int(np.searchsorted(slips[low:high], last - inputs, "right"))  # to there: between for all lags
    _add_shifted(changes, slips, low, high, sums, 1 - inputs, with_itself)
    _add_shifted(changes, slips, low, late, totals, delay - outputs, with_totals)
    for m in range(late, high):
        at, change = slips[m] + delay, changes[m]
        for i in range(outputs + 1):
            with_totals[outputs - i] += change * totals[at - i]
        for j in range(1, last - slips[m]):
            with_totals[outputs + j] += change * totals[at + j]
    for m in range(low - 1, -1, -1):
        if slips[m] <= first - inputs + 1:
            break
        for j in range(first - slips[m] + 1, min(inputs, last - slips[m])):
            with_totals[outputs + j] += changes[m] * totals[slips[m] + delay + j]
    outer, ends = np.zeros((2, outputs + 1)), np.zeros((2, inputs))  # at lag 0 nothing is let in or out
    for i in range(outputs + 1):
        past[i, 0] = with_totals[outputs - i] + x[last - 1] * totals[stop - i] - x[first] * totals[start - i]
        if i > 0:
            outer[0, i] = totals[start - i + 1] - totals[start - i]
            outer[1, i] = totals[stop - i + 1] - totals[stop - i]
    for j in range(inputs):
        gram[0, j] = with_itself[inputs - 1 - j] + x[last - 1] * sums[last - j] - x[first] * sums[first - j]
        gram[j, 0], table[0, j] = gram[0, j], table[0, j] + sums[last - j] - sums[first - j]
        if j > 0:
            ends[0, j], ends[1, j] = x[first - j], x[last - j]
            past[0, j] = with_totals[outputs + j] + x[last - j - 1] * totals[stop] - x[first - j] * totals[start]
    complete(past, outer, ends)
    complete(gram, ends, ends)
    table[-1] += past[0]
    table[1 : outputs + 1] += past[1:]
    table[outputs + 1 : outputs + 1 + inputs] += gram


@njit(cache=True, nogil=True)
def explained_by_slips(
    models: IntArray,
    etas: FloatArray,
    rests: FloatArray,
    u: FloatArray,
    totals: FloatArray,
    pieces: IntArray,
    outputs: int,
    delay: int,
    inputs: int,
    basis: FloatArray,
    known: FloatArray,
    floor: float,
    ridge: float,
    turns: int,
) -> FloatArray:
    """What valves explain, as :func:`lostmotion.kernels.products.explained_by_lags`; -inf with fewer turns.

    `etas` (v, 2) are their bands and jumps, `rests` (v, s) their first positions in the first segments, in halves of
    S + J; `totals` (n + 1 + LAGS,) the running sum of y. `pieces` (p, 4): the index of a segment, its first row, and
    the first row that is predicted and the one after the last.
    """
    longest = 0
    for piece in pieces:
        longest = max(longest, piece[3] - piece[1])
    x, sums = np.empty(longest), np.zeros(longest + 1 + LAGS)
    slips, changes = np.empty(longest + 1, np.int64), np.empty(longest + 1)
    found = np.empty(models.size)
    table = np.empty((outputs + inputs + 2, inputs))
    for v in range(models.size):
        band, jump = etas[v]
        turned = 0
        table[:] = 0.0
        for index, head, first, stop in pieces:
            rest = rests[v, index] if index < rests.shape[1] else 0.0
            start = u[head] + 0.5 * rest * (band + jump)
            part = x[: stop - head]
            count, more = trace(models[v], u[head:stop], band, jump, start, part, sums, slips, changes)
            turned += more
            add_slip_table(
                part, sums, slips, changes, count, totals[head:], outputs, delay, inputs, first - head, stop - head,
                table,
            )  # fmt: skip
        found[v] = explained(table, basis, known, floor, ridge) if turned >= turns else -np.inf
    return found
