"""A file with the values of one tag: which column holds them, and what the tag is called."""

from __future__ import annotations

from dataclasses import dataclass

from lostmotion.files.columns import SAMPLING_NAMES, key, usual
from lostmotion.files.long import called
from lostmotion.files.moments import with_moments
from lostmotion.files.names import BESIDE, LONG
from lostmotion.files.number_cells import text_cells
from lostmotion.files.table import Table
from lostmotion.files.tags import isa_role, tag_and_role

ROLES = ("op", "pv", "sp", "position", "mode")


@dataclass(frozen=True, eq=False)
class OneTag:
    """Columns of a file that holds one tag; None: not there.

    Attributes
    ----------
    table : Table
        With one column of times, where dates and times of day stood apart.
    value : str
        Column of values.
    time, quality : str or None
        Columns beside it.
    tag : str
        What a column of tags repeats; empty without one.
    """

    table: Table
    value: str
    time: str | None
    quality: str | None
    tag: str = ""

    def told(self, stem: str) -> list[str]:
        """Names that tell a role: what the file says inside, then what it is called."""
        inside = "" if key(self.value) in LONG["value"] else self.value
        return [name for name in (self.tag, inside, stem) if name and role_of(name)]


def one_tag(table: Table) -> OneTag | None:
    """Columns of a table that holds the values of one tag only; None: it holds more, or nothing.

    Examples
    --------
    >>> import narwhals.stable.v2 as nw
    >>> import polars as pl
    >>> frame = pl.DataFrame({"Time": ["1", "2"], "Value": ["5", "6"], "Quality": ["Good", "Good"]})
    >>> found = one_tag(Table(nw.from_native(frame, eager_only=True), "FIC101_OP.csv"))
    >>> found.value, found.time, found.told("FIC101_OP")
    ('Value', 'Time', ['FIC101_OP'])
    """
    table = with_moments(table)
    quality = called(table, "quality")
    tag = called(table, "tag")
    word = _repeated(table, tag) if tag else ""
    if tag and not word:
        return None
    rest = [name for name in table.names if name not in (quality, tag)]
    times = usual("time", rest)
    if len(times) > 1:
        return None
    time = times[0] if times else None
    values = [name for name in rest if name != time and key(name) not in (*SAMPLING_NAMES, *BESIDE)]
    return OneTag(table, values[0], time, quality or None, word) if len(values) == 1 else None


def role_of(name: str) -> str:
    """Role that a name tells; empty: none.

    Examples
    --------
    >>> role_of("FIC101_OP"), role_of("FT_101"), role_of("Sollwert"), role_of("trend 1")
    ('op', 'pv', 'sp', '')
    """
    parsed = tag_and_role(name)
    if parsed is not None:
        return parsed[1]
    return isa_role(name) or next((role for role in ROLES if usual(role, [name])), "")


def has_tag(name: str) -> bool:
    """Whether a name says of which loop it is, beside its role."""
    return tag_and_role(name) is not None or bool(isa_role(name))


def _repeated(table: Table, name: str) -> str:
    """The one word in a column; empty: it holds several."""
    words = text_cells(table.column(name)).drop_nulls().unique()
    return str(words[0]) if len(words) == 1 else ""
