"""Every variable of the compensating blocks: name, type, unit, meaning, default."""

from __future__ import annotations

from dataclasses import dataclass

SECTIONS = ("parameter", "input", "state", "output")
OP = "units of OP"
FORMER = {"ramp": "ramp_step"}  # settings of blocks saved before; RAMP is a function block of IEC 61131-3


@dataclass(frozen=True)
class Variable:
    """One variable of a block.

    Attributes
    ----------
    name : str
        The constant that indexes it in the kernel.
    section : {"parameter", "input", "state", "output"}
    kind : {"real", "bool", "int"}
        Type in the PLC; in the kernel all are reals.
    unit, meaning : str
    default : float
        Value before anything is known: of a parameter harmless (no compensation), of a state what a cold start has.
    """

    name: str
    section: str
    kind: str
    unit: str
    meaning: str
    default: float = 0.0


def _rows(section: str, *rows: tuple[str, str, str, str] | tuple[str, str, str, str, float]) -> tuple[Variable, ...]:
    return tuple(Variable(row[0], section, *row[1:]) for row in rows)


def _used(*names: str, kind: str = "real") -> tuple[Variable, ...]:
    text = {"real": OP, "bool": "", "int": ""}[kind]
    return tuple(Variable(name, "state", kind, text, "setting in use, the last that was usable") for name in names)


def _flags(*rows: tuple[str, str]) -> tuple[Variable, ...]:
    return tuple(Variable(name, "state", "bool", "", meaning) for name, meaning in rows)


COMMON = (
    *_rows(
        "parameter",
        ("FACTOR", "real", "1", "share of the lost motion that is compensated, 0 none, 1 all", 1.0),
        ("BAND", "real", OP, "noise band: the direction turns only after a return by more than this"),
        ("QUIET", "real", OP, "the command rests while OP_IN stays within +- this of where it rests; 0 off"),
        ("RAMP_STEP", "real", f"{OP} a scan", "largest change of the offset while anything is switched", 0.1),
        ("RATE", "real", f"{OP} a scan", "largest change of the offset while compensating", 200.0),
        ("CAP", "real", OP, "largest offset, either sign", 5.0),
        ("LOW", "real", OP, "lower clamp of OP_OUT"),
        ("HIGH", "real", OP, "upper clamp of OP_OUT", 100.0),
        ("HOLD_ON_DISABLE", "bool", "", "on disable keep the offset instead of taking it away"),
        ("SAFE", "real", OP, "OP_OUT before the first good input"),
        ("COUNT_LIMIT", "int", "", "REVERSALS starts again at 0 when it gets there", 1_000_000.0),
    ),
    *_rows(
        "input",
        ("OP_IN", "real", OP, "controller output"),
        ("ENABLE", "bool", "", "compensate"),
        ("GOOD", "bool", "", "quality of OP_IN", 1.0),
        ("TRACK", "bool", "", "manual: OP_OUT follows TRACK_VALUE"),
        ("TRACK_VALUE", "real", OP, "command in manual"),
    ),
    *_flags(
        ("STARTED", "the first scan is over"),
        ("HAS_LIMITS", "usable clamps have been seen"),
        ("HAS_SETTINGS", "a usable set of settings has been seen"),
        ("HAS_BASE", "a finite OP_IN has been seen"),
        ("HAS_SENSE", "the play and the direction have begun"),
        ("HAS_COMMAND", "a command has been given"),
    ),
    *_rows(
        "state",
        ("FAULT", "int", "", "0 settings usable, 1 clamps, ramp or safe output not, 2 other common ones, 3 the kind's"),
        ("TOTAL", "real", "", "scratch"),
        ("CHANGED", "bool", "", "a setting that moves the offset has changed in this scan"),
    ),
    *_used("USED_FACTOR", "USED_BAND", "USED_QUIET", "USED_RAMP", "USED_RATE", "USED_CAP", "USED_LOW", "USED_HIGH"),
    *_used("USED_HOLD", kind="bool"),
    *_used("USED_SAFE"),
    *_used("USED_COUNT_LIMIT", kind="int"),
    *_flags(
        ("USABLE", "OP_IN is finite"),
        ("TRACKING", "the command is imposed"),
        ("WAS_TRACKING", "the command was imposed in the last scan"),
        ("HOLDING", "the command is held: OP_IN or TRACK_VALUE is not finite"),
        ("ALIVE", "automatic, with a good OP_IN"),
        ("ACTIVE", "compensating"),
        ("WAS_ACTIVE", "compensating in the last scan"),
        ("CHASING", "the offset is on its ramp after a switch"),
        ("FROZEN", "the side is held while the offset is on its ramp"),
        ("INVERTING", "BACK is worked out by the inverse of the kind"),
    ),
    *_rows(
        "state",
        ("BASE", "real", OP, "OP_IN within the clamps, the last finite one"),
        ("QUIETED", "real", OP, "BASE behind the play of +-QUIET"),
        ("SENSED", "real", OP, "signal whose direction counts"),
        ("EXTREME", "real", OP, "furthest point of SENSED since the last turn"),
        ("SIDE", "real", "", "direction: -1 down, 0 not known yet, 1 up"),
        ("TURNED", "bool", "", "the direction has turned in this scan"),
        ("TURN_POINT", "real", OP, "where it turned last"),
        ("TURNS", "int", "", "turns so far"),
        ("WANTED", "real", OP, "offset that the kind asks for"),
        ("CAPPED", "bool", "", "WANTED was beyond the cap"),
        ("ALLOWED", "real", OP, "largest change of the offset in this scan"),
        ("DISTANCE", "real", OP, "from the applied to the wanted offset"),
        ("APPLIED", "real", OP, "offset in force"),
        ("HELD", "real", OP, "offset when last compensating"),
        ("COMBINED", "real", OP, "BASE + APPLIED"),
        ("CUT", "bool", "", "COMBINED is beyond a clamp"),
        ("COMMAND", "real", OP, "OP_OUT, the last"),
        ("RETURNED", "real", OP, "BACK, the last"),
        ("CUT_LOW", "bool", "", "at the lower clamp"),
        ("CUT_HIGH", "bool", "", "at the upper clamp"),
    ),
    *_rows(
        "output",
        ("OP_OUT", "real", OP, "command to the valve"),
        ("OFFSET", "real", OP, "offset added to OP_IN, before the clamps"),
        ("BACK", "real", OP, "OP_IN that belongs to OP_OUT, for the controller's anti-windup and tracking"),
        ("DIRECTION", "int", "", "direction of OP_IN (while tracking: of OP_OUT), -1, 0, 1"),
        ("REVERSALS", "int", "", "turns of that direction"),
        ("STATE", "int", "", "0 first scan, 1 passing through, 2 compensating, 3 tracking, 4 bad input"),
        ("LIMITED_LOW", "bool", "", "at the lower clamp"),
        ("LIMITED_HIGH", "bool", "", "at the upper clamp"),
        ("OFFSET_CAPPED", "bool", "", "the offset is at its cap"),
        ("RAMPING", "bool", "", "the offset is on its ramp after a switch"),
        (
            "ERROR",
            "int",
            "",
            "0 none; settings refused: 1 clamps, ramp or safe output, 2 other common ones, 3 the kind's",
        ),
    ),
)

DEAD_ZONE = (
    *_rows(
        "parameter",
        ("LEFT_BREAK", "real", OP, "left end of the dead zone"),
        ("RIGHT_BREAK", "real", OP, "right end of the dead zone"),
        ("CENTRE", "real", OP, "OP at which the valve shall rest, left end <= centre <= right end"),
        ("LEFT_SLOPE", "real", "x per OP", "slope of the valve left of the dead zone", 1.0),
        ("RIGHT_SLOPE", "real", "x per OP", "slope of the valve right of the dead zone", 1.0),
        ("SHAPE", "int", "", "way across the centre: 0 jump, 1 smooth, 2 hold", 2.0),
        ("ZONE", "real", OP, "half-width of the smooth line, or distance past the centre at which hold changes side"),
        ("HUNT_SCANS", "int", "scans", "changes of side within this of each other are hunting; 0: no guard"),
        ("HUNT_LIMIT", "int", "", "so many of them in a row and the guard gives way", 4.0),
        ("BACK_OFF", "real", "1", "by which it multiplies the share of the dead zone that is compensated", 0.9),
    ),
    *_used("USED_LEFT", "USED_RIGHT", "USED_CENTRE", "USED_LEFT_SLOPE", "USED_RIGHT_SLOPE"),
    *_used("USED_SHAPE", kind="int"),
    *_used("USED_ZONE"),
    *_used("USED_HUNT_SCANS", "USED_HUNT_LIMIT", kind="int"),
    *_used("USED_BACK_OFF"),
    *_rows(
        "state",
        ("PLACE", "real", "", "between the sides, -1 left .. 1 right"),
        ("SHIFT", "real", OP, "distance from the centre"),
        ("GAINED", "real", OP, "share of the slope in the offset"),
        ("LEVEL", "real", OP, "share of the dead zone in the offset"),
        ("KNEE", "real", OP, "command at which the smooth line ends"),
        ("PART_LEFT", "real", "1", "share that the guard has left of the compensation"),
        ("HALF", "real", "", "last side, -1, 0, 1"),
        ("SINCE", "int", "scans", "since the last change of side, up to HUNT_SCANS"),
        ("CLOSE", "int", "", "changes of side in a row that are hunting"),
    ),
)

BACKLASH = (
    *_rows(
        "parameter",
        ("LEAD_UP", "real", OP, "lead of the command while it rises: half the width"),
        ("LEAD_DOWN", "real", OP, "lead of the command while it falls: half the width"),
        ("PULSE", "real", OP, "knock added after a turn; 0 none"),
        ("PULSE_SCANS", "int", "scans", "length of the knock"),
    ),
    *_used("USED_UP", "USED_DOWN", "USED_PULSE"),
    *_used("USED_PULSE_SCANS", kind="int"),
    *_rows(
        "state",
        ("PUSHED", "real", "", "side in force, -1, 0, 1"),
        ("LEFT_SCANS", "int", "scans", "rest of the knock"),
        ("LEAD", "real", OP, "lead in force"),
    ),
)

KNOCKER = (
    *_rows(
        "parameter",
        ("AMPLITUDE", "real", OP, "height of a pulse"),
        ("PULSE_SCANS", "int", "scans", "length of a pulse", 1.0),
        ("PERIOD_SCANS", "int", "scans", "from one pulse to the next", 5.0),
    ),
    *_used("USED_AMPLITUDE"),
    *_used("USED_PULSE_SCANS", "USED_PERIOD_SCANS", kind="int"),
    *_rows(
        "state",
        ("CLOCK", "int", "scans", "since the last onset"),
        ("ONSET", "real", OP, "OP_IN at the last pulse"),
        ("PULSE_SIDE", "real", "", "sign of the pulse, -1, 0, 1"),
    ),
)

TWO_MOVES = (
    *_rows(
        "parameter",
        ("OVERSHOOT", "real", OP, "first move: how far beyond the aim"),
        ("STAND", "real", OP, "second move: how far short of the aim, (S - J) / 2"),
        ("MOVE_SCANS", "int", "scans", "length of the first move", 1.0),
        ("SHARE", "real", "1", "aim between the last trough and peak of OP_IN", 0.5),
        ("RELEASE", "real", OP, "move of OP_IN that ends the hold"),
    ),
    *_used("USED_OVERSHOOT", "USED_STAND"),
    *_used("USED_MOVE_SCANS", kind="int"),
    *_used("USED_SHARE", "USED_RELEASE"),
    *_rows(
        "state",
        ("PHASE", "int", "", "0 watching, 1 first move, 2 holding"),
        ("CLOCK", "int", "scans", "of the first move"),
        ("PEAK", "real", OP, "last peak of OP_IN"),
        ("TROUGH", "real", OP, "last trough of OP_IN"),
        ("SEEN", "int", "", "turning points since watching began"),
        ("AIM", "real", OP, "command at which the loop is in balance"),
        ("WAY", "real", "", "direction of the first move, -1, 1"),
        ("HOLD_IN", "real", OP, "OP_IN when the hold began"),
        ("PART", "real", OP, "scratch"),
    ),
)
