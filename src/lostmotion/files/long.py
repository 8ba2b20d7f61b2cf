"""A row for each value of each tag -> a column for each tag."""

from __future__ import annotations

from dataclasses import replace

import narwhals.stable.v2 as nw
import polars as pl

from lostmotion.errors import ColumnError
from lostmotion.files.columns import usual
from lostmotion.files.names import GOOD_QUALITY, LONG
from lostmotion.files.number_cells import text_cells
from lostmotion.files.table import Table
from lostmotion.files.tags import folded, key

MOST_TAGS = 5000


def with_columns_of_tags(table: Table) -> Table:
    """The table with a column for each tag, where it has one of tags, one of values and one of times.

    Values of bad quality are missing.

    Raises
    ------
    ColumnError
        Two values of one tag at one time.

    Examples
    --------
    >>> cells = {"Tag": ["F.OP", "F.PV", "F.OP"], "Time": ["1", "1", "2"], "Value": ["5", "6", "7"]}
    >>> wide = with_columns_of_tags(Table(nw.from_native(pl.DataFrame(cells), eager_only=True), "a"))
    >>> wide.frame.to_native().rows()
    [('1', '5', '6'), ('2', '7', None)]
    """
    tag, value, quality = (_called(table, role) for role in ("tag", "value", "quality"))
    time = usual("time", [name for name in table.names if name not in (tag, value, quality)])
    wide_already = all(usual(role, [name for name in table.names if name != value]) for role in ("op", "pv"))
    if not tag or not value or len(time) != 1 or wide_already:
        return table
    values = table.column(value)
    cells = text_cells(values) if not values.dtype.is_numeric() else pl.Series(values.to_list())
    if quality:
        words = text_cells(table.column(quality)).str.to_lowercase()
        good = words.is_in(list(GOOD_QUALITY)).fill_null(value=True)
        cells = pl.DataFrame({"v": cells, "g": good}).select(pl.when("g").then("v"))["v"]
    stamps = table.column(time[0])
    when = text_cells(stamps) if isinstance(stamps.dtype, nw.String) else pl.Series(stamps.to_list())
    long = pl.DataFrame({time[0]: when, "tag": text_cells(table.column(tag)), "value": cells}).unique(
        maintain_order=True
    )
    if long.select(time[0], "tag").is_duplicated().any():
        row = long.filter(long.select(time[0], "tag").is_duplicated()).row(0)
        raise ColumnError.expected(
            "one value of a tag at a time", f"several of {row[1]!r} at {row[0]!r}", "export again"
        )
    wide = long.pivot(on="tag", index=time[0], values="value", maintain_order=True)
    dropped = 0 if not quality else int((~good).sum())
    bad = (f"{dropped} values of bad quality count as missing.",) if dropped else ()
    note = f"A row holds one value of one tag: the columns are those of {tag!r}."
    frame = nw.from_native(wide, eager_only=True)
    return replace(table, frame=frame, lines=None, notes=(*table.notes, note, *bad), own_times=True)


def _called(table: Table, role: str) -> str:
    """Column by one of its usual names; empty where there is none, or several."""
    found = [name for name in table.names if key(name) in LONG[role] or folded(name) in LONG[role]]
    return found[0] if len(found) == 1 else ""
