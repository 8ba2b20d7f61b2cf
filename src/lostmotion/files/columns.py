"""Names of columns -> roles (OP, PV, SP, position, time): what the user named, else the usual names."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

from lostmotion.errors import ColumnError
from lostmotion.files.actuator_columns import actuator_pair, is_position
from lostmotion.files.hints import likely
from lostmotion.files.names import ALIASES, SAMPLING_NAMES, SECONDS
from lostmotion.files.tags import BRACKETS, folded, key, loops_of, one_loop, same_tag, tag_and_role

Wanted = str | Literal[False] | None

__all__ = ["SAMPLING_NAMES", "Columns", "Wanted", "by_alias", "key", "named", "resolve", "time_unit", "usual"]
SHOWN = 8  # loops in a message
OF_ACTUATOR = "No column holds PV: the position of the actuator, {!r}, stands for it."


class SeveralLoopsError(ColumnError):
    """Columns of several loops, and none was named; `loops` are their tags."""

    loops: tuple[str, ...] = ()


@dataclass(frozen=True)
class Columns:
    """Which column plays which role, None: not there, or not wanted; and the tag that they share, where they do."""

    op: str
    pv: str
    sp: str | None
    position: str | None
    time: str | None
    notes: tuple[str, ...] = ()
    mode: str | None = None
    loop: str = ""

    @property
    def pv_is_position(self) -> bool:
        """Whether the column of PV holds the position of the actuator, and no other does."""
        return self.position is None and is_position(self.pv)


def resolve(
    names: Sequence[str],
    op: str = "OP",
    pv: str = "PV",
    sp: Wanted = "SP",
    position: Wanted = None,
    time: Wanted = None,
    mode: Wanted = None,
    loop: str | None = None,
) -> Columns:
    """Find the column of each role.

    Parameters
    ----------
    names : sequence of str
        Columns that are there.
    op, pv, sp, position, time, mode : str, None or False
        Name of the column, matched exactly or else without regard to case. The defaults ("OP", "PV", "SP"
        and None) also accept the usual other names. ``sp=None`` and ``False`` for any: do not read it.
    loop : str, optional
        Tag of one of several loops; see :func:`lostmotion.files.tags.loops_of`.

    Raises
    ------
    ColumnError
        A column is missing, or several fit and none has the exact name; several loops and none is named.

    Examples
    --------
    >>> found = resolve(["Time", "CO", "pv"])
    >>> found.op, found.pv, found.sp, found.notes
    ('CO', 'pv', None, ("OP was read from column 'CO'.",))
    >>> resolve(["Time", "FC1.PV", "FC1.OUT", "FC2.PV", "FC2.OUT"], loop="fc2").op
    'FC2.OUT'
    """
    op, pv, sp, position, pair = _actuator_only(names, op, pv, sp, position)
    wanted: dict[str, Wanted] = {
        "op": op,
        "pv": pv,
        "sp": False if sp is None else sp,
        "position": position,
        "time": time,
        "mode": mode,
    }
    found = {role: named(role, name, names) for role, name in wanted.items() if _is_named(role, name)}
    tag = _loop(names, found, loop)
    if tag:
        ours = loops_of(names)[tag]
        found = {role: name for role, name in ours.items() if wanted[role] is not False} | found
        names = [name for name in names if name in found.values() or tag_and_role(name) is None]
    notes = [*pair, *(_note(role, name) for role, name in found.items() if not _is_named(role, wanted[role]))]
    chosen = _is_named("op", op) and _is_named("pv", pv)
    for role, name in wanted.items():
        if role in found or name is False:
            continue
        rest = [other for other in names if other not in found.values()]
        if role == "sp" and chosen and len(usual(role, rest)) > 1:
            rest = _of_tag(rest, found["pv"], notes)
        column = by_alias(role, rest)
        if column is None and isinstance(name, str) and role != "sp":
            _no_double(found | {role: name})
            raise _missing(role, names, found)
        if column is not None:
            found[role] = column
            if key(column) != role and role != "time":
                notes.append(_note(role, column))
    _no_double(found)
    _of_one_loop(found, wanted)
    return Columns(
        found["op"],
        found["pv"],
        found.get("sp"),
        found.get("position"),
        found.get("time"),
        tuple(notes),
        found.get("mode"),
        tag,
    )


def columns_of_loops(names: Sequence[str], **asked: Any) -> dict[str, Columns]:
    """Columns of each loop by its tag, as :func:`resolve` finds them one by one, in a time linear in their number.

    Raises
    ------
    ColumnError
        As in resolve, of any loop.

    Examples
    --------
    >>> found = columns_of_loops(["Time", "FC1.PV", "FC1.OUT", "FC2.PV", "FC2.OUT"])
    >>> found["FC2"].op, found["FC1"].time
    ('FC2.OUT', 'Time')
    """
    loops = loops_of(names)
    own = {column for roles in loops.values() for column in roles.values()}
    place = {name: number for number, name in enumerate(names)}
    shared = [name for name in names if name not in own and tag_and_role(name) is None]
    shared += [name for name in asked.values() if name in place]
    return {
        tag: resolve(sorted({*roles.values(), *shared}, key=place.__getitem__), loop=tag, **asked)
        for tag, roles in loops.items()
    }


def _actuator_only(
    names: Sequence[str], op: str, pv: str, sp: Wanted, position: Wanted
) -> tuple[str, str, Wanted, Wanted, list[str]]:
    """Columns to look for, where a table may hold an actuator and no loop: its position is then PV; and a note.

    Only where no column is called as OP or as PV is, so that no loop is read otherwise.
    """
    if _is_named("pv", pv) or usual("pv", names):
        return op, pv, sp, (False if position is None and _is_named("pv", pv) and is_position(pv) else position), []
    named_op = _is_named("op", op)
    if named_op and isinstance(position, str):
        return op, position, sp, False, [OF_ACTUATOR.format(position)]
    pair = None if usual("op", names) else actuator_pair(names)
    if pair is None or named_op:
        return op, pv, sp, position, []
    return pair[0], pair[1], (False if sp == "SP" else sp), False, [OF_ACTUATOR.format(pair[1])]


def _of_tag(names: Sequence[str], pv: str, notes: list[str]) -> list[str]:
    """Columns without those of SP that are of another loop than PV; without all of them where that leaves several.

    Who has chosen OP and PV is not asked once more for a column that may be missing; what is not read is noted.
    """
    fits, tag = usual("sp", names), (tag_and_role(pv) or ("", ""))[0]
    ours = [name for name in fits if tag and (tag_and_role(name) or ("", ""))[0] == tag]
    if len(ours) != 1:
        notes.append(f"SP was not read: {', '.join(map(repr, fits[:SHOWN]))} fit; name it with sp='<column>'.")
        ours = []
    return [name for name in names if name not in fits or name in ours]


def _note(role: str, column: str) -> str:
    return f"{_title(role)} was read from column {column!r}."


def _loop(names: Sequence[str], found: dict[str, str], loop: str | None) -> str:
    """Tag whose columns are to be read: the one that was asked for, or the only one; empty: not told by tags."""
    loops = loops_of(names)
    if loop is not None:
        fits = [loop] if loop in loops else [tag for tag in loops if same_tag(tag, loop)]
        if len(fits) != 1:
            raise no_such_loop(loop, list(loops))
        return fits[0]
    of_column = [tag for tag, roles in loops.items() if set(roles.values()) & set(found.values())]
    if len(of_column) == 1 and not {"op", "pv"} <= set(found):
        return of_column[0]
    if {"op", "pv"} <= set(found) or any(usual(role, names, tags=False) for role in ("op", "pv")):
        return ""
    if len(loops) > 1:
        raise several_loops(list(loops), "the columns of one loop")
    return next(iter(loops), "")


def several_loops(tags: Sequence[str], expected: str) -> SeveralLoopsError:
    """Error that names the loops, and leads on to each."""
    more = f" and {len(tags) - SHOWN} more" if len(tags) > SHOWN else ""
    said = f"{len(tags)} loops: {', '.join(tags[:SHOWN])}{more}"
    error = SeveralLoopsError.expected(expected, said, f"name one: loop={tags[0]!r}")
    error.loops = tuple(tags)
    return error.leads_on(*({"loop": tag} for tag in tags))


def no_such_loop(loop: str, tags: Sequence[str]) -> ColumnError:
    """Error for the tag of a loop that is not there."""
    more = f" and {len(tags) - SHOWN} more" if len(tags) > SHOWN else ""
    said = f"{', '.join(tags[:SHOWN])}{more}" if tags else "no columns that tell a loop"
    remedy = f"name one: loop={tags[0]!r}" if tags else "name columns: op='<column>' and pv='<column>'"
    error = ColumnError.expected(f"a loop {loop!r}", said, remedy)
    return error.leads_on(*({"loop": tag} for tag in tags))


def _missing(role: str, names: Sequence[str], found: dict[str, str]) -> ColumnError:
    """Name what is missing, and the columns that it may be."""
    error = ColumnError.missing(_title(role), names, f"name it with {role}='<column>'")
    return error.leads_on(*likely(names, found))


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
        error = ColumnError.expected(f"one column for {_title(role)}", f"{fits}", remedy)
        raise error.leads_on(*({role: name} for name in fits))
    return fits[0] if fits else None


def usual(role: str, names: Sequence[str], tags: bool = True) -> list[str]:
    """Columns that fit a role equally well, and better than all others; `tags`: by the end of a tag if by nothing else.

    Examples
    --------
    >>> usual("mode", ["OP", "Auto/Man", "FIC-101.Mode"])
    ['Auto/Man']
    """
    for fits in (
        [name for name in names if name.strip().lower() == role],
        [name for name in names if key(name) == role],
        [name for name in names if key(name) in ALIASES[role]],
        [name for name in names if tags and (tag_and_role(name) or ("", ""))[1] == role],
    ):
        if fits:
            return fits
    return []


def time_unit(name: str) -> float | None:
    """Seconds in the unit that the name of a time column states; None: it states none.

    Examples
    --------
    >>> time_unit("t_ms"), time_unit("time [min]"), time_unit("Time")
    (0.001, 60.0, None)
    """
    bracket = BRACKETS.search(name)
    if bracket:
        return SECONDS.get(bracket.group(1).strip().lower())
    words = re.split(r"[\s_\-.]+", folded(name))
    return SECONDS.get(words[-1]) if len(words) > 1 else None


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


def _of_one_loop(found: dict[str, str], wanted: dict[str, Wanted]) -> None:
    """Refuse OP and PV whose tags are of different loops, where neither was named."""
    parsed = [tag_and_role(found[role]) for role in ("op", "pv") if not _is_named(role, wanted[role])]
    tags = [one[0] for one in parsed if one is not None]
    if len(tags) == 2 and not one_loop(*tags):
        both = {role: found[role] for role in ("op", "pv")}
        raise ColumnError.expected(
            "OP and PV of one loop",
            f"{found['op']!r} and {found['pv']!r}",
            f"name them where they belong together: op={found['op']!r} and pv={found['pv']!r}",
        ).leads_on(both)


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
