"""Columns of an actuator without a loop: its command and its position, which then stands for PV."""

from __future__ import annotations

import re
from collections.abc import Sequence

from lostmotion.errors import ColumnError
from lostmotion.files.names import ALIASES
from lostmotion.files.tags import key

COMMANDS = (
    "setpoint", "set point", "position setpoint", "target position", "target pos", "command", "cmd", "demand",
    "position command", "valve command", "commanded position", "desired position",
)  # fmt: skip
POSITIONS = (
    *ALIASES["position"], "position", "feedback", "position feedback", "valve feedback", "actual position",
    "actual pos", "measured position", "encoder",
)  # fmt: skip
_NUMBER = re.compile(r"\(\s*(\w+)\s*\)\s*$|[\s_\-.](\d+)$")  # "pos (3)", "pos_3"
_JOINED = re.compile(r"^(\w*?)[\s_\-.]?(command|cmd|demand|feedback|position|pos)$", re.IGNORECASE)


def is_position(name: str) -> bool:
    """Whether a column is called as the position of an actuator.

    Examples
    --------
    >>> is_position("Position"), is_position("pos (3)"), is_position("valveFeedback"), is_position("PV")
    (True, True, True, False)
    """
    return _part(name)[1] == "position"


def actuator_pair(names: Sequence[str]) -> tuple[str, str] | None:
    """Columns of the command and the position of one actuator; None where there is none.

    Raises
    ------
    ColumnError
        Several actuators.

    Examples
    --------
    >>> actuator_pair(["time_s", "setpoint", "position", "torque"])
    ('setpoint', 'position')
    >>> actuator_pair(["damperCommand", "damperFeedback"])
    ('damperCommand', 'damperFeedback')
    >>> actuator_pair(["OP", "PV"]) is None
    True
    """
    roles: dict[str, dict[str, str]] = {}
    for name in names:
        group, role = _part(name)
        if role:
            roles.setdefault(group, {}).setdefault(role, name)
    pairs = [(pair["command"], pair["position"]) for pair in roles.values() if len(pair) == 2]
    if len(pairs) > 1:
        first = {"op": pairs[0][0], "pv": pairs[0][1]}
        got = ", ".join(f"{command!r} and {position!r}" for command, position in pairs)
        remedy = f"name one: op={first['op']!r} and pv={first['pv']!r}"
        error = ColumnError.expected("command and position of one actuator", got, remedy)
        raise error.leads_on(*({"op": command, "pv": position} for command, position in pairs))
    return pairs[0] if pairs else None


def _part(name: str) -> tuple[str, str]:
    """Which actuator a column belongs to, and whether it is its command or its position; else empty."""
    number = _NUMBER.search(name)
    group = "" if number is None else str(number.group(1) or number.group(2))
    word = key(name if number is None else name[: number.start()])
    if word in COMMANDS:
        return group, "command"
    if word in POSITIONS:
        return group, "position"
    joined = _JOINED.match(name.strip())
    if joined is None or not joined.group(1):
        return "", ""
    role = "command" if joined.group(2).lower() in ("command", "cmd", "demand") else "position"
    return joined.group(1).lower(), role
