"""Positions of eight sticking valves at once, one in every place of two quads.

What a valve does next hangs on what it did last: a processor that follows one waits for itself most of the time, and
guesses wrong where it slips often. All is as in :mod:`lostmotion.kernels.stiction`, break-aways and slips with the
same arithmetic, so that a valve slips in the same rows.
"""

from __future__ import annotations

import numpy as np
from numba import config

from lostmotion.arrays import FloatArray
from lostmotion.kernels.lanes import (
    WIDTH,
    Quad,
    address,
    alive,
    less,
    load,
    over,
    spread,
    store,
    times,
    where_above,
    whole,
)
from lostmotion.kernels.numba_cache import njit
from lostmotion.kernels.stiction import DIRECTION as WAY
from lostmotion.kernels.stiction import HE_RAMP, KANO, LAST, SHORTEST_SLIP, init, step
from lostmotion.kernels.stiction import MOVING as HAS_MOVED

EIGHT = 2 * WIDTH
X, ABOVE, BELOW, DIRECTION, MOVING, TURNS = range(0, 6 * EIGHT, EIGHT)  # of a state; each of eight valves
STATE_SIZE = 6 * EIGHT
ROWS = 256  # that are followed before their positions are sorted by valve: they stay near the processor


@njit(nogil=True)
def _follow_all(
    model: int, u: FloatArray, bands: FloatArray, jumps: FloatArray, starts: FloatArray, x: FloatArray
) -> FloatArray:
    """Write the positions of eight valves into `x` (8, n or more), from rest at `starts` (8,); how often each turns.

    `bands` and `jumps` (8,), command u (n,). What a valve does before its first slip is no turn.
    """
    state, some = at_rest(bands, jumps, starts), np.empty(ROWS * EIGHT)
    values = address(some)
    x0, x1, x2, x3 = address(x[0]), address(x[1]), address(x[2]), address(x[3])
    x4, x5, x6, x7 = address(x[4]), address(x[5]), address(x[6]), address(x[7])
    for begin in range(0, u.size, ROWS):
        end = min(begin + ROWS, u.size)
        follow(model, u, begin, end, bands, jumps, state, some)
        for k in range(begin, end):  # row by row: a compiler would gather what it finds valve by valve
            at = (k - begin) * EIGHT
            x0[k], x1[k], x2[k], x3[k] = values[at], values[at + 1], values[at + 2], values[at + 3]
            x4[k], x5[k], x6[k], x7[k] = values[at + 4], values[at + 5], values[at + 6], values[at + 7]
    alive(some)
    return state[TURNS:]


def _follow_all_plain(
    model: int, u: FloatArray, bands: FloatArray, jumps: FloatArray, starts: FloatArray, x: FloatArray
) -> FloatArray:
    turns = np.zeros(EIGHT)
    for lane in range(EIGHT):
        state, direction = init(starts[lane]), 0.0
        state[LAST] = u[0]
        for k, command in enumerate(u):
            x[lane, k] = step(model, command, bands[lane], jumps[lane], state)
            way = state[WAY] if state[HAS_MOVED] else direction
            turns[lane] += direction * way < 0.0
            direction = way
    return turns


follow_all = _follow_all_plain if config.DISABLE_JIT else _follow_all  # type: ignore[attr-defined]


@njit(nogil=True)
def at_rest(bands: FloatArray, jumps: FloatArray, starts: FloatArray) -> FloatArray:
    """State of valves at rest at `starts` (8,), in the middle of their bands."""
    state = np.zeros(STATE_SIZE)
    for i in range(EIGHT):
        reach = 0.5 * (bands[i] + jumps[i])
        state[X + i], state[ABOVE + i], state[BELOW + i] = starts[i], starts[i] + reach, starts[i] - reach
    return state


@njit(nogil=True)
def follow(
    model: int,
    u: FloatArray,
    begin: int,
    end: int,
    bands: FloatArray,
    jumps: FloatArray,
    state: FloatArray,
    x: FloatArray,
) -> None:
    """Write the positions while u (n,) goes from row `begin` to before `end` into `x` (8 for every row).

    `bands` and `jumps` (8,); the state is moved on. TURNS counts what a valve turns after its first slip.
    """
    if model == KANO:
        _follow_kano(u, begin, end, bands, jumps, state, x)
    elif model == HE_RAMP:
        _follow_on_ramp(u, begin, end, bands, jumps, state, x)
    else:
        _follow_he(u, begin, end, bands, jumps, state, x)


@njit(nogil=True, forceinline=True)
def _both(floats: FloatArray, at: int) -> tuple[Quad, Quad]:
    """Both quads of eight floats."""
    return load(floats, at), load(floats, at + WIDTH)


@njit(nogil=True, forceinline=True)
def _keep(floats: FloatArray, at: int, first: Quad, second: Quad) -> None:
    """Write both."""
    store(floats, at, first)
    store(floats, at + WIDTH, second)


@njit(nogil=True, forceinline=True)
def _turned(turns: Quad, direction: Quad, way: Quad) -> Quad:
    return less(turns, where_above(spread(0.0), times(direction, way), spread(-1.0), spread(0.0)))


@njit(nogil=True, forceinline=True)
def _he(
    v: Quad, band: Quad, jump: Quad, behind: Quad, x: Quad, above: Quad, below: Quad, direction: Quad, turns: Quad
) -> tuple[Quad, Quad, Quad, Quad, Quad]:
    zero = spread(0.0)
    way = where_above(v, above, spread(1.0), where_above(below, v, spread(-1.0), direction))
    turns = _turned(turns, direction, way)
    x = where_above(v, above, less(v, behind), where_above(below, v, less(v, less(zero, behind)), x))
    high = where_above(v, above, less(v, less(zero, jump)), where_above(below, v, less(v, less(zero, band)), above))
    low = where_above(v, above, less(v, band), where_above(below, v, less(v, jump), below))
    return x, high, low, way, turns


@njit(nogil=True)
def _follow_he(
    u: FloatArray, begin: int, end: int, bands: FloatArray, jumps: FloatArray, state: FloatArray, x: FloatArray
) -> None:
    now, values, half = address(state), address(x), spread(0.5)
    b0, b1 = _both(address(bands), 0)
    j0, j1 = _both(address(jumps), 0)
    o0, o1 = times(half, less(b0, j0)), times(half, less(b1, j1))
    x0, x1 = _both(now, X)
    a0, a1 = _both(now, ABOVE)
    l0, l1 = _both(now, BELOW)
    d0, d1 = _both(now, DIRECTION)
    t0, t1 = _both(now, TURNS)
    for k in range(begin, end):
        v, at = spread(u[k]), (k - begin) * EIGHT
        x0, a0, l0, d0, t0 = _he(v, b0, j0, o0, x0, a0, l0, d0, t0)
        x1, a1, l1, d1, t1 = _he(v, b1, j1, o1, x1, a1, l1, d1, t1)
        _keep(values, at, x0, x1)
    _keep(now, X, x0, x1)
    _keep(now, ABOVE, a0, a1)
    _keep(now, BELOW, l0, l1)
    _keep(now, DIRECTION, d0, d1)
    _keep(now, TURNS, t0, t1)


@njit(nogil=True, forceinline=True)
def _kano(
    v: Quad,
    stop: Quad,
    rise: Quad,
    band: Quad,
    jump: Quad,
    behind: Quad,
    x: Quad,
    above: Quad,
    below: Quad,
    direction: Quad,
    moving: Quad,
    turns: Quad,
) -> tuple[Quad, Quad, Quad, Quad, Quad, Quad]:
    """`stop` is the command of the row before: where a valve stops that moved."""
    one, zero, back = spread(1.0), spread(0.0), spread(-1.0)
    high, low = less(stop, less(zero, jump)), less(stop, less(zero, band))
    above = where_above(moving, zero, high, where_above(zero, moving, low, above))
    below = where_above(moving, zero, less(stop, band), where_above(zero, moving, less(stop, jump), below))
    started = where_above(v, above, one, where_above(below, v, back, zero))
    moving = where_above(times(moving, rise), zero, moving, started)
    turns = _turned(turns, direction, moving)
    x = where_above(moving, zero, less(v, behind), where_above(zero, moving, less(v, less(zero, behind)), x))
    direction = where_above(moving, zero, one, where_above(zero, moving, back, direction))
    return x, above, below, direction, moving, turns


@njit(nogil=True)
def _follow_kano(
    u: FloatArray, begin: int, end: int, bands: FloatArray, jumps: FloatArray, state: FloatArray, x: FloatArray
) -> None:
    now, values, half = address(state), address(x), spread(0.5)
    b0, b1 = _both(address(bands), 0)
    j0, j1 = _both(address(jumps), 0)
    o0, o1 = times(half, less(b0, j0)), times(half, less(b1, j1))
    x0, x1 = _both(now, X)
    a0, a1 = _both(now, ABOVE)
    l0, l1 = _both(now, BELOW)
    d0, d1 = _both(now, DIRECTION)
    m0, m1 = _both(now, MOVING)
    t0, t1 = _both(now, TURNS)
    for k in range(begin, end):
        last, at = u[max(k - 1, 0)], (k - begin) * EIGHT
        v, stop, rise = spread(u[k]), spread(last), spread(u[k] - last)
        x0, a0, l0, d0, m0, t0 = _kano(v, stop, rise, b0, j0, o0, x0, a0, l0, d0, m0, t0)
        x1, a1, l1, d1, m1, t1 = _kano(v, stop, rise, b1, j1, o1, x1, a1, l1, d1, m1, t1)
        _keep(values, at, x0, x1)
    _keep(now, X, x0, x1)
    _keep(now, ABOVE, a0, a1)
    _keep(now, BELOW, l0, l1)
    _keep(now, DIRECTION, d0, d1)
    _keep(now, MOVING, m0, m1)
    _keep(now, TURNS, t0, t1)


@njit(nogil=True, forceinline=True)
def _on_ramp(
    v: Quad, last: Quad, steep: Quad, reach: Quad, length: Quad, x: Quad, direction: Quad, turns: Quad
) -> tuple[Quad, Quad, Quad, Quad]:
    """Mean position of a sample, position at its end, direction and turns; `steep` is one over the rise of OP."""
    one, zero, back = spread(1.0), spread(0.0), spread(-1.0)
    up, down = less(v, x), less(x, v)
    way, size = where_above(up, zero, one, back), where_above(up, zero, up, down)
    further = whole(over(where_above(up, zero, less(up, reach), less(down, reach)), length))
    first = times(less(less(x, times(less(zero, way), reach)), last), steep)
    first = where_above(zero, first, zero, where_above(first, one, one, first))
    count = less(further, back)
    per_rise = where_above(steep, zero, steep, less(zero, steep))
    later = times(times(times(spread(0.5), count), further), times(length, per_rise))
    slips = times(less(zero, way), length)
    mean = where_above(size, reach, less(x, times(slips, less(times(count, less(one, first)), later))), x)
    now = where_above(size, reach, way, direction)
    return mean, where_above(size, reach, less(x, times(slips, count)), x), now, _turned(turns, direction, now)


@njit(nogil=True)
def _follow_on_ramp(
    u: FloatArray, begin: int, end: int, bands: FloatArray, jumps: FloatArray, state: FloatArray, x: FloatArray
) -> None:
    now, values, zero, half, least = address(state), address(x), spread(0.0), spread(0.5), spread(SHORTEST_SLIP)
    b0, b1 = _both(address(bands), 0)
    j0, j1 = _both(address(jumps), 0)
    r0, r1 = times(half, less(b0, less(zero, j0))), times(half, less(b1, less(zero, j1)))
    s0, s1 = times(least, r0), times(least, r1)
    j0, j1 = where_above(j0, s0, j0, s0), where_above(j1, s1, j1, s1)
    x0, x1 = _both(now, X)
    d0, d1 = _both(now, DIRECTION)
    t0, t1 = _both(now, TURNS)
    for k in range(begin, end):
        last, at = u[max(k - 1, 0)], (k - begin) * EIGHT
        rise = u[k] - last
        v, before, steep = spread(u[k]), spread(last), spread(1.0 / rise if rise != 0.0 else 0.0)
        m0, x0, d0, t0 = _on_ramp(v, before, steep, r0, j0, x0, d0, t0)
        m1, x1, d1, t1 = _on_ramp(v, before, steep, r1, j1, x1, d1, t1)
        _keep(values, at, m0, m1)
    _keep(now, X, x0, x1)
    _keep(now, DIRECTION, d0, d1)
    _keep(now, TURNS, t0, t1)
