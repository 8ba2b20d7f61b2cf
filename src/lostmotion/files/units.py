"""Engineering unit of a column: what stands in its name or in the row of units above the rows."""

from __future__ import annotations

import re

from lostmotion.files.names import SECONDS, UNIT_ROW, UNITS
from lostmotion.files.table import Table
from lostmotion.files.tags import BRACKETS
from lostmotion.records.span import is_signal

LONGEST = 12  # letters of a unit in a row of units
_NEW = re.compile(r"[^\W\d_][^\W_]{0,11}")  # in square brackets: a word, not the number of a channel
_PER = re.compile(r"[A-Za-zµ°%²³.\d*]{1,8}/(s|sec|min|h|hr|hour|d|day|[cm]?m[23²³]?|k?g|l|mol|lb|k)", re.IGNORECASE)


def unit_of(table: Table, name: str) -> str:
    """Unit of a column as it is written; empty: not known.

    Examples
    --------
    >>> import narwhals.stable.v2 as nw
    >>> import polars as pl
    >>> frame = pl.DataFrame({"PV [m3/h]": [1, 2], "OP (1)": [3, 4], "CO": [5, 6], "Stellgröße %": [7, 8]})
    >>> table = Table(nw.from_native(frame, eager_only=True), "a", units={"CO": "[%]"})
    >>> [unit_of(table, name) for name in table.names]
    ['m3/h', '', '%', '%']
    >>> [_in_name(name) for name in ("OP_mA", "OP (4-20 mA)", "OP [counts]", "OP [2]", "FIC101_OP")]
    ['mA', '4-20 mA', 'counts', '', '']
    """
    return _in_name(name) or _in_row(table.units.get(name, ""))


def _in_name(name: str) -> str:
    """In brackets at its end, or its last word where that can be nothing else (PV m3/h, OP_mA)."""
    found = BRACKETS.search(name)
    if found is not None:
        inside = found[1].strip()
        known = inside.lower() in UNITS or is_signal(inside) or _PER.fullmatch(inside)
        return inside if known or (found[0].lstrip()[0] == "[" and _NEW.fullmatch(inside)) else ""
    words = re.split(r"[\s_]+", name.strip())
    last = words[-1] if len(words) > 1 else ""
    signal = is_signal(last) and last.lower() in UNITS
    return last if signal or (last.lower() in UNITS and re.search(r"[%/°]", last)) else ""


def _in_row(cell: str) -> str:
    """A cell of a row of units, where it says one."""
    bare = cell.strip("[]() ")
    none = not bare or len(bare) > LONGEST or bare.lower() in (UNIT_ROW - UNITS - {"ph", "in"}) | set(SECONDS)
    return "" if none else bare
