"""Where a sticking valve slips, and what its steps have in common with lagged signals, from the slips alone.

Between two slips the position is constant, so a sum of products with a lagged signal is a sum over slips of the
position times a difference of the signal's running sum: some hundred terms instead of all rows.

After a slip at the command v in direction d the position is v - d (S - J) / 2; the valve goes on in that direction
from v + d J, and back from v - d S. Kano's valve follows the command until it turns, He's stays after every sample, and
so it does where the command comes in a ramp (all of :mod:`lostmotion.kernels.stiction`, with the same arithmetic).
"""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.eight_valves import EIGHT, follow_all
from lostmotion.kernels.lanes import WIDEST, address, load_widest, plus_product, spread_widest, store
from lostmotion.kernels.numba_cache import njit
from lostmotion.kernels.products import complete, explained
from lostmotion.kernels.stiction import HE, HE_RAMP, KANO

LAGS = 4 * WIDEST  # of which sums are made at a time


@njit(nogil=True, inline="always")
def find_slips(x: FloatArray, sums: FloatArray, slips: IntArray, changes: FloatArray) -> int:
    """Put the running sum of a position `x` (n,) from 0 on into `sums` (n + 1 or more); the number of its changes.

    `slips` and `changes` (n or more,) get the rows at which it changes, in order, and how far it falls there. Without
    branches: where the valve slips often, a processor would guess half of them wrong.
    """
    count, total, last = 0, 0.0, x[0]
    sums[0] = 0.0
    for k in range(x.size):
        position = x[k]
        slips[count], changes[count] = k, last - position  # overwritten by the next unless it slips
        count += position != last
        total += position
        sums[k + 1] = total
        last = position
    return count


@njit(nogil=True)
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
        s0, s1 = load_widest(sums, i), load_widest(sums, i + WIDEST)
        s2, s3 = load_widest(sums, i + 2 * WIDEST), load_widest(sums, i + 3 * WIDEST)
        for m in range(low, high):
            change, begin = spread_widest(weights[m]), rows[m] + at
            s0 = plus_product(s0, change, load_widest(values, begin))
            s1 = plus_product(s1, change, load_widest(values, begin + WIDEST))
            s2 = plus_product(s2, change, load_widest(values, begin + 2 * WIDEST))
            s3 = plus_product(s3, change, load_widest(values, begin + 3 * WIDEST))
        store(sums, i, s0)
        store(sums, i + WIDEST, s1)
        store(sums, i + 2 * WIDEST, s2)
        store(sums, i + 3 * WIDEST, s3)


@njit(nogil=True)
def rows_below(rows: IntArray, low: int, high: int, bound: int) -> int:
    """The first place from `low` to `high` in ascending `rows` that is not below the bound."""
    while low < high:
        middle = (low + high) // 2
        if rows[middle] < bound:
            low = middle + 1
        else:
            high = middle
    return low


@njit(nogil=True, inline="always")
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
    low, high = rows_below(slips, 0, count, first + 1), rows_below(slips, 0, count, last)
    late = rows_below(slips, low, high, last - inputs + 1)  # to there: between for all lags
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
    for j in range(inputs):
        table[outputs + inputs + 1, j] += past[0, j]
    for i in range(outputs):
        for j in range(inputs):
            table[i + 1, j] += past[i + 1, j]
    for i in range(inputs):
        for j in range(inputs):
            table[outputs + 1 + i, j] += gram[i, j]


@njit(nogil=True)
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
    x, sums = np.empty((EIGHT, longest)), np.empty(longest + 1 + LAGS)
    slips, changes = np.empty(longest, np.int64), np.empty(longest)
    found, tables = np.empty(models.size), np.empty((EIGHT, outputs + inputs + 2, inputs))
    bands, jumps, starts = np.empty(EIGHT), np.empty(EIGHT), np.empty(EIGHT)
    turned, places = np.empty(EIGHT), np.empty(models.size, np.int64)
    for model in (KANO, HE, HE_RAMP):
        many = 0
        for v in range(models.size):
            if models[v] == model:
                places[many] = v
                many += 1
        for done in range(0, many, EIGHT):
            eight = places[done : min(done + EIGHT, many)]
            for lane in range(EIGHT):
                bands[lane], jumps[lane] = etas[eight[min(lane, eight.size - 1)]]
            turned[:] = 0.0
            tables[:] = 0.0
            for index, head, first, stop in pieces:
                part = u[head:stop]
                for lane in range(EIGHT):
                    v = eight[min(lane, eight.size - 1)]
                    rest = rests[v, index] if index < rests.shape[1] else 0.0
                    starts[lane] = part[0] + 0.5 * rest * (bands[lane] + jumps[lane])
                more = follow_all(model, part, bands, jumps, starts, x)
                for lane in range(EIGHT):
                    turned[lane] += more[lane]
                for lane in range(eight.size):
                    count = find_slips(x[lane, : part.size], sums, slips, changes)
                    add_slip_table(
                        x[lane], sums, slips, changes, count, totals[head:], outputs, delay, inputs, first - head,
                        stop - head, tables[lane],
                    )  # fmt: skip
            for lane in range(eight.size):
                enough = turned[lane] >= turns
                found[eight[lane]] = explained(tables[lane], basis, known, floor, ridge) if enough else -np.inf
    return found
