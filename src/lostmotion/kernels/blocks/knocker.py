"""Scan kernel: the knocker, short pulses in the direction in which the controller pulls at a sticking valve.

Source: T. Hagglund, "A friction compensator for pneumatic control valves", Journal of Process Control 12 (2002)
897-904, and his patent US 6 285 913. As recalled, not read again: ``u_k(t) = a sign(u(t) - u(t_p))`` for pulses of
amplitude a and width tau at a distance h_k, t_p being the onset of the previous pulse; a of 1 to 4 %, tau of one or two
sampling intervals and h_k of 2 to 5 tau are recommended.

As published: pulses of equal amplitude, width and distance, the sign from the move of OP_IN since the previous pulse.
Different: the sign is taken at the onset and held for the pulse; no pulse where OP_IN has moved by no more than BAND
since the last pulse (BAND = 0 is the published rule), and then the reference stays, so that slow moves add up.
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
    STATES,
    TOTAL,
    USED_BAND,
    USED_FACTOR,
    WANTED,
    WAS_ACTIVE,
    check,
    drive,
    prepare,
    report,
    return_path,
    take,
)
from lostmotion.kernels.numba_cache import njit

AMPLITUDE, PULSE_SCANS, PERIOD_SCANS = range(PARAMETERS, PARAMETERS + 3)
USED_AMPLITUDE, USED_PULSE_SCANS, USED_PERIOD_SCANS, CLOCK, ONSET, PULSE_SIDE = range(STATES, STATES + 6)
SIZE = STATES + 6


@njit()
def check_knocker(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """FAULT 3 where 0 <= amplitude, 1 <= pulse <= period does not hold, or a size is out of bounds."""
    s[TOTAL] = abs(p[AMPLITUDE]) + abs(p[PULSE_SCANS]) + abs(p[PERIOD_SCANS])
    if s[FAULT] == 0.0:
        if s[TOTAL] - s[TOTAL] != 0.0 or p[AMPLITUDE] < 0.0:
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif p[PULSE_SCANS] < 1.0 or p[PULSE_SCANS] > p[PERIOD_SCANS]:
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif p[AMPLITUDE] > MOST_SETTING or p[PERIOD_SCANS] > MOST_SETTING:
            s[FAULT] = 1.0 + 1.0 + 1.0
        elif p[AMPLITUDE] > 0.0 and p[AMPLITUDE] < LEAST_SETTING:
            s[FAULT] = 1.0 + 1.0 + 1.0


@njit()
def take_knocker(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """Take the settings, known to be usable."""
    if p[AMPLITUDE] != s[USED_AMPLITUDE]:
        s[CHANGED] = 1.0
    s[USED_AMPLITUDE] = p[AMPLITUDE]
    s[USED_PULSE_SCANS] = p[PULSE_SCANS]
    s[USED_PERIOD_SCANS] = p[PERIOD_SCANS]


@njit()
def onset(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """Begin the next pulse: its side from the move of the signal since the last one."""
    s[CLOCK] = 0.0
    s[PULSE_SIDE] = 0.0
    if s[QUIETED] > s[ONSET] + s[USED_BAND]:
        s[PULSE_SIDE] = 1.0
        s[ONSET] = s[QUIETED]
    elif s[QUIETED] < s[ONSET] - s[USED_BAND]:
        s[PULSE_SIDE] = -1.0
        s[ONSET] = s[QUIETED]


@njit()
def correct(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """WANTED = the pulse, or nothing between pulses."""
    s[WANTED] = s[QUIETED] - s[BASE]
    if s[ACTIVE] == 0.0 or s[WAS_ACTIVE] == 0.0 or s[FROZEN] != 0.0:
        s[CLOCK] = 0.0
        s[PULSE_SIDE] = 0.0
        s[ONSET] = s[QUIETED]
    else:
        s[CLOCK] = s[CLOCK] + 1.0
        if s[CLOCK] >= s[USED_PERIOD_SCANS]:
            onset(p, s, i, o)
        if s[CLOCK] < s[USED_PULSE_SCANS]:
            s[TOTAL] = s[USED_AMPLITUDE] * s[USED_FACTOR]
            s[TOTAL] = s[TOTAL] * s[PULSE_SIDE]
            s[WANTED] = s[WANTED] + s[TOTAL]


@njit()
def step(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """One scan; the back-calculation takes the offset as it is."""
    check(p, s, i, o)
    check_knocker(p, s, i, o)
    if s[FAULT] == 0.0:
        take(p, s, i, o)
        take_knocker(p, s, i, o)
    prepare(p, s, i, o)
    correct(p, s, i, o)
    drive(p, s, i, o)
    return_path(p, s, i, o)
    report(p, s, i, o)
