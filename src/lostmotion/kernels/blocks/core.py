"""Safeguards that every compensating block shares: settings, clamps, ramp, tracking, bad input, back-calculation.

A block is a scan kernel ``step(p, s, i, o)`` on four arrays of one float type: parameters, state, inputs, outputs,
indexed by the constants below (and those of its kind). It is also the text from which PLC code is made, hence the
narrow language: assignments to elements, if / elif / else, calls with the same four arguments, ``+ - * /``, ``min``,
``max``, ``abs``, comparisons, and no literal but 0.0 and 1.0. Flags are 0.0 / 1.0, counts whole numbers.
``x - x == 0.0`` is true for finite x only. Every number is stored before the next operation where a literal is
involved, so float32 never widens. Named constants are numbers that float32 and float64 both hold exactly.

A scan: :func:`check` and a check of the kind (are the settings usable?), :func:`take` (a usable set replaces the last
one as a whole; an unusable one changes nothing and sets ERROR), :func:`prepare` (mode, direction), the correction of
the kind (``s[WANTED]``, the offset that it would like), :func:`drive` (what of it is applied), the inverse of the kind
where it is asked for (``s[INVERTING]``), :func:`report`.

Laws, for any input whatever: OP_OUT is finite and within the last usable clamps; OFFSET moves by at most RAMP_STEP a
scan while anything is switched (enable, disable, end of tracking, bad quality, new settings) and by at most RATE
otherwise; OP_OUT = clamp(clamp(OP_IN) + OFFSET) except while tracking or holding.
"""

from __future__ import annotations

from lostmotion.arrays import Reals
from lostmotion.kernels.numba_cache import njit

# Parameters
FACTOR, BAND, QUIET, RAMP_STEP, RATE, CAP, LOW, HIGH, HOLD_ON_DISABLE, SAFE, COUNT_LIMIT = range(11)
PARAMETERS = 11  # those of the kind follow

# Inputs
OP_IN, ENABLE, GOOD, TRACK, TRACK_VALUE = range(5)
INPUTS = 5

# Outputs
OP_OUT, OFFSET, BACK, DIRECTION, REVERSALS, STATE, LIMITED_LOW, LIMITED_HIGH, OFFSET_CAPPED, RAMPING, ERROR = range(11)
OUTPUTS = 11

# State: what is known, the settings in use, the mode, the signals
STARTED, HAS_LIMITS, HAS_SETTINGS, HAS_BASE, HAS_SENSE, HAS_COMMAND, FAULT, TOTAL, CHANGED = range(9)
USED_FACTOR, USED_BAND, USED_QUIET, USED_RAMP, USED_RATE, USED_CAP, USED_LOW, USED_HIGH = range(9, 17)
USED_HOLD, USED_SAFE, USED_COUNT_LIMIT = range(17, 20)
USABLE, TRACKING, WAS_TRACKING, HOLDING, ALIVE, ACTIVE, WAS_ACTIVE, CHASING, FROZEN, INVERTING = range(20, 30)
BASE, QUIETED, SENSED, EXTREME, SIDE, TURNED, TURN_POINT, TURNS = range(30, 38)
WANTED, CAPPED, ALLOWED, DISTANCE, APPLIED, HELD, COMBINED, CUT, COMMAND, RETURNED, CUT_LOW, CUT_HIGH = range(38, 50)
STATES = 50  # those of the kind follow

# Sizes of settings, those of `compensate.block`; the smallest is 1e-12 down to a power of two: REAL rounds 1e-12 down
MOST_FACTOR, MOST_SETTING, LEAST_SETTING = 2.0, 1e9, 2.0**-40


@njit()
def check(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """FAULT: 0 settings usable, 1 clamps, ramp or safe output not, 2 another common one not.

    Usable clamps, ramp and safe output are taken at once, so that a block with unusable widths passes OP through.
    """
    s[FAULT] = 0.0
    s[CHANGED] = 0.0
    s[TOTAL] = abs(p[FACTOR]) + abs(p[BAND]) + abs(p[QUIET]) + abs(p[RATE]) + abs(p[CAP]) + abs(p[COUNT_LIMIT])
    if s[TOTAL] - s[TOTAL] != 0.0 or p[FACTOR] < 0.0 or p[BAND] < 0.0 or p[QUIET] < 0.0:
        s[FAULT] = 1.0 + 1.0
    elif p[RATE] < 0.0 or p[CAP] < 0.0 or p[COUNT_LIMIT] < 1.0:
        s[FAULT] = 1.0 + 1.0
    elif p[FACTOR] > MOST_FACTOR or p[BAND] > MOST_SETTING or p[QUIET] > MOST_SETTING or p[RATE] > MOST_SETTING:
        s[FAULT] = 1.0 + 1.0
    elif p[CAP] > MOST_SETTING or p[COUNT_LIMIT] > MOST_SETTING or (p[FACTOR] > 0.0 and p[FACTOR] < LEAST_SETTING):
        s[FAULT] = 1.0 + 1.0
    elif (p[BAND] > 0.0 and p[BAND] < LEAST_SETTING) or (p[QUIET] > 0.0 and p[QUIET] < LEAST_SETTING):
        s[FAULT] = 1.0 + 1.0
    elif (p[RATE] > 0.0 and p[RATE] < LEAST_SETTING) or (p[CAP] > 0.0 and p[CAP] < LEAST_SETTING):
        s[FAULT] = 1.0 + 1.0
    check_limits(p, s, i, o)


@njit()
def check_limits(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """FAULT 1 where clamps, ramp or safe output are not usable; taken where they are."""
    s[TOTAL] = abs(p[LOW]) + abs(p[HIGH]) + abs(p[SAFE]) + abs(p[RAMP_STEP])
    if s[TOTAL] - s[TOTAL] != 0.0 or p[LOW] > p[HIGH] or p[RAMP_STEP] < 0.0:
        s[FAULT] = 1.0
    elif p[LOW] < -MOST_SETTING or p[HIGH] > MOST_SETTING or p[SAFE] > MOST_SETTING or p[SAFE] < -MOST_SETTING:
        s[FAULT] = 1.0
    elif p[LOW] != 0.0 and p[LOW] < LEAST_SETTING and p[LOW] > -LEAST_SETTING:
        s[FAULT] = 1.0
    elif p[HIGH] != 0.0 and p[HIGH] < LEAST_SETTING and p[HIGH] > -LEAST_SETTING:
        s[FAULT] = 1.0
    elif p[RAMP_STEP] > MOST_SETTING or (p[RAMP_STEP] > 0.0 and p[RAMP_STEP] < LEAST_SETTING):
        s[FAULT] = 1.0
    elif p[SAFE] != 0.0 and p[SAFE] < LEAST_SETTING and p[SAFE] > -LEAST_SETTING:
        s[FAULT] = 1.0
    else:
        s[USED_LOW] = p[LOW]
        s[USED_HIGH] = p[HIGH]
        s[USED_SAFE] = min(max(p[SAFE], p[LOW]), p[HIGH])
        s[USED_RAMP] = p[RAMP_STEP]
        s[HAS_LIMITS] = 1.0


@njit()
def take(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """Take the common settings, known to be usable; CHANGED where they move the offset."""
    s[TOTAL] = abs(p[FACTOR] - s[USED_FACTOR]) + abs(p[CAP] - s[USED_CAP]) + abs(p[QUIET] - s[USED_QUIET])
    if s[TOTAL] != 0.0:
        s[CHANGED] = 1.0
    s[USED_FACTOR] = p[FACTOR]
    s[USED_BAND] = p[BAND]
    s[USED_QUIET] = p[QUIET]
    s[USED_RATE] = p[RATE]
    s[USED_CAP] = p[CAP]
    s[USED_HOLD] = p[HOLD_ON_DISABLE]
    s[USED_COUNT_LIMIT] = p[COUNT_LIMIT]
    s[HAS_SETTINGS] = 1.0


@njit()
def prepare(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """Mode of this scan, OP_IN within the clamps (BASE), and the direction of its moves."""
    s[WAS_ACTIVE] = s[ACTIVE]
    s[WAS_TRACKING] = s[TRACKING]
    s[USABLE] = 0.0
    s[TRACKING] = 0.0
    s[HOLDING] = 0.0
    s[ALIVE] = 0.0
    s[ACTIVE] = 0.0
    s[FROZEN] = 0.0
    if i[OP_IN] - i[OP_IN] == 0.0 and s[HAS_LIMITS] != 0.0:
        s[USABLE] = 1.0
        s[HAS_BASE] = 1.0
        s[BASE] = min(max(i[OP_IN], s[USED_LOW]), s[USED_HIGH])
    elif s[HAS_BASE] != 0.0:
        s[BASE] = min(max(s[BASE], s[USED_LOW]), s[USED_HIGH])
    if i[TRACK] != 0.0:
        if i[TRACK_VALUE] - i[TRACK_VALUE] == 0.0 and s[HAS_LIMITS] != 0.0:
            s[TRACKING] = 1.0
        else:
            s[HOLDING] = 1.0
    elif s[USABLE] == 0.0:
        s[HOLDING] = 1.0
    elif i[GOOD] != 0.0:
        s[ALIVE] = 1.0
        if i[ENABLE] != 0.0 and s[HAS_SETTINGS] != 0.0:
            s[ACTIVE] = 1.0
            if s[WAS_ACTIVE] != 0.0:
                s[FROZEN] = s[CHASING]
                if s[CHANGED] != 0.0:  # the side may turn in the next scan, at RATE: only the change is ramped
                    s[FROZEN] = 1.0
    sense(p, s, i, o)
    turn(p, s, i, o)


@njit()
def sense(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """What the direction is taken from: BASE behind a play of +-QUIET, or the command while it is tracked."""
    if s[ALIVE] != 0.0:
        if s[HAS_SENSE] == 0.0:
            s[QUIETED] = s[BASE]
            s[EXTREME] = s[BASE]
            s[HAS_SENSE] = 1.0
        elif s[BASE] > s[QUIETED] + s[USED_QUIET]:
            s[QUIETED] = s[BASE] - s[USED_QUIET]
        elif s[BASE] < s[QUIETED] - s[USED_QUIET]:
            s[QUIETED] = s[BASE] + s[USED_QUIET]
        s[SENSED] = s[QUIETED]
    elif s[TRACKING] != 0.0:
        s[SENSED] = s[COMMAND]
    if s[TRACKING] != s[WAS_TRACKING]:
        s[EXTREME] = s[SENSED]


@njit()
def turn(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """SIDE is the direction of the signal; it turns when the signal has come back by more than BAND."""
    s[TURNED] = 0.0
    if s[SIDE] == 0.0:
        if s[SENSED] > s[EXTREME] + s[USED_BAND]:
            s[SIDE] = 1.0
            s[EXTREME] = s[SENSED]
        elif s[SENSED] < s[EXTREME] - s[USED_BAND]:
            s[SIDE] = -1.0
            s[EXTREME] = s[SENSED]
    elif s[SIDE] > 0.0:
        if s[SENSED] > s[EXTREME]:
            s[EXTREME] = s[SENSED]
        elif s[SENSED] < s[EXTREME] - s[USED_BAND]:
            s[TURNED] = 1.0
            s[SIDE] = -1.0
    elif s[SENSED] < s[EXTREME]:
        s[EXTREME] = s[SENSED]
    elif s[SENSED] > s[EXTREME] + s[USED_BAND]:
        s[TURNED] = 1.0
        s[SIDE] = 1.0
    if s[TURNED] != 0.0:
        s[TURN_POINT] = s[EXTREME]
        s[EXTREME] = s[SENSED]
        s[TURNS] = s[TURNS] + 1.0
        if s[TURNS] >= s[USED_COUNT_LIMIT]:
            s[TURNS] = 0.0


@njit()
def drive(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """COMMAND of this scan, and the offset in it (APPLIED)."""
    s[CUT] = 0.0
    s[CUT_LOW] = 0.0
    s[CUT_HIGH] = 0.0
    s[CAPPED] = 0.0
    if s[HAS_LIMITS] == 0.0:
        s[COMMAND] = 0.0
        if p[SAFE] - p[SAFE] == 0.0 and p[SAFE] <= MOST_SETTING and p[SAFE] >= -MOST_SETTING:
            s[COMMAND] = p[SAFE]
    elif s[TRACKING] != 0.0 or s[HOLDING] != 0.0:
        impose(p, s, i, o)
    else:
        choose(p, s, i, o)
        approach(p, s, i, o)
        combine(p, s, i, o)


@njit()
def impose(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """The tracked value, or the last command; APPLIED is then what keeps the command when this ends."""
    if s[TRACKING] != 0.0:
        s[COMMAND] = i[TRACK_VALUE]
    elif s[HAS_COMMAND] == 0.0:
        s[COMMAND] = s[USED_SAFE]
    if s[COMMAND] < s[USED_LOW]:
        s[CUT_LOW] = 1.0
    if s[COMMAND] > s[USED_HIGH]:
        s[CUT_HIGH] = 1.0
    s[COMMAND] = min(max(s[COMMAND], s[USED_LOW]), s[USED_HIGH])
    if s[HAS_BASE] != 0.0:
        s[APPLIED] = s[COMMAND] - s[BASE]
    s[CHASING] = 1.0


@njit()
def choose(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """WANTED: that of the kind within the cap while active; nothing, or what is held, otherwise."""
    if s[ACTIVE] == 0.0:
        s[WANTED] = 0.0
        if s[USED_HOLD] != 0.0 and i[ENABLE] == 0.0 and i[GOOD] != 0.0:
            s[WANTED] = s[HELD]
        s[CHASING] = 1.0
    else:
        if s[WANTED] != s[WANTED]:
            s[WANTED] = 0.0
            s[CAPPED] = 1.0
        if s[WANTED] > s[USED_CAP]:
            s[WANTED] = s[USED_CAP]
            s[CAPPED] = 1.0
        elif s[WANTED] < -s[USED_CAP]:
            s[WANTED] = -s[USED_CAP]
            s[CAPPED] = 1.0
        if s[WAS_ACTIVE] == 0.0 or s[CHANGED] != 0.0:
            s[CHASING] = 1.0


@njit()
def approach(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """APPLIED goes to WANTED, by at most RAMP_STEP after a switch until it is there, by at most RATE otherwise."""
    s[ALLOWED] = s[USED_RATE]
    if s[CHASING] != 0.0:
        s[ALLOWED] = s[USED_RAMP]
    if s[STARTED] == 0.0:
        s[ALLOWED] = 0.0
    s[DISTANCE] = s[WANTED] - s[APPLIED]
    if s[DISTANCE] > s[ALLOWED]:
        s[APPLIED] = s[APPLIED] + s[ALLOWED]
    elif s[DISTANCE] < -s[ALLOWED]:
        s[APPLIED] = s[APPLIED] - s[ALLOWED]
    else:
        s[APPLIED] = s[WANTED]
        s[CHASING] = 0.0
    if s[ACTIVE] != 0.0:
        s[HELD] = min(max(s[APPLIED], -s[USED_CAP]), s[USED_CAP])


@njit()
def combine(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """COMMAND = BASE + APPLIED within the clamps."""
    s[COMBINED] = s[BASE] + s[APPLIED]
    if i[OP_IN] < s[USED_LOW]:
        s[CUT_LOW] = 1.0
    if i[OP_IN] > s[USED_HIGH]:
        s[CUT_HIGH] = 1.0
    if s[COMBINED] < s[USED_LOW]:
        s[CUT] = 1.0
        s[CUT_LOW] = 1.0
    if s[COMBINED] > s[USED_HIGH]:
        s[CUT] = 1.0
        s[CUT_HIGH] = 1.0
    s[COMMAND] = min(max(s[COMBINED], s[USED_LOW]), s[USED_HIGH])


@njit()
def return_path(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """RETURNED: the OP_IN that belongs to COMMAND; INVERTING where the kind has to work it out."""
    s[INVERTING] = 0.0
    if s[HAS_LIMITS] == 0.0:
        s[RETURNED] = s[COMMAND]
    elif s[TRACKING] != 0.0 or s[HOLDING] != 0.0:
        s[RETURNED] = s[COMMAND]
        if s[HAS_SETTINGS] != 0.0:
            if i[ENABLE] != 0.0:
                s[INVERTING] = 1.0
            elif s[USED_HOLD] != 0.0:
                s[RETURNED] = s[COMMAND] - s[HELD]
    elif s[CUT] == 0.0:
        s[RETURNED] = s[BASE]
    else:
        s[RETURNED] = s[COMMAND] - s[APPLIED]
        if s[ACTIVE] != 0.0 and s[CAPPED] == 0.0 and s[APPLIED] == s[WANTED]:
            s[INVERTING] = 1.0


@njit()
def report(p: Reals, s: Reals, i: Reals, o: Reals) -> None:
    """Write all outputs, and leave the state ready for the next scan."""
    if s[HAS_LIMITS] != 0.0:
        s[RETURNED] = min(max(s[RETURNED], s[USED_LOW]), s[USED_HIGH])
    if s[TRACKING] != 0.0:
        s[QUIETED] = s[RETURNED]
        s[SENSED] = s[RETURNED]
        s[HAS_SENSE] = 1.0
    o[OP_OUT] = s[COMMAND]
    o[OFFSET] = s[APPLIED]
    o[BACK] = s[RETURNED]
    o[DIRECTION] = s[SIDE]
    o[REVERSALS] = s[TURNS]
    o[LIMITED_LOW] = s[CUT_LOW]
    o[LIMITED_HIGH] = s[CUT_HIGH]
    o[OFFSET_CAPPED] = s[CAPPED]
    o[ERROR] = s[FAULT]
    o[RAMPING] = 0.0
    if s[TRACKING] == 0.0 and s[HOLDING] == 0.0 and s[HAS_LIMITS] != 0.0:
        o[RAMPING] = s[CHASING]
    if s[STARTED] == 0.0:
        o[STATE] = 0.0
    elif s[TRACKING] != 0.0:
        o[STATE] = 1.0 + 1.0 + 1.0
    elif s[HOLDING] != 0.0 or i[GOOD] == 0.0:
        o[STATE] = 1.0 + 1.0 + 1.0 + 1.0
    elif s[ACTIVE] != 0.0:
        o[STATE] = 1.0 + 1.0
    else:
        o[STATE] = 1.0
    if s[HAS_LIMITS] != 0.0:
        s[STARTED] = 1.0
        s[HAS_COMMAND] = 1.0
