"""Scan kernel: inverse of a backlash, the command ahead of OP_IN by half the width in the direction of motion.

LEAD_UP and LEAD_DOWN are the halves of the width upwards and downwards (equal for a plain play). The direction turns
only when the signal has come back by more than BAND, so that noise does not throw the command from side to side.
PULSE adds a knock in the new direction for PULSE_SCANS scans after each turn (0: none).
"""

from __future__ import annotations

from lostmotion.arrays import Reals
from lostmotion.kernels.blocks.core import (
    ACTIVE,
    BASE,
    CHANGED,
    COMMAND,
    FAULT,
    FROZEN,
    INVERTING,
    LEAST_SETTING,
    MOST_SETTING,
    PARAMETERS,
    QUIETED,
    RETURNED,
    SIDE,
    STATES,
    TOTAL,
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

LEAD_UP, LEAD_DOWN, PULSE, PULSE_SCANS = range(PARAMETERS, PARAMETERS + 4)
USED_UP, USED_DOWN, USED_PULSE, USED_PULSE_SCANS, PUSHED, LEFT_SCANS, LEAD = range(STATES, STATES + 7)
SIZE = STATES + 7


@njit()
def check_backlash(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """FAULT 3 where a lead or the pulse is negative, not finite or out of bounds."""
    s[TOTAL] = abs(p[LEAD_UP]) + abs(p[LEAD_DOWN]) + abs(p[PULSE]) + abs(p[PULSE_SCANS])
    if s[FAULT] == 0.0:
        if s[TOTAL] - s[TOTAL] != 0.0 or p[LEAD_UP] < 0.0 or p[LEAD_DOWN] < 0.0:
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif p[PULSE] < 0.0 or p[PULSE_SCANS] < 0.0:
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif p[LEAD_UP] > MOST_SETTING or p[LEAD_DOWN] > MOST_SETTING or p[PULSE] > MOST_SETTING:
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif p[PULSE_SCANS] > MOST_SETTING or (p[LEAD_UP] > 0.0 and p[LEAD_UP] < LEAST_SETTING):
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif (p[LEAD_DOWN] > 0.0 and p[LEAD_DOWN] < LEAST_SETTING) or (p[PULSE] > 0.0 and p[PULSE] < LEAST_SETTING):
            s[FAULT] = 1.0 + 1.0 + 1.0


@njit()
def take_backlash(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """Take the settings, known to be usable."""
    s[TOTAL] = abs(p[LEAD_UP] - s[USED_UP]) + abs(p[LEAD_DOWN] - s[USED_DOWN])
    if s[TOTAL] != 0.0:
        s[CHANGED] = 1.0
    s[USED_UP] = p[LEAD_UP]
    s[USED_DOWN] = p[LEAD_DOWN]
    s[USED_PULSE] = p[PULSE]
    s[USED_PULSE_SCANS] = p[PULSE_SCANS]


@njit()
def lead(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """LEAD of the side in force."""
    s[LEAD] = 0.0
    if s[PUSHED] > 0.0:
        s[LEAD] = s[USED_UP] * s[USED_FACTOR]
    elif s[PUSHED] < 0.0:
        s[LEAD] = -(s[USED_DOWN] * s[USED_FACTOR])


@njit()
def correct(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """WANTED = lead in the direction of motion, and the knock after a turn."""
    if s[FROZEN] == 0.0 and s[PUSHED] != s[SIDE]:
        s[PUSHED] = s[SIDE]
        if s[ACTIVE] != 0.0:
            s[LEFT_SCANS] = s[USED_PULSE_SCANS]
    lead(p, s, i, o)
    s[WANTED] = s[LEAD] + (s[QUIETED] - s[BASE])
    if s[ACTIVE] == 0.0 or s[FROZEN] != 0.0:
        s[LEFT_SCANS] = 0.0
    elif s[LEFT_SCANS] > 0.0:
        s[LEFT_SCANS] = s[LEFT_SCANS] - 1.0
        if s[PUSHED] > 0.0:
            s[WANTED] = s[WANTED] + s[USED_PULSE]
        elif s[PUSHED] < 0.0:
            s[WANTED] = s[WANTED] - s[USED_PULSE]


@njit()
def invert(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """RETURNED where it was asked for."""
    if s[INVERTING] != 0.0:
        s[RETURNED] = s[COMMAND] - s[LEAD]


@njit()
def step(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """One scan."""
    check(p, s, i, o)
    check_backlash(p, s, i, o)
    if s[FAULT] == 0.0:
        take(p, s, i, o)
        take_backlash(p, s, i, o)
    prepare(p, s, i, o)
    correct(p, s, i, o)
    drive(p, s, i, o)
    return_path(p, s, i, o)
    invert(p, s, i, o)
    report(p, s, i, o)
