"""Stiction of a valve: three data-driven models, and one of them between samples, on the band S and the slip jump J.

All rest at x until the command u has gone far enough, then jump, and while they move

    x = u - d (S - J) / 2,    d = direction of motion,

so that J < S leaves an offset (undershoot), J = S none (pure stick-slip) and J > S overshoots. From rest at
x = u all three break away when abs(u - x) > (S + J) / 2. They differ in what they call a stop and in what
they measure from:

Choudhury, Thornhill and Shah, "Modelling valve stiction", Control Engineering Practice 13 (2005) 641-658.
    Sticks at every change of sign of du and then needs S from the turning point; sticks where du = 0 while it
    moves and then needs J in the old direction. Every further turn, also inside the band, starts the count of
    S again, so small reversals can hold the valve for ever: abs(u - x) has no bound under noise. It is (S + J) / 2
    where every run of u in one direction is longer than S. Readings of the text: a hold while the valve is stuck
    changes nothing; a turn after a hold is a turn; a turn by more than S in one sample moves at once.

Kano, Maruta, Kugemoto and Shimizu, "Practical model and detection algorithm for valve stiction", DYCOPS 2004.
    Sticks where du = 0 or du changes sign *while it moves*, remembers that u, and then needs J in the old
    direction or S against it, whatever u does in between. In other words it breaks away when abs(u - x) passes
    (S + J) / 2, which is therefore a bound for every u. The model for noisy commands.

He, Wang, Pottmann and Qin, "A curve fitting method for detecting valve stiction in oscillating control loops",
Industrial and Engineering Chemistry Research 46 (2007) 4549-4560.
    Static friction fs = (S + J) / 2, dynamic friction fd = (S - J) / 2. Comes to rest after every sample: each time
    abs(u - x) > fs it jumps to x = u - d fd, then needs fs again. Along a ramp it makes steps of J where the
    others glide; abs(u - x) <= fs always. It needs no memory but x, and holding u changes nothing.

He's valve in time that goes on ("he ramp"): an actuator never sees the steps of a sampled command, but follows in a
    fraction of a sample. The command goes in a straight line from sample to sample, the valve breaks away on the way,
    where abs(u - x) is fs, and so every slip is J long, wherever in its sample u is. x of a sample is its mean over
    the sample. Of a sampled model that jumps to u - d fd the length of a slip depends on how far u went beyond.

With J = 0 Kano and He are the play of width S, Choudhury where every run of u is longer than S. With S = J = 0
all are x = u. Holding a sample (du = 0) stops a moving valve in Choudhury and Kano, so with J > 0 these two
depend on the sampling; He's does not on held samples, but does on how finely a ramp is sampled.
Limits of travel are not part of the operators here: put a saturation behind.
"""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.kernels.numba_cache import njit

CHOUDHURY, KANO, HE, HE_RAMP = 0, 1, 2, 3
SHORTEST_SLIP = 1e-9  # of fs: without a jump the valve slips ever so often

# State of all models: position, last command, command at the last stop, direction of motion (0: none yet),
# moving in this sample, stopped without a turn.
X, LAST, STOP, DIRECTION, MOVING, SAME = range(6)
STATE_SIZE = 6


@njit()
def init(start: float) -> FloatArray:
    """State of a valve at rest at `start`, in the middle of its band; NaN: at the first finite command."""
    state = np.zeros(STATE_SIZE)
    state[X] = start
    state[LAST] = start
    return state


@njit()
def step_choudhury(u: float, band: float, jump: float, state: FloatArray) -> None:
    """Move `state` on by the finite command u (Choudhury 2005)."""
    slope = np.sign(u - state[LAST])
    if slope == 0.0:
        if state[MOVING] == 1.0:
            state[MOVING] = 0.0
            state[SAME] = 1.0
            state[STOP] = state[LAST]
    else:
        if state[DIRECTION] == 0.0:  # in the middle of the band: the break-away is (S + J) / 2 off
            state[STOP] = state[X] - slope * 0.5 * (band - jump)
        elif slope != state[DIRECTION]:
            state[MOVING] = 0.0
            state[SAME] = 0.0
            state[STOP] = state[LAST]
        state[DIRECTION] = slope
        needed = jump if state[SAME] == 1.0 else band
        if state[MOVING] == 1.0 or slope * (u - state[STOP]) > needed:
            state[MOVING] = 1.0
            state[X] = u - slope * 0.5 * (band - jump)
    state[LAST] = u


@njit()
def step_kano(u: float, band: float, jump: float, state: FloatArray) -> None:
    """Move `state` on by the finite command u (Kano 2004)."""
    if state[DIRECTION] == 0.0:  # either direction gives the same two thresholds, (S + J) / 2 off
        state[DIRECTION] = 1.0
        state[STOP] = state[X] + 0.5 * (band - jump)
    direction = state[DIRECTION]
    if state[MOVING] == 1.0 and direction * (u - state[LAST]) <= 0.0:
        state[MOVING] = 0.0
        state[STOP] = state[LAST]
    if state[MOVING] == 0.0:
        ahead = direction * (u - state[STOP])
        if -ahead > band:
            direction = -direction
            state[MOVING] = 1.0
        elif ahead > jump:
            state[MOVING] = 1.0
    if state[MOVING] == 1.0:
        state[DIRECTION] = direction
        state[X] = u - direction * 0.5 * (band - jump)
    state[LAST] = u


@njit()
def step_he(u: float, band: float, jump: float, state: FloatArray) -> None:
    """Move `state` on by the finite command u (He 2007)."""
    force = u - state[X]
    state[MOVING] = 0.0
    if abs(force) > 0.5 * (band + jump):
        state[MOVING] = 1.0
        state[DIRECTION] = np.sign(force)
        state[X] = u - state[DIRECTION] * 0.5 * (band - jump)
    state[LAST] = u


@njit()
def slips_on_ramp(last: float, u: float, x: float, reach: float, jump: float) -> tuple[int, float, float]:
    """How often a valve slips while the command goes from `last` to u, which way (-1, 1), and when first (0 to 1)."""
    force = u - x
    if abs(force) <= reach:
        return 0, 0.0, 0.0
    direction = 1.0 if force > 0.0 else -1.0
    count = int((abs(force) - reach) / jump) + 1
    at = (x + direction * reach - last) / (u - last) if u != last else 0.0
    return count, direction, min(max(at, 0.0), 1.0)


@njit()
def mean_on_ramp(x: float, direction: float, count: int, at: float, jump: float, rise: float) -> float:
    """Mean position of a sample of `count` slips from x on, the first `at`, while the command goes by `rise`."""
    later = 0.5 * count * (count - 1) * jump / abs(rise) if count > 1 and rise != 0.0 else 0.0
    return x + direction * jump * (count * (1.0 - at) - later)


@njit()
def step_he_ramp(u: float, band: float, jump: float, state: FloatArray) -> float:
    """Move `state` on by the finite command u, to which it goes in a straight line; the mean position on the way.

    Of n slips, each J behind the one before it, the first at t: x + d J (n (1 - t) - n (n - 1) / 2 J / abs(du)).
    """
    reach = 0.5 * (band + jump)
    jump = max(jump, SHORTEST_SLIP * reach)
    last, before = state[LAST], state[X]
    state[MOVING], state[LAST] = 0.0, u
    if reach <= 0.0:  # a valve that follows
        state[X] = u
        return u
    if not abs(u - before) > reach:
        return float(before)
    count, direction, at = slips_on_ramp(last, u, before, reach, jump)
    state[MOVING], state[DIRECTION] = 1.0, direction
    state[X] = before + direction * count * jump
    return float(mean_on_ramp(before, direction, count, at, jump, u - last))


@njit()
def step(model: int, u: float, band: float, jump: float, state: FloatArray) -> float:
    """Position after the command u; NaN in u leaves the state and gives NaN."""
    if np.isnan(u):
        return u
    if np.isnan(state[X]):
        state[X] = u
        state[LAST] = u
    if model == HE_RAMP:
        return step_he_ramp(u, band, jump, state)
    if model == CHOUDHURY:
        step_choudhury(u, band, jump, state)
    elif model == KANO:
        step_kano(u, band, jump, state)
    else:
        step_he(u, band, jump, state)
    return float(state[X])


@njit()
def _follow_kano(u: FloatArray, band: float, jump: float, start: float, x: FloatArray, ways: FloatArray) -> None:
    """``step_kano`` over an array, its state in registers; `ways` is the direction where the valve moves, else 0."""
    direction, behind = 1.0, 0.5 * (band - jump)
    moving, position, last, stop = False, start, start, start + behind
    for k in range(u.size):
        v = u[k]
        x[k], ways[k] = v, 0.0
        if np.isnan(v):
            continue
        if np.isnan(position):
            position, last, stop = v, v, v + behind
        if moving and direction * (v - last) <= 0.0:
            moving, stop = False, last
        if not moving:
            ahead = direction * (v - stop)
            if -ahead > band:
                direction, moving = -direction, True
            else:
                moving = ahead > jump
        if moving:
            position, ways[k] = v - direction * behind, direction
        x[k], last = position, v


@njit()
def _follow_he(u: FloatArray, band: float, jump: float, start: float, x: FloatArray, ways: FloatArray) -> None:
    """The same of ``step_he``."""
    position, reach, behind = start, 0.5 * (band + jump), 0.5 * (band - jump)
    for k in range(u.size):
        v, ways[k] = u[k], 0.0
        position = v if np.isnan(position) else position
        force = v - position
        if abs(force) > reach:
            ways[k] = 1.0 if force > 0.0 else -1.0
            position = v - ways[k] * behind
        x[k] = v if np.isnan(v) else position


@njit()
def _follow_on_ramp(u: FloatArray, band: float, jump: float, start: float, x: FloatArray, ways: FloatArray) -> None:
    """The same of ``step_he_ramp``, of a valve that does not follow at once."""
    position, last, reach = start, start, 0.5 * (band + jump)
    long = max(jump, SHORTEST_SLIP * reach)
    for k in range(u.size):
        v, ways[k] = u[k], 0.0
        if np.isnan(position):
            position = last = v
        x[k] = v if np.isnan(v) else position
        if abs(v - position) > reach:
            count, ways[k], at = slips_on_ramp(last, v, position, reach, long)
            x[k] = mean_on_ramp(position, ways[k], count, at, long, v - last)
            position += ways[k] * count * long
        last = last if np.isnan(v) else v


@njit()
def _follow(model: int, u: FloatArray, band: float, jump: float, start: float, x: FloatArray, ways: FloatArray) -> None:
    """Fill `x` (n,) with the position and `ways` (n,) with the direction where the valve moves, else 0."""
    if model == KANO:
        _follow_kano(u, band, jump, start, x, ways)
    elif model == HE:
        _follow_he(u, band, jump, start, x, ways)
    elif model == HE_RAMP and band + jump > 0.0:
        _follow_on_ramp(u, band, jump, start, x, ways)
    else:
        state = init(start)
        for k in range(u.size):
            x[k] = step(model, u[k], band, jump, state)
            ways[k] = state[DIRECTION] if state[MOVING] == 1.0 else 0.0


@njit()
def run(model: int, u: FloatArray, band: float, jump: float, start: float) -> FloatArray:
    """Position over an array, from rest at `start` (NaN: at the first finite u)."""
    x = np.empty(u.size)
    _follow(model, u, band, jump, start, x, np.empty(u.size))
    return x


@njit()
def sensitivities(
    model: int, u: FloatArray, band: float, jump: float, start: float, x: FloatArray, dx: FloatArray
) -> None:
    """Position and its derivatives with respect to band and jump; `x` (n,) and `dx` (2, n) are filled.

    Along the path with the times of break-away held fixed: -d/2 and d/2 where the valve moves, and what they
    were when it stopped where it rests. x itself jumps where a break-away changes its sample, except for J = 0 and on a
    ramp.
    """
    if model == HE_RAMP:
        sensitivities_on_ramp(u, band, jump, start, 0.0, x, dx)
        return
    by_band, ways = 0.0, dx[1]
    _follow(model, u, band, jump, start, x, ways)
    for k in range(u.size):
        if ways[k] != 0.0:
            by_band = -0.5 * ways[k]
        dx[0, k], dx[1, k] = by_band, -by_band


@njit()
def sensitivities_on_ramp(
    u: FloatArray, band: float, jump: float, start: float, by_size: float, x: FloatArray, dx: FloatArray
) -> None:
    """The same of a valve that breaks away between the samples: how often it slips in each is held, not when.

    `by_size` is the derivative of `start` with respect to either; a valve that slips by J never forgets it.
    """
    reach = 0.5 * (band + jump)
    position, last, long = start, start, max(jump, SHORTEST_SLIP * reach)
    by_jump = by_size  # of the position where it rests
    for k in range(u.size):
        v = u[k]
        if np.isnan(position) or reach <= 0.0:  # it begins, or follows
            position = last = v
        x[k] = v if np.isnan(v) else position
        dx[0, k], dx[1, k] = by_size, by_jump
        if abs(v - position) > reach:
            count, direction, at = slips_on_ramp(last, v, position, reach, long)
            rise, inside = v - last, 0.0 < at < 1.0
            x[k] = mean_on_ramp(position, direction, count, at, long, rise)
            later = 0.5 * count * (count - 1) / abs(rise) if rise != 0.0 else 0.0
            dx[1, k] += direction * (count * (1.0 - at) - 2.0 * later * long)
            if inside:
                dx[0, k] -= direction * long * count * (by_size + 0.5 * direction) / rise
                dx[1, k] -= direction * long * count * (by_jump + 0.5 * direction) / rise
            position += direction * count * long
            by_jump += direction * count
        last = last if np.isnan(v) else v


@njit()
def run_choudhury(u: FloatArray, band: float, jump: float, start: float) -> FloatArray:
    """:func:`run` of Choudhury's model."""
    return run(CHOUDHURY, u, band, jump, start)


@njit()
def run_kano(u: FloatArray, band: float, jump: float, start: float) -> FloatArray:
    """:func:`run` of Kano's model."""
    return run(KANO, u, band, jump, start)


@njit()
def run_he(u: FloatArray, band: float, jump: float, start: float) -> FloatArray:
    """:func:`run` of He's model."""
    return run(HE, u, band, jump, start)


@njit()
def sensitivities_choudhury(
    u: FloatArray, band: float, jump: float, start: float, x: FloatArray, dx: FloatArray
) -> None:
    """:func:`sensitivities` of Choudhury's model."""
    sensitivities(CHOUDHURY, u, band, jump, start, x, dx)


@njit()
def sensitivities_kano(u: FloatArray, band: float, jump: float, start: float, x: FloatArray, dx: FloatArray) -> None:
    """:func:`sensitivities` of Kano's model."""
    sensitivities(KANO, u, band, jump, start, x, dx)


@njit()
def sensitivities_he(u: FloatArray, band: float, jump: float, start: float, x: FloatArray, dx: FloatArray) -> None:
    """:func:`sensitivities` of He's model."""
    sensitivities(HE, u, band, jump, start, x, dx)
