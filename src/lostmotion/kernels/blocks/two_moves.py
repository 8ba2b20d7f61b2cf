"""Scan kernel: two moves that bring a sticking valve to rest where the loop is in balance, then hold it.

Source: R. Srinivasan and R. Rengaswamy, "Approaches for efficient stiction compensation in process control valves",
Computers and Chemical Engineering 32 (2008) 218-229, section on the two-move method. As recalled, not read again: in
deviations from the steady state, ``f(t) = |u(t)| + alpha d`` with alpha > 1 pushes the valve out of its stick band d,
and ``f(t+1) = -u(t+1)`` in the next sample takes the command to the steady state, where the valve sticks and stays.

As published: a first move that surely breaks the valve loose, a second to the steady state, then rest.
Different: the steady state is not given but read from the swing of OP_IN, at SHARE of the way from its last trough to
its last peak (one half where friction is the same both ways), as later variants measure it too; the first move goes
OVERSHOOT beyond the steady state in the direction in which OP_IN has just turned; each move lasts MOVE_SCANS scans; the
second stops STAND short of the steady state on the far side, because a valve with S > J comes to rest (S - J) / 2
behind its command; the hold ends, and the block looks for a swing again, when OP_IN has moved by more than RELEASE
(set point, load), since the published method knows no way back. FACTOR scales OVERSHOOT and STAND.

While it holds, the loop is open: the offset takes up every move of OP_IN.
"""

from __future__ import annotations

from lostmotion.arrays import Reals
from lostmotion.kernels.blocks.core import (
    ACTIVE,
    BASE,
    CHANGED,
    FAULT,
    FROZEN,
    LEAST_SETTING,
    MOST_SETTING,
    PARAMETERS,
    QUIETED,
    SIDE,
    STATES,
    TOTAL,
    TURN_POINT,
    TURNED,
    USED_FACTOR,
    WANTED,
    check,
    drive,
    prepare,
    report,
    return_path,
    take,
)
from lostmotion.kernels.numba_cache import njit

OVERSHOOT, STAND, MOVE_SCANS, SHARE, RELEASE = range(PARAMETERS, PARAMETERS + 5)
USED_OVERSHOOT, USED_STAND, USED_MOVE_SCANS, USED_SHARE, USED_RELEASE = range(STATES, STATES + 5)
PHASE, CLOCK, PEAK, TROUGH, SEEN, AIM, WAY, HOLD_IN, PART = range(STATES + 5, STATES + 14)
SIZE = STATES + 14


@njit()
def check_two_moves(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """FAULT 3 where overshoot, release >= 0, scans >= 1, 0 <= share <= 1 does not hold, or a size is out of bounds."""
    s[TOTAL] = abs(p[OVERSHOOT]) + abs(p[STAND]) + abs(p[MOVE_SCANS]) + abs(p[SHARE]) + abs(p[RELEASE])
    if s[FAULT] == 0.0:
        if s[TOTAL] - s[TOTAL] != 0.0 or p[OVERSHOOT] < 0.0 or p[RELEASE] < 0.0:
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif p[MOVE_SCANS] < 1.0 or p[SHARE] < 0.0 or p[SHARE] > 1.0:
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif p[OVERSHOOT] > MOST_SETTING or p[STAND] > MOST_SETTING or p[STAND] < -MOST_SETTING:
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif p[RELEASE] > MOST_SETTING or p[MOVE_SCANS] > MOST_SETTING:
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif p[OVERSHOOT] > 0.0 and p[OVERSHOOT] < LEAST_SETTING:
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif p[STAND] != 0.0 and p[STAND] < LEAST_SETTING and p[STAND] > -LEAST_SETTING:
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif (p[SHARE] > 0.0 and p[SHARE] < LEAST_SETTING) or (p[RELEASE] > 0.0 and p[RELEASE] < LEAST_SETTING):
            s[FAULT] = 1.0 + 1.0 + 1.0


@njit()
def take_two_moves(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """Take the settings, known to be usable."""
    s[TOTAL] = abs(p[OVERSHOOT] - s[USED_OVERSHOOT]) + abs(p[STAND] - s[USED_STAND])
    if s[TOTAL] != 0.0:
        s[CHANGED] = 1.0
    s[USED_OVERSHOOT] = p[OVERSHOOT]
    s[USED_STAND] = p[STAND]
    s[USED_MOVE_SCANS] = p[MOVE_SCANS]
    s[USED_SHARE] = p[SHARE]
    s[USED_RELEASE] = p[RELEASE]


@njit()
def watch(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """Wait for a peak and a trough; then aim between them and begin."""
    if s[TURNED] != 0.0:
        if s[SIDE] < 0.0:
            s[PEAK] = s[TURN_POINT]
        else:
            s[TROUGH] = s[TURN_POINT]
        s[SEEN] = s[SEEN] + 1.0
        if s[SEEN] > 1.0:
            s[PART] = s[PEAK] - s[TROUGH]
            s[PART] = s[PART] * s[USED_SHARE]
            s[AIM] = s[TROUGH] + s[PART]
            s[WAY] = s[SIDE]
            s[PHASE] = 1.0
            s[CLOCK] = 0.0


@njit()
def advance(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """PHASE: 0 watches, 1 moves beyond, 2 is at the aim and holds."""
    if s[PHASE] == 0.0:
        watch(p, s, i, o)
    elif s[PHASE] == 1.0:
        s[CLOCK] = s[CLOCK] + 1.0
        if s[CLOCK] >= s[USED_MOVE_SCANS]:
            s[PHASE] = 1.0 + 1.0
            s[HOLD_IN] = s[QUIETED]
    elif abs(s[QUIETED] - s[HOLD_IN]) > s[USED_RELEASE]:
        s[PHASE] = 0.0
        s[SEEN] = 0.0
        s[CHANGED] = 1.0


@njit()
def correct(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """WANTED = what takes the command to the aim of the phase."""
    if s[ACTIVE] == 0.0:
        s[PHASE] = 0.0
        s[SEEN] = 0.0
    elif s[FROZEN] == 0.0:
        advance(p, s, i, o)
    if s[PHASE] == 0.0:
        s[WANTED] = s[QUIETED] - s[BASE]
    elif s[PHASE] == 1.0:
        s[PART] = s[USED_OVERSHOOT] * s[USED_FACTOR]
        s[PART] = s[PART] * s[WAY]
        s[WANTED] = s[AIM] + s[PART]
        s[WANTED] = s[WANTED] - s[BASE]
    else:
        s[PART] = s[USED_STAND] * s[USED_FACTOR]
        s[PART] = s[PART] * s[WAY]
        s[WANTED] = s[AIM] - s[PART]
        s[WANTED] = s[WANTED] - s[BASE]


@njit()
def step(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """One scan; the back-calculation takes the offset as it is."""
    check(p, s, i, o)
    check_two_moves(p, s, i, o)
    if s[FAULT] == 0.0:
        take(p, s, i, o)
        take_two_moves(p, s, i, o)
    prepare(p, s, i, o)
    correct(p, s, i, o)
    drive(p, s, i, o)
    return_path(p, s, i, o)
    report(p, s, i, o)
