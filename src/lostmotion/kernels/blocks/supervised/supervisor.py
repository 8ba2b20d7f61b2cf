"""Scan kernel in front of a compensating block: parameters from outside, but only checked, shown and accepted ones.

A request is a new id, three whole numbers (factor, first and second width of the kind, in RESOLUTION) and a checksum.
The block checks it, shows it (ECHO) and waits; an edge of ACCEPT, given where the plant is operated, arms it. The
compensation runs while the heartbeat changes within TIMEOUT scans, OP_IN is good, the loop is automatic with its
cascade closed and not tracking, and what is in force is within the limits set in the PLC. Whatever of this is lost
sheds it: the offset goes away on its ramp, and only a new request and a new accept bring it back.

Checksum: ``c = BLOCK_KEY``, then for id, factor, first, second: ``c = (31 c + (v + 4000000) mod 524287) mod 524287``.
All numbers stay whole and below 2^24, so that REAL holds them exactly; no bit operations, which dialects do not share.
524287 is prime and 31 * 524286 + 524286 < 2^24. Requests that differ in one value, by less than 524287, differ in it.

Settings and memory are counted from the end of their arrays: those of the kind lie before. Order of a scan:
:func:`listen`, :func:`judge`, :func:`shed`, :func:`attend` (the waiting request), :func:`consider` (a new one),
:func:`put_in_force`; then the block of the kind, then :func:`tell`.
"""

from __future__ import annotations

from lostmotion.arrays import Reals
from lostmotion.kernels.blocks.core import (
    ENABLE,
    FACTOR,
    FAULT,
    GOOD,
    HOLD_ON_DISABLE,
    INPUTS,
    LEAST_SETTING,
    MOST_FACTOR,
    MOST_SETTING,
    OP_IN,
    OUTPUTS,
    TRACK,
)
from lostmotion.kernels.numba_cache import njit

# Parameters
TIMEOUT, SHOW_SCANS, ACCEPT_SCANS, LEAST_SCANS, BLOCK_KEY = range(-9, -4)
RESOLUTION, FIRST_RANGE, SECOND_RANGE, MOST_CHANGE = range(-4, 0)

# Inputs
REQUEST_ID, ASKED_FACTOR, ASKED_FIRST, ASKED_SECOND, CHECKSUM, HEARTBEAT = range(INPUTS, INPUTS + 6)
ACCEPT, AUTO_MODE, CASCADE = range(INPUTS + 6, INPUTS + 9)

# Outputs
SUPERVISION, REFUSAL, SHED_REASON, WAITING, LINK_OK = range(OUTPUTS, OUTPUTS + 5)
ECHO_ID, ECHO_FACTOR, ECHO_FIRST, ECHO_SECOND = range(OUTPUTS + 5, OUTPUTS + 9)
FORCE_ID, FORCE_FACTOR, FORCE_FIRST, FORCE_SECOND = range(OUTPUTS + 9, OUTPUTS + 13)

# State
SET_FIRST, SET_SECOND, BEGUN, LAST_BEAT, SILENT, LINK, FAILING = range(-37, -30)
LAST_ID, PENDING, PEND_FACTOR, PEND_FIRST, PEND_SECOND, PEND_SUM, SHOWN, WAS_ACCEPT, EDGE = range(-30, -21)
ARMED, SETTLED, WAS_SHED, LOST, REFUSED, ACCEPTED_ID, SINCE_ACCEPT = range(-21, -14)
ODD, SUM, DIGIT, SPAN, NEW_FACTOR, NEW_FIRST, NEW_SECOND = range(-14, -7)
USE_FACTOR, USE_FIRST, USE_SECOND, RUN, KEEP, SHOW_ID, SHOW_STATE = range(-7, 0)


@njit()
def listen(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """LINK while the heartbeat, 0 .. 4000000, has changed within TIMEOUT scans; EDGE of ACCEPT."""
    s[EDGE] = 0.0
    if s[BEGUN] != 0.0 and i[ACCEPT] != 0.0 and s[WAS_ACCEPT] == 0.0:
        s[EDGE] = 1.0
    s[WAS_ACCEPT] = i[ACCEPT]
    if s[LINK] != 0.0:
        s[SILENT] = s[SILENT] + 1.0
    if i[HEARTBEAT] >= 0.0 and i[HEARTBEAT] <= 4000000.0 and i[HEARTBEAT] != s[LAST_BEAT]:
        s[LAST_BEAT] = i[HEARTBEAT]
        if s[BEGUN] != 0.0:
            s[LINK] = 1.0
            s[SILENT] = 0.0
    if s[SILENT] >= p[TIMEOUT]:
        s[LINK] = 0.0


@njit()
def judge(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """FAILING: what forbids to compensate, 0 nothing."""
    s[SPAN] = abs(p[FACTOR]) + abs(s[SET_FIRST]) + abs(s[SET_SECOND])
    s[SPAN] = s[SPAN] + abs(p[RESOLUTION]) + abs(p[FIRST_RANGE]) + abs(p[SECOND_RANGE]) + abs(p[MOST_CHANGE])
    s[FAILING] = 0.0
    if s[BEGUN] == 0.0:
        s[FAILING] = 1.0
    elif s[LINK] == 0.0:
        s[FAILING] = 2.0
    elif i[GOOD] == 0.0 or i[OP_IN] - i[OP_IN] != 0.0:
        s[FAILING] = 3.0
    elif i[TRACK] != 0.0:
        s[FAILING] = 4.0
    elif i[AUTO_MODE] == 0.0:
        s[FAILING] = 5.0
    elif i[CASCADE] == 0.0:
        s[FAILING] = 6.0
    elif s[SPAN] - s[SPAN] != 0.0 or p[RESOLUTION] < LEAST_SETTING or p[RESOLUTION] > MOST_SETTING:
        s[FAILING] = 7.0
    elif p[FACTOR] > MOST_FACTOR or p[FIRST_RANGE] > MOST_SETTING or p[SECOND_RANGE] > MOST_SETTING:
        s[FAILING] = 7.0
    elif p[MOST_CHANGE] > MOST_SETTING:
        s[FAILING] = 7.0
    elif s[FAULT] != 0.0:
        s[FAILING] = 8.0
    elif s[ARMED] != 0.0:
        s[NEW_FACTOR] = s[USE_FACTOR]
        s[NEW_FIRST] = s[USE_FIRST]
        s[NEW_SECOND] = s[USE_SECOND]
        within(p, s, i, o)
        if s[ODD] != 0.0:
            s[FAILING] = 7.0


@njit()
def within(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """ODD where the new values are beyond the limits set in the PLC, or a limit is no number."""
    s[ODD] = 0.0
    if s[NEW_FACTOR] < 0.0 or not s[NEW_FACTOR] <= p[FACTOR]:
        s[ODD] = 1.0
    if not abs(s[NEW_FIRST] - s[SET_FIRST]) <= p[FIRST_RANGE]:
        s[ODD] = 1.0
    if not abs(s[NEW_SECOND] - s[SET_SECOND]) <= p[SECOND_RANGE]:
        s[ODD] = 1.0


@njit()
def shed(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """Take what is in force away; it does not come back by itself."""
    if s[ARMED] != 0.0 and s[FAILING] != 0.0:
        s[ARMED] = 0.0
        s[WAS_SHED] = 1.0
        s[LOST] = s[FAILING]
    if s[SINCE_ACCEPT] < p[LEAST_SCANS]:
        s[SINCE_ACCEPT] = s[SINCE_ACCEPT] + 1.0


@njit()
def attend(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """The waiting request: withdrawn, changed under the eyes of the operator, accepted, or too old."""
    if s[PENDING] != 0.0:
        s[SHOWN] = s[SHOWN] + 1.0
        s[REFUSED] = 0.0
        if i[REQUEST_ID] == 0.0:
            s[REFUSED] = 8.0
        elif i[REQUEST_ID] != s[LAST_ID] or i[CHECKSUM] != s[PEND_SUM]:
            s[REFUSED] = 7.0
        elif i[ASKED_FACTOR] != s[PEND_FACTOR] or i[ASKED_FIRST] != s[PEND_FIRST]:
            s[REFUSED] = 7.0
        elif i[ASKED_SECOND] != s[PEND_SECOND]:
            s[REFUSED] = 7.0
        elif s[EDGE] != 0.0:
            weigh(p, s, i, o)
            if s[REFUSED] == 0.0 and s[SHOWN] < p[SHOW_SCANS]:
                s[REFUSED] = 9.0
            if s[REFUSED] == 0.0:
                adopt(p, s, i, o)
        elif s[FAILING] != 0.0:
            s[REFUSED] = 6.0
        elif s[SHOWN] >= p[ACCEPT_SCANS]:
            s[REFUSED] = 10.0
        if s[REFUSED] != 0.0:
            s[PENDING] = 0.0


@njit()
def adopt(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """What was accepted is in force; where nothing was, the block has one scan to refuse it before it runs."""
    s[PENDING] = 0.0
    if s[ARMED] == 0.0:
        s[SETTLED] = 0.0
    s[ARMED] = 1.0
    s[WAS_SHED] = 0.0
    s[LOST] = 0.0
    s[ACCEPTED_ID] = s[LAST_ID]
    s[SINCE_ACCEPT] = 0.0
    s[USE_FACTOR] = s[NEW_FACTOR]
    s[USE_FIRST] = s[NEW_FIRST]
    s[USE_SECOND] = s[NEW_SECOND]


@njit()
def consider(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """A request with an id above all before, 1 .. 4000000: refused, or waiting for the operator."""
    if s[BEGUN] == 0.0:
        if i[REQUEST_ID] >= 0.0 and i[REQUEST_ID] <= 4000000.0:
            s[LAST_ID] = i[REQUEST_ID]  # it stood there before the start: nobody asks now
    elif i[REQUEST_ID] != 0.0 and i[REQUEST_ID] != s[LAST_ID]:
        if i[REQUEST_ID] < s[LAST_ID] or i[REQUEST_ID] > 4000000.0:
            s[REFUSED] = 1.0
        else:
            s[LAST_ID] = i[REQUEST_ID]
            s[REFUSED] = 0.0
            weigh(p, s, i, o)
            if s[REFUSED] == 0.0:
                s[PENDING] = 1.0
                s[SHOWN] = 0.0
                s[PEND_FACTOR] = i[ASKED_FACTOR]
                s[PEND_FIRST] = i[ASKED_FIRST]
                s[PEND_SECOND] = i[ASKED_SECOND]
                s[PEND_SUM] = i[CHECKSUM]


@njit()
def weigh(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """REFUSED where the request in the inputs cannot be taken now."""
    check_size(p, s, i, o)
    if s[ODD] != 0.0:
        s[REFUSED] = 3.0
    else:
        check_sum(p, s, i, o)
        s[NEW_FACTOR] = i[ASKED_FACTOR] * p[RESOLUTION]
        s[NEW_FIRST] = i[ASKED_FIRST] * p[RESOLUTION]
        s[NEW_SECOND] = i[ASKED_SECOND] * p[RESOLUTION]
        within(p, s, i, o)
        if s[SUM] != i[CHECKSUM]:
            s[REFUSED] = 2.0
        elif s[FAILING] != 0.0:
            s[REFUSED] = 6.0
        elif s[ODD] != 0.0:
            s[REFUSED] = 3.0
        elif abs(s[NEW_FIRST] - s[USE_FIRST]) > p[MOST_CHANGE] or abs(s[NEW_SECOND] - s[USE_SECOND]) > p[MOST_CHANGE]:
            s[REFUSED] = 4.0
        elif s[ACCEPTED_ID] != 0.0 and s[SINCE_ACCEPT] < p[LEAST_SCANS]:
            s[REFUSED] = 5.0


@njit()
def check_size(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """ODD where a number of the request is too large for the checksum."""
    s[ODD] = 0.0
    if i[ASKED_FACTOR] < -4000000.0 or i[ASKED_FACTOR] > 4000000.0:
        s[ODD] = 1.0
    if i[ASKED_FIRST] < -4000000.0 or i[ASKED_FIRST] > 4000000.0:
        s[ODD] = 1.0
    if i[ASKED_SECOND] < -4000000.0 or i[ASKED_SECOND] > 4000000.0:
        s[ODD] = 1.0
    if p[BLOCK_KEY] < 0.0 or p[BLOCK_KEY] >= 524287.0:
        s[ODD] = 1.0


@njit()
def check_sum(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """SUM of the request in the inputs, 0 .. 524286."""
    s[SUM] = p[BLOCK_KEY]
    s[DIGIT] = s[LAST_ID]
    add(p, s, i, o)
    s[DIGIT] = i[ASKED_FACTOR]
    add(p, s, i, o)
    s[DIGIT] = i[ASKED_FIRST]
    add(p, s, i, o)
    s[DIGIT] = i[ASKED_SECOND]
    add(p, s, i, o)


@njit()
def add(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """SUM = (31 SUM + (DIGIT + 4000000) mod 524287) mod 524287."""
    s[DIGIT] = s[DIGIT] + 4000000.0
    s[DIGIT] = s[DIGIT] % 524287.0
    s[SUM] = s[SUM] * 31.0
    s[SUM] = s[SUM] + s[DIGIT]
    s[SUM] = s[SUM] % 524287.0


@njit()
def put_in_force(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """What the block of the kind gets: RUN, KEEP and the values, no factor while nothing is accepted."""
    s[RUN] = 0.0
    s[KEEP] = 0.0
    if s[ARMED] == 0.0:
        s[USE_FACTOR] = 0.0
        s[USE_FIRST] = s[SET_FIRST]
        s[USE_SECOND] = s[SET_SECOND]
    else:
        if s[SETTLED] != 0.0:
            s[RUN] = i[ENABLE]
            s[KEEP] = p[HOLD_ON_DISABLE]
        s[SETTLED] = 1.0


@njit()
def supervise(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """Everything before the block of the kind."""
    listen(p, s, i, o)
    judge(p, s, i, o)
    shed(p, s, i, o)
    attend(p, s, i, o)
    consider(p, s, i, o)
    put_in_force(p, s, i, o)


@njit()
def tell(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """The outputs of the supervision."""
    s[SHOW_ID] = 0.0
    s[SHOW_STATE] = 0.0
    if s[ARMED] != 0.0:
        s[SHOW_ID] = s[ACCEPTED_ID]
        s[SHOW_STATE] = 2.0
        if s[RUN] != 0.0:
            s[SHOW_STATE] = 3.0
    elif s[PENDING] != 0.0:
        s[SHOW_STATE] = 1.0
    elif s[WAS_SHED] != 0.0:
        s[SHOW_STATE] = 4.0
    o[SUPERVISION] = s[SHOW_STATE]
    o[REFUSAL] = s[REFUSED]
    o[SHED_REASON] = s[LOST]
    o[WAITING] = s[PENDING]
    o[LINK_OK] = s[LINK]
    o[ECHO_ID] = s[LAST_ID]
    o[ECHO_FACTOR] = s[PEND_FACTOR]
    o[ECHO_FIRST] = s[PEND_FIRST]
    o[ECHO_SECOND] = s[PEND_SECOND]
    o[FORCE_ID] = s[SHOW_ID]
    o[FORCE_FACTOR] = s[USE_FACTOR]
    o[FORCE_FIRST] = 0.0
    o[FORCE_SECOND] = 0.0
    if s[ARMED] != 0.0:
        o[FORCE_FIRST] = s[USE_FIRST]
        o[FORCE_SECOND] = s[USE_SECOND]
    s[BEGUN] = 1.0
