"""What a file holds, before it is read as a record: its columns, some rows, the role of each, its loops."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from lostmotion.errors import DataError, LostMotionError, one_line
from lostmotion.files.columns import resolve
from lostmotion.files.frames import peeked
from lostmotion.files.long import with_columns_of_tags
from lostmotion.files.moments import with_moments
from lostmotion.files.opened import Opened
from lostmotion.files.table import Table
from lostmotion.files.text_frame import TextFrame

ROLES = ("op", "pv", "sp", "position", "time", "mode")
MOST_COLUMNS, MOST_ROWS, MOST_LOOPS = 200, 6, 2000  # that are shown
MOST_CELL = 40  # characters


def looked(content: Opened, sources: Sequence[str], asked: Mapping[str, Any]) -> dict[str, Any]:
    """Columns, rows and roles, JSON-ready; columns that cannot be told have no role.

    Parameters
    ----------
    content : Opened
    sources : sequence of str
        Paths of it: of a long text only the first rows are looked at.
    asked : mapping
        Settings of :func:`lostmotion.read_loop` that the reader of the page has chosen.
    """
    named = asked.get("op") is not None and asked.get("pv") is not None
    loops = () if asked.get("loop") is not None or named else content.loops()
    table = _table(content, sources, asked.get("loop"))
    names = [] if table is None else table.names
    return {
        "columns": names[:MOST_COLUMNS],
        "more": max(len(names) - MOST_COLUMNS, 0),
        "rows": [] if table is None else _rows(table, names),
        "roles": {} if table is None else _roles(table, asked),
        "loops": list(loops[:MOST_LOOPS]),
        "loops_more": max(len(loops) - MOST_LOOPS, 0),
    }


def _table(content: Opened, sources: Sequence[str], loop: str | None) -> Table | None:
    if len(content.tables) > 1 and loop is None:
        return next(iter(content.tables.values()))
    try:
        table, _, _ = content.table(loop)
        if isinstance(table.frame, TextFrame) and len(sources) == 1:
            return peeked(Path(sources[0]))
    except LostMotionError:
        return None
    return table


def _rows(table: Table, names: Sequence[str]) -> list[list[str]]:
    """First rows as text."""
    shown = names[:MOST_COLUMNS]
    frame = table.frame[list(range(min(MOST_ROWS, len(table.frame))))]
    columns = [[_cell(value) for value in frame[name].to_list()] for name in shown]
    return [list(row) for row in zip(*columns, strict=True)]


def _cell(value: Any) -> str:
    text = "" if value is None else one_line(str(value))
    return text if len(text) <= MOST_CELL else f"{text[: MOST_CELL - 2]} .."


def _roles(table: Table, asked: Mapping[str, Any]) -> dict[str, str]:
    """Column by role, as the reader would take them; what was asked for alone where it cannot tell."""
    wanted = {role: asked[role] for role in ROLES if asked.get(role) is not None}
    settings: dict[str, Any] = {"op": "OP", "pv": "PV", "sp": "SP", **wanted}
    try:
        found = resolve(with_columns_of_tags(with_moments(table)).names, **settings, loop=asked.get("loop"))
    except DataError:
        return {role: str(name) for role, name in wanted.items() if name is not False}
    known = {role: getattr(found, role) for role in ROLES}
    return {role: name for role, name in known.items() if name is not None}
