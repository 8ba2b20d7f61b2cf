"""A row for each value of each tag -> a column for each tag."""

from __future__ import annotations

import math
from dataclasses import replace

import narwhals.stable.v2 as nw
import polars as pl

from lostmotion.errors import ColumnError
from lostmotion.files.columns import usual
from lostmotion.files.names import LONG
from lostmotion.files.number_cells import native, text_cells
from lostmotion.files.quality import ALL, Trust, distrusted
from lostmotion.files.table import Table
from lostmotion.files.tags import folded, key

MOST_TAGS = 5000
TAG, VALUE = "\0tag", "\0value"  # columns, called as no column of a file is
NO_TAG = "null"  # of rows without one


def with_columns_of_tags(table: Table, trust: Trust = ALL) -> Table:
    """The table with a column for each tag, where it has one of tags, one of values and one of times.

    Values of bad quality are missing; `trust` says whether uncertain ones are.

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
    tag, value, quality = (called(table, role) for role in ("tag", "value", "quality"))
    time = usual("time", [name for name in table.names if name not in (tag, value, quality)])
    wide_already = all(usual(role, [name for name in table.names if name != value]) for role in ("op", "pv"))
    if not tag or not value or len(time) != 1 or wide_already:
        return table
    cells, bad = good_cells(table, value, quality, trust)
    stamps = table.column(time[0])
    when = text_cells(stamps) if isinstance(stamps.dtype, nw.String) else native(stamps)
    long = pl.DataFrame({"time": when, "tag": text_cells(table.column(tag)), "value": cells})
    note = f"A row holds one value of one tag: the columns are those of {tag!r}."
    frame = nw.from_native(wide(long, time[0]), eager_only=True)
    units = _units(table, long["tag"])
    return replace(table, frame=frame, lines=None, notes=(*table.notes, note, *bad), own_times=True, units=units)


def good_cells(
    table: Table, value: str, quality: str | None, trust: Trust = ALL, of: str = ""
) -> tuple[pl.Series, tuple[str, ...]]:
    """Cells of a column, NaN or "Bad" where their quality is bad, and notes that call them `of`."""
    values = table.column(value)
    cells = native(values) if values.dtype.is_numeric() else text_cells(values)
    if not quality:
        return cells, ()
    bad, notes = distrusted(table, quality, of or value, trust)
    mark = pl.lit("Bad") if cells.dtype == pl.String else pl.lit(math.nan)
    return pl.DataFrame({"v": cells, "b": bad}).select(pl.when("b").then(mark).otherwise("v").alias("v"))["v"], notes


def wide(long: pl.DataFrame, time: str) -> pl.DataFrame:
    """Column of times and one for each tag, of a frame with the columns time, tag and value.

    Raises
    ------
    ColumnError
        Two values of one tag at one time, or a tag that is called as the column of times.
    """
    long = long.with_columns(pl.col("tag").fill_null(NO_TAG))
    if (long["tag"] == time).any():
        raise ColumnError.expected(
            "tags with names of their own", f"one called {time!r}, as the column of times is", "rename it in the export"
        )
    if not _rising(long):
        long = long.unique(maintain_order=True)
        twice = long.select("time", "tag").is_duplicated()
        if twice.any():
            when, tag, _ = long.filter(twice).row(0)
            raise ColumnError.expected(
                "one value of a tag at a time", f"several of {tag!r} at {when!r}", "export with finer times"
            )
    else:
        parts = long.partition_by("tag", maintain_order=True)
        if all(part["time"].equals(parts[0]["time"], null_equal=False) for part in parts[1:]):  # one clock: as it is
            columns = [part["value"].alias(str(part["tag"][0])) for part in parts]
            return parts[0].select(pl.col("time").alias(time)).with_columns(*columns)
    long = long.rename({"time": time, "tag": TAG, "value": VALUE})
    return long.pivot(on=TAG, index=time, values=VALUE, maintain_order=True)


def _units(table: Table, tags: pl.Series) -> dict[str, str]:
    """Unit of each tag, where a column states them."""
    unit = called(table, "unit")
    if not unit:
        return {}
    pairs = pl.DataFrame({"tag": tags, "unit": text_cells(table.column(unit))}).drop_nulls().unique("tag")
    return dict(pairs.iter_rows())


def _rising(long: pl.DataFrame) -> bool:
    """Whether tag stands behind tag, each at rising times: then no two rows are of one tag and time."""
    runs = long["tag"].rle().struct.field("value")
    if runs.n_unique() < len(runs):
        return False
    later = (pl.col("time") > pl.col("time").shift()) | (pl.col("tag") != pl.col("tag").shift())
    return bool(long.select(later.fill_null(False).slice(1).all()).item())


def called(table: Table, role: str) -> str:
    """Column by one of its usual names; empty where there is none, or several."""
    found = [name for name in table.names if key(name) in LONG[role] or folded(name) in LONG[role]]
    return found[0] if len(found) == 1 else ""
