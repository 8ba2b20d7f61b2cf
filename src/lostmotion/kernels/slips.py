"""Patterns of slips of a sticking valve: which bands and jumps share one, and what a process makes of it.

After a slip at the command v in direction d the position is v - d (S - J) / 2; the valve goes on in that direction
from v + d J, and back from v - d S, as in :mod:`lostmotion.kernels.slip_table`.
"""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.lanes import widest
from lostmotion.kernels.numba_cache import njit
from lostmotion.kernels.pole_filters import all_pole
from lostmotion.kernels.stiction import KANO

TINY = 1e-300  # keeps divisions finite


@njit(nogil=True)
def pattern(
    model: int,
    u: FloatArray,
    band: float,
    jump: float,
    start: float,
    slips: IntArray,
    levels: FloatArray,
    sides: FloatArray,
    bounds: FloatArray,
) -> tuple[int, int, float, int]:
    """The position x = level - side (S - J) / 2 from slip to slip, and the bands and jumps with the same slips.

    `slips`, `levels` and `sides` (n + 1,) get the rows of the slips, the first of all at row 0, the command there and
    the direction of the motion. `bounds` (lowest and highest band, lowest and highest jump) is narrowed: a valve stays
    where it is up to its band or jump, and slips beyond. Before its first slip, in direction d at the command v, it
    rests at (S + J) / 2 behind v, nearly: in the middle of the places from which it slips there and not before.
    Returns the number of slips with that at row 0, the row of the first slip (n where there is none), that first
    position and the number of turns.
    """
    reach = 0.5 * (band + jump)
    direction = moving = 0.0
    anchor = last = lowest = highest = u[0]
    first, turns, count = u.size, 0, 1
    slips[0], levels[0], sides[0] = 0, start, 0.0
    for k in range(u.size):
        v = u[k]
        slipped = False
        if moving != 0.0:
            slipped = moving * (v - last) > 0.0
            if not slipped:
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
                    levels[0], sides[0] = edge - direction * band, -direction
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
                anchor = v
                if model == KANO:
                    moving = direction
        if slipped:
            slips[count], levels[count], sides[count] = k, v, direction
            count += 1
        last = v
    return count, first, start, turns


@njit(nogil=True)
def first_positions(u: FloatArray, band: float, jump: float) -> FloatArray:
    """From where a valve can slip for the first time at one row or another, in all ways that `u` (n,) allows.

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
    return found[:count]


@njit(nogil=True)
def _through_numerator(slips: IntArray, values: FloatArray, begin: int, steps: FloatArray, drive: FloatArray) -> None:
    """Write B x into `drive` (n,) from the row `begin` on; x has the `values` (m,) from the `slips` (m,) on.

    `steps` are the running sums of B.
    """
    n, late = drive.size, steps.size
    drive[:] = 0.0
    before, until, settled = 0.0, 0, 0.0  # settled: the level that has passed all of B, and the row where it ends
    for m in range(slips.size):
        change, at = values[m] - before, slips[m] - begin
        if at >= n:
            break
        if change != 0.0:
            at = max(at, 0)
            for i in range(min(late, n - at)):
                drive[at + i] += change * steps[i]
            for k in range(until, min(at + late, n)):
                drive[k] += settled
            until = min(at + late, n)
            settled += change * steps[-1]
            before = values[m]
    for k in range(until, n):
        drive[k] += settled


@njit(nogil=True)
def through_process(
    slips: IntArray, levels: FloatArray, sides: FloatArray, begin: int, steps: FloatArray, a: FloatArray,
    of_levels: FloatArray, of_sides: FloatArray, drive: FloatArray,
) -> None:  # fmt: skip
    """Write B/A x into `of_levels` and `of_sides` (n,), from rest at the row `begin`, for x of `levels` and of `sides`.

    Both (m,) hold from the `slips` (m,) on. `drive` (2, n or more) is overwritten.
    """
    n = of_levels.size
    for_levels, for_sides = drive[0][:n], drive[1][:n]
    _through_numerator(slips, levels, begin, steps, for_levels)
    _through_numerator(slips, sides, begin, steps, for_sides)
    all_pole(a, for_levels, of_levels)
    all_pole(a, for_sides, of_sides)


@njit(nogil=True)
def add_answers(slips: IntArray, values: FloatArray, begin: int, answers: FloatArray, sums: FloatArray) -> None:
    """Add to `sums` (r,) what `answers` (n, r), of a step of one at each row from `begin` on, make of all changes."""
    before = 0.0
    for m in range(slips.size):
        change, at = values[m] - before, max(slips[m] - begin, 0)
        if at >= answers.shape[0]:
            break
        if change != 0.0:
            row = answers[at]
            for i in range(row.size):
                sums[i] += change * row[i]
            before = values[m]


@njit(nogil=True, fastmath={"reassoc", "contract"})
def _add_products(
    without: FloatArray,
    by_level: FloatArray,
    by_side: FloatArray,
    left: FloatArray,
    turned: FloatArray,
    sums: FloatArray,
) -> None:
    """Write `left` and `turned` (n,) and add their products with themselves and each other to `sums` (3,)."""
    widest()
    own = both = other = 0.0
    for k in range(without.size):
        x, y = without[k] - by_level[k], by_side[k]
        left[k], turned[k] = x, y
        own += x * x
        both += x * y
        other += y * y
    sums[0] += own
    sums[1] += both
    sums[2] += other


@njit(nogil=True)
def weigh_patterns(
    model: int,
    u: FloatArray,
    segments: IntArray,
    etas: FloatArray,
    begin: int,
    head: int,
    skipped: int,
    steps: FloatArray,
    a: FloatArray,
    without: FloatArray,
    answers: FloatArray,
    begun: FloatArray,
    bounds: FloatArray,
    sums: FloatArray,
    seen: FloatArray,
    turns: IntArray,
    left: FloatArray,
    turned: FloatArray,
) -> None:
    """What the likelihoods of patterns are made of, over all `segments` (s, 2) of u; `etas` (v, 2): bands and jumps.

    All but `head` rows of each segment count; the process B/A answers to its position from the row `begin` on, and the
    first rows of the answer are `skipped`; `steps` are the running sums of B. `left` and `turned` (e,) become `without`
    less that of the level, and that of the side, of the last pattern; `sums` (v, 3) the products of the two with
    themselves and each other; `seen` (v, 2, r) gets the products of r directions with that of level and side added, by
    `answers` (rows, r) to a step of one at each row. Of `begun` (v, s, 2) the first column, a first position in shares
    of (S + J) / 2, becomes that in the middle of its pattern, the second its first slip. `bounds` (v, 4) are narrowed
    as by ``pattern``; `turns` (v,) get the numbers of turns.
    """
    longest = 0
    for start, stop in segments:
        longest = max(longest, stop - start)
    slips, values = np.empty(longest + 1, np.int64), np.empty((2, longest + 1))
    drive, out = np.empty((2, longest)), np.empty((2, longest))
    for v in range(len(etas)):
        band, jump = etas[v]
        reach = 0.5 * (band + jump)
        turns[v] = done = answered = 0
        sums[v, 0] = sums[v, 1] = sums[v, 2] = 0.0
        for index in range(len(segments)):
            start, stop = segments[index]
            first = u[start] + begun[v, index, 0] * reach
            count, row, first, more = pattern(
                model, u[start:stop], band, jump, first, slips, values[0], values[1], bounds[v]
            )
            begun[v, index, 0], begun[v, index, 1] = (first - u[start]) / max(reach, TINY), row
            turns[v] += more
            rows = stop - start - head
            n = rows + skipped
            levels, sides, by_level, by_side = values[0][:count], values[1][:count], out[0][:n], out[1][:n]
            through_process(slips[:count], levels, sides, begin, steps, a, by_level, by_side, drive)
            part = answers[answered : answered + n]
            add_answers(slips[:count], levels, begin, part, seen[v, 0])
            add_answers(slips[:count], sides, begin, part, seen[v, 1])
            _add_products(
                without[done : done + rows], by_level[skipped:], by_side[skipped:], left[done : done + rows],
                turned[done : done + rows], sums[v],
            )  # fmt: skip
            done += rows
            answered += n
