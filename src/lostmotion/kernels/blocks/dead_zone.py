"""Scan kernel: inverse of a dead zone about a centre, with three ways to cross it.

With v = OP_IN - centre the paper's inverse (Cequeira et al. 2010, eqs 8-11) is ``v / slope + break``, on the right for
v > 0 and on the left for v < 0. Its jump from one break point to the other at v = 0 makes the command chatter where
noise carries v through zero. SHAPE says how the side is chosen (PLACE, from -1 left to 1 right):

0  jump: by the sign of v, the paper's.
1  smooth: in proportion to v within +-ZONE, so the jump becomes a steep line.
2  hold: the side changes only when v has passed the centre by ZONE to the other side (a relay with hysteresis).

An inverse of more than the dead zone is a relay in the loop, which then hunts from side to side. The guard: where
HUNT_LIMIT changes of side in a row come within HUNT_SCANS of each other, the share of the dead zone that is compensated
is multiplied by BACK_OFF, again and again until it is calm; it is whole again after a disable, and with
new settings. HUNT_SCANS = 0: no guard.

FACTOR scales the way from the centre to the break points, not the slopes. QUIET (a play of +-QUIET in front of the
inverse, :mod:`lostmotion.kernels.blocks.core`) takes the small turns out of the command as well.
"""

from __future__ import annotations

from lostmotion.arrays import Reals
from lostmotion.kernels.blocks.core import (
    ACTIVE,
    ALIVE,
    BASE,
    CHANGED,
    COMMAND,
    ENABLE,
    FAULT,
    FROZEN,
    HAS_SETTINGS,
    INVERTING,
    LEAST_SETTING,
    MOST_SETTING,
    PARAMETERS,
    QUIETED,
    RETURNED,
    STARTED,
    STATES,
    TOTAL,
    TRACKING,
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

LEFT_BREAK, RIGHT_BREAK, CENTRE, LEFT_SLOPE, RIGHT_SLOPE, SHAPE, ZONE = range(PARAMETERS, PARAMETERS + 7)
HUNT_SCANS, HUNT_LIMIT, BACK_OFF = range(PARAMETERS + 7, PARAMETERS + 10)
USED_LEFT, USED_RIGHT, USED_CENTRE, USED_LEFT_SLOPE, USED_RIGHT_SLOPE, USED_SHAPE, USED_ZONE = range(STATES, STATES + 7)
USED_HUNT_SCANS, USED_HUNT_LIMIT, USED_BACK_OFF = range(STATES + 7, STATES + 10)
PLACE, SHIFT, GAINED, LEVEL, KNEE, PART_LEFT, HALF, SINCE, CLOSE = range(STATES + 10, STATES + 19)
SIZE = STATES + 19


@njit()
def check_dead_zone(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """FAULT 3 where left <= centre <= right, slopes > 0, zone >= 0 does not hold, or a size is out of bounds."""
    s[TOTAL] = abs(p[LEFT_BREAK]) + abs(p[RIGHT_BREAK]) + abs(p[CENTRE])
    s[TOTAL] = s[TOTAL] + abs(p[LEFT_SLOPE]) + abs(p[RIGHT_SLOPE]) + abs(p[SHAPE]) + abs(p[ZONE])
    s[TOTAL] = s[TOTAL] + abs(p[HUNT_SCANS]) + abs(p[HUNT_LIMIT]) + abs(p[BACK_OFF])
    if s[FAULT] == 0.0:
        if s[TOTAL] - s[TOTAL] != 0.0 or p[LEFT_BREAK] > p[CENTRE] or p[CENTRE] > p[RIGHT_BREAK]:
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif p[LEFT_SLOPE] <= 0.0 or p[RIGHT_SLOPE] <= 0.0 or p[ZONE] < 0.0:
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif p[HUNT_SCANS] < 0.0 or p[HUNT_LIMIT] < 1.0 or p[BACK_OFF] < 0.0 or p[BACK_OFF] > 1.0:
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif p[LEFT_BREAK] < -MOST_SETTING or p[RIGHT_BREAK] > MOST_SETTING or p[ZONE] > MOST_SETTING:
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif p[LEFT_SLOPE] > MOST_SETTING or p[RIGHT_SLOPE] > MOST_SETTING or p[HUNT_SCANS] > MOST_SETTING:
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif p[HUNT_LIMIT] > MOST_SETTING or p[LEFT_SLOPE] < LEAST_SETTING or p[RIGHT_SLOPE] < LEAST_SETTING:
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif p[CENTRE] != 0.0 and p[CENTRE] < LEAST_SETTING and p[CENTRE] > -LEAST_SETTING:
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif p[LEFT_BREAK] != 0.0 and p[LEFT_BREAK] < LEAST_SETTING and p[LEFT_BREAK] > -LEAST_SETTING:
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif p[RIGHT_BREAK] != 0.0 and p[RIGHT_BREAK] < LEAST_SETTING and p[RIGHT_BREAK] > -LEAST_SETTING:
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif (p[ZONE] > 0.0 and p[ZONE] < LEAST_SETTING) or (p[BACK_OFF] > 0.0 and p[BACK_OFF] < LEAST_SETTING):
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif p[SHAPE] > MOST_SETTING or p[SHAPE] < -MOST_SETTING:
            s[FAULT] = 1.0 + 1.0 + 1.0


@njit()
def take_dead_zone(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """Take the settings, known to be usable."""
    s[TOTAL] = abs(p[LEFT_BREAK] - s[USED_LEFT]) + abs(p[RIGHT_BREAK] - s[USED_RIGHT])
    s[TOTAL] = s[TOTAL] + abs(p[CENTRE] - s[USED_CENTRE]) + abs(p[ZONE] - s[USED_ZONE])
    s[TOTAL] = s[TOTAL] + abs(p[LEFT_SLOPE] - s[USED_LEFT_SLOPE]) + abs(p[RIGHT_SLOPE] - s[USED_RIGHT_SLOPE])
    s[TOTAL] = s[TOTAL] + abs(p[SHAPE] - s[USED_SHAPE])
    if s[TOTAL] != 0.0:
        s[CHANGED] = 1.0
    if s[CHANGED] != 0.0:
        s[PART_LEFT] = 1.0
        s[CLOSE] = 0.0
    s[USED_LEFT] = p[LEFT_BREAK]
    s[USED_RIGHT] = p[RIGHT_BREAK]
    s[USED_CENTRE] = p[CENTRE]
    s[USED_LEFT_SLOPE] = p[LEFT_SLOPE]
    s[USED_RIGHT_SLOPE] = p[RIGHT_SLOPE]
    s[USED_SHAPE] = p[SHAPE]
    s[USED_ZONE] = p[ZONE]
    s[USED_HUNT_SCANS] = p[HUNT_SCANS]
    s[USED_HUNT_LIMIT] = p[HUNT_LIMIT]
    s[USED_BACK_OFF] = p[BACK_OFF]


@njit()
def place(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """PLACE between the two sides for the distance SHIFT from the centre."""
    if s[USED_SHAPE] > 1.0:
        if s[SHIFT] > s[USED_ZONE]:
            s[PLACE] = 1.0
        elif s[SHIFT] < -s[USED_ZONE]:
            s[PLACE] = -1.0
    elif s[USED_SHAPE] == 1.0 and abs(s[SHIFT]) < s[USED_ZONE]:
        s[PLACE] = s[SHIFT] / s[USED_ZONE]
    elif s[SHIFT] > 0.0:
        s[PLACE] = 1.0
    elif s[SHIFT] < 0.0:
        s[PLACE] = -1.0
    else:
        s[PLACE] = 0.0


@njit()
def guard(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """Count changes of side that follow each other fast, and give way (PART_LEFT)."""
    if i[ENABLE] == 0.0 or s[STARTED] == 0.0:
        s[PART_LEFT] = 1.0
        s[CLOSE] = 0.0
        s[HALF] = 0.0
        s[SINCE] = s[USED_HUNT_SCANS]
    elif s[ACTIVE] != 0.0:
        if s[SINCE] < s[USED_HUNT_SCANS]:
            s[SINCE] = s[SINCE] + 1.0
        if s[PLACE] * s[HALF] < 0.0:
            if s[SINCE] < s[USED_HUNT_SCANS]:
                s[CLOSE] = s[CLOSE] + 1.0
            else:
                s[CLOSE] = 0.0
            s[SINCE] = 0.0
            if s[CLOSE] >= s[USED_HUNT_LIMIT]:
                s[CLOSE] = 0.0
                s[PART_LEFT] = s[PART_LEFT] * s[USED_BACK_OFF]
        if s[PLACE] > 0.0:
            s[HALF] = 1.0
        elif s[PLACE] < 0.0:
            s[HALF] = -1.0


@njit()
def correct(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """WANTED = what the inverse adds to OP_IN."""
    s[SHIFT] = s[QUIETED] - s[USED_CENTRE]
    if s[HAS_SETTINGS] != 0.0 and s[FROZEN] == 0.0 and s[ALIVE] != 0.0:
        place(p, s, i, o)
    guard(p, s, i, o)
    if s[HAS_SETTINGS] != 0.0:
        if s[PLACE] > 0.0:
            s[LEVEL] = s[USED_RIGHT] - s[USED_CENTRE]
            s[GAINED] = s[SHIFT] / s[USED_RIGHT_SLOPE]
        elif s[PLACE] < 0.0:
            s[LEVEL] = s[USED_CENTRE] - s[USED_LEFT]
            s[GAINED] = s[SHIFT] / s[USED_LEFT_SLOPE]
        else:
            s[LEVEL] = 0.0
            s[GAINED] = s[SHIFT]
        s[LEVEL] = s[LEVEL] * s[USED_FACTOR]
        s[LEVEL] = s[LEVEL] * s[PART_LEFT]
        s[LEVEL] = s[LEVEL] * s[PLACE]
        s[GAINED] = s[GAINED] - s[SHIFT]
        s[WANTED] = s[GAINED] + s[LEVEL]
        s[WANTED] = s[WANTED] + (s[QUIETED] - s[BASE])


@njit()
def invert_right(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """SHIFT > 0 that gives the command SHIFT from the centre."""
    s[LEVEL] = (s[USED_RIGHT] - s[USED_CENTRE]) * s[USED_FACTOR]
    s[LEVEL] = s[LEVEL] * s[PART_LEFT]
    s[KNEE] = s[LEVEL]
    if s[USED_SHAPE] == 1.0:
        s[KNEE] = s[LEVEL] + s[USED_ZONE] / s[USED_RIGHT_SLOPE]
    if s[SHIFT] > s[KNEE]:
        s[SHIFT] = (s[SHIFT] - s[LEVEL]) * s[USED_RIGHT_SLOPE]
    elif s[USED_SHAPE] == 1.0 and s[KNEE] > 0.0:
        s[SHIFT] = s[SHIFT] / s[KNEE] * s[USED_ZONE]
    else:
        s[SHIFT] = 0.0


@njit()
def invert_left(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """SHIFT < 0 that gives the command SHIFT from the centre."""
    s[LEVEL] = (s[USED_LEFT] - s[USED_CENTRE]) * s[USED_FACTOR]
    s[LEVEL] = s[LEVEL] * s[PART_LEFT]
    s[KNEE] = s[LEVEL]
    if s[USED_SHAPE] == 1.0:
        s[KNEE] = s[LEVEL] - s[USED_ZONE] / s[USED_LEFT_SLOPE]
    if s[SHIFT] < s[KNEE]:
        s[SHIFT] = (s[SHIFT] - s[LEVEL]) * s[USED_LEFT_SLOPE]
    elif s[USED_SHAPE] == 1.0 and s[KNEE] < 0.0:
        s[SHIFT] = -(s[SHIFT] / s[KNEE] * s[USED_ZONE])
    else:
        s[SHIFT] = 0.0


@njit()
def invert(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """RETURNED where it was asked for; while tracking the side follows the command."""
    if s[INVERTING] != 0.0:
        s[SHIFT] = s[COMMAND] - s[USED_CENTRE]
        if s[SHIFT] > 0.0:
            invert_right(p, s, i, o)
        elif s[SHIFT] < 0.0:
            invert_left(p, s, i, o)
        s[RETURNED] = s[USED_CENTRE] + s[SHIFT]
        if s[TRACKING] != 0.0:
            if s[SHIFT] > 0.0:
                s[PLACE] = 1.0
            elif s[SHIFT] < 0.0:
                s[PLACE] = -1.0
            else:
                s[PLACE] = 0.0


@njit()
def step(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """One scan."""
    check(p, s, i, o)
    check_dead_zone(p, s, i, o)
    if s[FAULT] == 0.0:
        take(p, s, i, o)
        take_dead_zone(p, s, i, o)
    prepare(p, s, i, o)
    correct(p, s, i, o)
    drive(p, s, i, o)
    return_path(p, s, i, o)
    invert(p, s, i, o)
    report(p, s, i, o)
