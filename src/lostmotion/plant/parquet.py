"""Parquet -> what it holds from its schema and statistics, and of its rows and columns those of one loop only."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache
from pathlib import Path

import narwhals.stable.v2 as nw
import polars as pl

from lostmotion.errors import DataError
from lostmotion.files.columns import key, usual
from lostmotion.files.dataset import DATE_KEYS
from lostmotion.files.long import called
from lostmotion.files.names import LONG
from lostmotion.files.table import Table
from lostmotion.files.tags import isa, loops_of
from lostmotion.plant.period import Period

ALWAYS = Period()
MOST_READ = 12  # columns that are read although the loop may not need them
LOOP_KEYS = (*LONG["tag"], "loop", "loop tag", "loopname", "loop name", "loop id")


class Kind(StrEnum):
    """How a table holds its loops."""

    COLUMNS = "columns"  # of each loop its own, or those of one loop
    ROWS = "rows"  # OP and PV of many loops below each other, and a column that says of which
    LONG = "long"  # a row for each value of each tag


@dataclass(frozen=True)
class Schema:
    """Columns of a table, and how it holds its loops: `by` is the column that tells them."""

    names: tuple[str, ...]
    kind: Kind = Kind.COLUMNS
    by: str = ""


def schema_of(names: Sequence[str]) -> Schema:
    """Kind of a table by its columns.

    Examples
    --------
    >>> schema_of(["Time", "Tag", "Value"]).kind, schema_of(["tag", "time", "OP", "PV"]).by
    (<Kind.LONG: 'long'>, 'tag')
    """
    return _schema(tuple(names))


@lru_cache(maxsize=4096)
def _schema(names: tuple[str, ...]) -> Schema:
    """The same for all files of one export."""
    table = Table(nw.from_native(pl.DataFrame(schema=dict.fromkeys(names, pl.Float32)), eager_only=True), "")
    tag, value = called(table, "tag"), called(table, "value")
    by = tag or next((name for name in names if key(name) in LOOP_KEYS), "")
    rest = [name for name in names if name != by]
    if by and all(usual(role, rest, tags=False) for role in ("op", "pv")):
        return Schema(names, Kind.ROWS, by)
    if tag and value and usual("time", [name for name in rest if name != value]):
        return Schema(names, Kind.LONG, tag)
    return Schema(names)


def schema_at(path: Path) -> Schema:
    """Kind of the table that a file is a piece of, with the keys of its partitions where these name tags.

    Raises
    ------
    DataError
        It is damaged.
    """
    schema = schema_of(names_in(path))
    keyed = schema_of([*schema.names, *(key for key in _keys(path) if key not in schema.names)])
    return keyed if schema.kind is Kind.COLUMNS and keyed.kind is Kind.LONG else schema


def is_parquet(path: Path) -> bool:
    """Whether a file is Parquet, by its first bytes."""
    try:
        with path.open("rb") as stream:
            return stream.read(4) == b"PAR1"
    except OSError:
        return False


def names_in(path: Path) -> tuple[str, ...]:
    """Columns of a file.

    Raises
    ------
    DataError
        It is damaged.
    """
    try:
        return tuple(pl.read_parquet_schema(path))
    except (pl.exceptions.PolarsError, OSError) as error:
        raise _damaged(path, error) from error


def values_in(files: Sequence[Path], column: str) -> tuple[str, ...]:
    """Different values of a column, in the order of the first rows.

    Row groups that say in their statistics that they hold one value are not read, where PyArrow is there to tell.
    """
    left: list[Path] = []
    found: dict[str, None] = {}
    for path in files:
        stated = _stated(path, column)
        if stated is None:
            left.append(path)
        else:
            found |= dict.fromkeys(stated)
    if left:
        try:
            column_of = _scan(left).select(pl.col(column).cast(pl.String).drop_nulls().unique(maintain_order=True))
            found |= dict.fromkeys(column_of.collect()[column].to_list())
        except (pl.exceptions.PolarsError, OSError) as error:
            raise _damaged(left[0], error) from error
    return tuple(found)


def _stated(path: Path, column: str) -> list[str] | None:
    """Value of each row group by the statistics; None: they do not tell."""
    try:
        from pyarrow import parquet  # noqa: PLC0415  optional, and slow to import
    except ImportError:
        return None
    try:
        data = parquet.read_metadata(path)
        place = data.schema.names.index(column)
        stated = [data.row_group(group).column(place).statistics for group in range(data.num_row_groups)]
    except (OSError, ValueError):  # damaged, or a partition's key
        return None
    if any(one is None or not one.has_min_max or one.min != one.max or one.null_count for one in stated):
        return None
    return [str(one.min) for one in stated if one is not None]


def table_of(
    files: Sequence[Path],
    tags: Collection[str],
    columns: Collection[str],
    by_tag: str = "",
    period: Period = ALWAYS,
) -> Table:
    """What one loop needs.

    Parameters
    ----------
    files : sequence of Path
        Pieces of one table.
    tags : collection of str
        Of a LONG table: those of the loop.
    columns : collection of str
        Of a table of COLUMNS: those of the loop; empty: all.
    by_tag : str
        Of a table of ROWS: the loop.
    period : Period
        All rows are read where those of the period alone could give another record.

    Raises
    ------
    DataError
        Damaged, or without rows.
    """
    schema = schema_at(files[0])
    try:
        frame = _rows(files, schema, tags, columns, by_tag, period)
    except (pl.exceptions.PolarsError, OSError) as error:
        raise _damaged(files[0], error) from error
    if frame.is_empty():
        what = f" of {by_tag or ', '.join(tags)}" if by_tag or tags else ""
        raise DataError.expected(f"rows{what}", f"none in {files[0].name!r}", "check the export")
    note = (f"Joined from {len(files)} Parquet files: {files[0].name} to {files[-1].name}.",) if len(files) > 1 else ()
    return Table(nw.from_native(frame, eager_only=True), files[0].name, notes=note)


def _rows(
    files: Sequence[Path], schema: Schema, tags: Collection[str], columns: Collection[str], by_tag: str, period: Period
) -> pl.DataFrame:
    scan = _scan(files)
    if schema.kind is Kind.LONG:
        return scan.filter(pl.col(schema.by).is_in(list(tags))).collect() if tags else scan.collect()
    if schema.kind is Kind.ROWS and by_tag:
        mine = scan.filter(pl.col(schema.by) == by_tag).drop(schema.by)
        return _of_period(mine, [name for name in schema.names if name != schema.by], period)
    dates = [] if usual("time", schema.names) else [name for name in _keys(files[0]) if name.lower() in DATE_KEYS]
    kept = needed(schema.names, columns) if columns else schema.names
    own = [*kept, *(name for name in dates if name not in kept)]
    return _of_period(scan.select(own), own, period)


def _of_period(scan: pl.LazyFrame, names: Sequence[str], period: Period) -> pl.DataFrame:
    found = period.of(scan, names)
    return scan.collect() if found is None else found


def needed(names: Sequence[str], columns: Collection[str]) -> tuple[str, ...]:
    """Columns that reading a loop may look at: its own, and those that are of no other loop.

    Examples
    --------
    >>> wide = ["time", *(f"FIC{n}.{role}" for n in range(9) for role in ("PV", "OUT", "SP"))]
    >>> needed(wide, ["FIC3.PV", "FIC3.OUT", "FIC3.SP"])
    ('time', 'FIC3.PV', 'FIC3.OUT', 'FIC3.SP')
    """
    if len(names) <= MOST_READ:
        return tuple(names)
    others = {name for roles in loops_of(names).values() for name in roles.values()}
    return tuple(name for name in names if name in columns or (name not in others and isa(name) is None))


def _scan(files: Sequence[Path]) -> pl.LazyFrame:
    keyed = any("=" in part for part in files[0].parts[:-1])
    return pl.scan_parquet([str(path) for path in files], hive_partitioning=keyed, glob=False)


def _keys(piece: Path) -> list[str]:
    return [part.split("=", 1)[0] for part in piece.parts[:-1] if "=" in part]


def _damaged(path: Path, error: Exception) -> DataError:
    said = str(error).strip().split("\n", maxsplit=1)[0]
    return DataError.expected("a whole Parquet file", f"a damaged one, {str(path)!r} ({said})", "export it again")
