"""Patterns of slips of a sticking valve: which bands and jumps share one, and what a process makes of it.

After a slip at the command v in direction d the position is v - d (S - J) / 2; the valve goes on in that direction
from v + d J, and back from v - d S, as in :mod:`lostmotion.kernels.slip_table`.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from lostmotion.arrays import FloatArray
from lostmotion.kernels.likelihood import all_pole
from lostmotion.kernels.stiction import KANO


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
