"""Names of columns -> roles (OP, PV, SP, position, time): what the user named, else the usual names."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from lostmotion.errors import ColumnError

Wanted = str | Literal[False] | None

# "CV" is no alias: it is the controlled variable in one place and the control valve in another.
# "input" and "output" are none either: of the plant or of the controller?
ALIASES: dict[str, tuple[str, ...]] = {
    "op": ("co", "mv", "out", "u", "controller output", "controller out", "manipulated variable"),
    "pv": ("y", "measurement", "process value", "process variable", "measured value"),
    "sp": ("sv", "setpoint", "set point", "r", "ref", "reference"),
    "position": ("pos", "zt", "stem", "stem position", "valve position", "actuator position", "travel"),
    "mode": ("loop mode", "controller mode", "control mode", "auto man", "auto/man", "a/m"),
    "time": (
        "timestamp",
        "time stamp",
        "datetime",
        "date time",
        "date",
        "t",
        "elapsed",
        "elapsed time",
        "ts",
    ),
}
SAMPLING_NAMES = ("ts", "dt", "sampling time", "sample time")
UNITS = {
    "ms": 1e-3, "msec": 1e-3, "milliseconds": 1e-3, "s": 1.0, "sec": 1.0, "secs": 1.0, "seconds": 1.0,
    "min": 60.0, "mins": 60.0, "minutes": 60.0, "h": 3600.0, "hr": 3600.0, "hours": 3600.0,
}  # fmt: skip
_BRACKETS = re.compile(r"\s*[\[(]([^\])]*)[\])]\s*$")


@dataclass(frozen=True)
class Columns:
    """Which column plays which role; None: not there, or not wanted."""

    op: str
    pv: str
    sp: str | None
    position: str | None
    time: str | None
    notes: tuple[str, ...] = ()
    mode: str | None = None


def resolve(
    names: Sequence[str],
    op: str = "OP",
    pv: str = "PV",
    sp: Wanted = "SP",
    position: Wanted = None,
    time: Wanted = None,
    mode: Wanted = None,
) -> Columns:
    """Find the column of each role.

    Parameters
    ----------
    names : sequence of str
        Columns that are there.
    op, pv, sp, position, time, mode : str, None or False
        Name of the column, matched exactly or else without regard to case. The defaults ("OP", "PV", "SP"
        and None) also accept the usual other names. ``sp=None`` and ``False`` for any: do not read it.

    Raises
    ------
    ColumnError
        A column is missing, or several fit and none has the exact name.

    Examples
    --------
    >>> found = resolve(["Time", "CO", "pv"])
    >>> found.op, found.pv, found.sp, found.notes
    ('CO', 'pv', None, ("OP was read from column 'CO'.",))
    """
    wanted: dict[str, Wanted] = {
        "op": op,
        "pv": pv,
        "sp": False if sp is None else sp,
        "position": position,
        "time": time,
        "mode": mode,
    }
    found = {role: named(role, name, names) for role, name in wanted.items() if _is_named(role, name)}
    notes = []
    for role, name in wanted.items():
        if role in found or name is False:
            continue
        rest = [other for other in names if other not in found.values()]
        column = by_alias(role, rest)
        if column is None and isinstance(name, str) and role != "sp":
            raise ColumnError.missing(_title(role), names, f"name it with {role}='<column>'")
        if column is not None:
            found[role] = column
            if key(column) != role and role != "time":
                notes.append(f"{_title(role)} was read from column {column!r}.")
    _no_double(found)
    return Columns(
        found["op"],
        found["pv"],
        found.get("sp"),
        found.get("position"),
        found.get("time"),
        tuple(notes),
        found.get("mode"),
    )


def by_alias(role: str, names: Sequence[str]) -> str | None:
    """Column that has the usual name of a role, one of its other names, or ends with it (FIC-101.OP).

    Raises
    ------
    ColumnError
        Several fit equally well.

    Examples
    --------
    >>> by_alias("sp", ["OP", "Set_Point [%]"]), by_alias("op", ["FIC-101.OP", "FIC-101.PV"])
    ('Set_Point [%]', 'FIC-101.OP')
    """
    fits = usual(role, names)
    if len(fits) > 1:
        remedy = f"rename the others, or say which: {role}={fits[0]!r}"
        raise ColumnError.expected(f"one column for {_title(role)}", f"{fits}", remedy)
    return fits[0] if fits else None


def usual(role: str, names: Sequence[str]) -> list[str]:
    """Columns that fit a role equally well, and better than all others.

    Examples
    --------
    >>> usual("mode", ["OP", "Auto/Man", "FIC-101.Mode"])
    ['Auto/Man']
    """
    for fits in (
        [name for name in names if name.strip().lower() == role],
        [name for name in names if key(name) == role],
        [name for name in names if key(name) in ALIASES[role]],
        [name for name in names if re.search(rf"[./:]{role}$", name.strip().lower())],
    ):
        if fits:
            return fits
    return []


def key(name: str) -> str:
    """Name without case, separators and unit, for comparison.

    Examples
    --------
    >>> key("Set_Point [m3/h]"), key("t_s"), key("T (ms)")
    ('set point', 't', 't')
    """
    bare = _words(_BRACKETS.sub("", name))
    if len(bare) > 1 and bare[-1] in UNITS:
        bare = bare[:-1]
    return " ".join(bare)


def time_unit(name: str) -> float | None:
    """Seconds in the unit that the name of a time column states; None: it states none.

    Examples
    --------
    >>> time_unit("t_ms"), time_unit("time [min]"), time_unit("Time")
    (0.001, 60.0, None)
    """
    bracket = _BRACKETS.search(name)
    if bracket:
        return UNITS.get(bracket.group(1).strip().lower())
    words = _words(name)
    return UNITS.get(words[-1]) if len(words) > 1 else None


def _words(name: str) -> list[str]:
    return re.split(r"[\s_\-.]+", name.strip().lower())


def _title(role: str) -> str:
    return role.upper() if len(role) == 2 else role


def _is_named(role: str, name: Wanted) -> bool:
    return isinstance(name, str) and name.strip().lower() != role


def named(role: str, name: Wanted, names: Sequence[str]) -> str:
    """Column that the user named, exactly or else without regard to case.

    Raises
    ------
    ColumnError
        It is not there, or several differ in case only.
    """
    wanted = str(name)
    if wanted in names:
        return wanted
    fits = [other for other in names if other.strip().lower() == wanted.strip().lower()]
    if len(fits) > 1:
        raise ColumnError.expected(f"one column {wanted!r}", f"{fits}", f"give {role}='<column>' with the exact case")
    if not fits:
        raise ColumnError.missing(wanted, names, f"name it with {role}='<column>'")
    return fits[0]


def _no_double(found: dict[str, str]) -> None:
    roles: dict[str, str] = {}
    for role, column in found.items():
        if column in roles:
            raise ColumnError.expected(
                f"different columns for {_title(roles[column])} and {_title(role)}",
                f"{column!r} for both",
                f"name another one, {role}='<column>'",
            )
        roles[column] = role
