"""A file -> the loops in it, from its name, its schema or its first rows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import narwhals.stable.v2 as nw
import polars as pl

from lostmotion.errors import DataError, LostMotionError
from lostmotion.files.columns import Columns, SeveralLoopsError, columns_of_loops, resolve
from lostmotion.files.dates import looks_like_a_time, looks_numeric
from lostmotion.files.frames import PEEKED, peeked
from lostmotion.files.gathered import ENDINGS
from lostmotion.files.hints import likely
from lostmotion.files.moments import with_moments
from lostmotion.files.number_cells import is_text, text_cells
from lostmotion.files.one_tag import one_tag
from lostmotion.files.opened import MOST_COLUMNS, Opened, opened
from lostmotion.files.table import Table
from lostmotion.files.tags import loops_of
from lostmotion.plant.loop_list import is_loop_list
from lostmotion.plant.parquet import Kind, is_parquet, names_in, schema_of, values_in
from lostmotion.plant.unit import Found, Unit

ROLES = ("op", "pv", "sp", "position", "mode")
FEW = 1 << 14  # bytes of a text that mostly show its columns
TEXTS = ("readme", "license", "licence", "copying", "changelog", "notes", "provenance")
NO_TABLE = "no table, by its name"
NO_SERIES = "a list of things, not of moments: its rows have names"
LOOP_LIST = "a list of loops"
NOT_TWO = "no loop: a table of tags and values without OP and PV of one loop"


def contents_of(path: Path, reading: Mapping[str, Any]) -> Unit:
    """What one file holds; errors are told in the unit.

    Parameters
    ----------
    path : Path
    reading : mapping
        Settings of :func:`lostmotion.read_loop` for all loops alike; of them the columns count here.
    """
    if path.suffix.lower() not in ENDINGS or path.name.lower().startswith(TEXTS):
        return Unit((path,), why=NO_TABLE)
    try:
        return parquet_unit((path,), reading) if is_parquet(path) else _unit(path, reading)
    except SeveralLoopsError as error:
        return Unit((path,), tuple(Found(name, name) for name in error.loops))
    except (LostMotionError, OSError) as error:  # it may be gone again
        return Unit((path,), why=one_line(error), failed=True)


def parquet_unit(files: Sequence[Path], reading: Mapping[str, Any]) -> Unit:
    """What Parquet holds, without its rows.

    Raises
    ------
    DataError
        It is damaged.
    """
    schema = schema_of(names_in(files[0]))
    if schema.kind is Kind.COLUMNS:
        loops, why = _of_names(schema.names, _asked(reading))
        if why and len(schema.names) <= MOST_COLUMNS:
            first = _checked_rows(files[0])
            one = one_tag(first)
            if one is not None:
                return Unit(tuple(files), names=schema.names, one_tag=one)
            if listing(first):
                return Unit(tuple(files), names=schema.names, why=NO_SERIES)
        return Unit(tuple(files), loops, schema.names, why, failed=bool(why))
    values = values_in(files, schema.by)
    if schema.kind is Kind.LONG and len(values) == 1 and (one := one_tag(_checked_rows(files[0]))) is not None:
        return Unit(tuple(files), names=schema.names, one_tag=one)
    if schema.kind is Kind.ROWS:
        columns = dict(_columns(tuple(name for name in schema.names if name != schema.by), _asked(reading)))
        return Unit(tuple(files), tuple(Found(one, one, columns) for one in values), schema.names)
    loops = of_tags(values)
    return Unit(tuple(files), loops, values, "" if loops else NOT_TWO, failed=not loops)


def of_tags(tags: Sequence[str]) -> tuple[Found, ...]:
    """Loops whose OP and PV are both among the tags of a table of tags and values."""
    return tuple(Found(tag, tag, roles) for tag, roles in loops_of(tags).items())


def _checked_rows(path: Path) -> Table:
    try:
        return Table(nw.from_native(pl.read_parquet(path, n_rows=50), eager_only=True), path.name)
    except (pl.exceptions.PolarsError, OSError) as error:
        raise DataError.expected("a whole Parquet file", f"a damaged one, {path.name!r}", "export it again") from error


def _unit(path: Path, reading: Mapping[str, Any]) -> Unit:
    table = first_rows(path)
    if is_loop_list(table.names):
        return Unit((path,), names=tuple(table.names), why=LOOP_LIST)
    schema = schema_of(table.names)
    if schema.kind is not Kind.COLUMNS:
        return _rows_unit(path, reading)
    if len(table.names) <= MOST_COLUMNS and (one := one_tag(table)) is not None:
        return Unit((path,), names=tuple(table.names), one_tag=one)
    names = tuple(with_moments(table).names)
    loops, why = _of_names(names, _asked(reading))
    if why and listing(table):
        return Unit((path,), names=names, why=NO_SERIES)
    return Unit((path,), loops, names, why, failed=bool(why))


def _rows_unit(path: Path, reading: Mapping[str, Any]) -> Unit:
    """A text with loops or tags below each other is read whole: only all its rows tell them."""
    content = in_rows(opened(path))
    names = tuple(next(iter(content.tables.values())).names)
    if "" not in content.tables:
        columns = dict(_columns(names, _asked(reading)))
        return Unit((path,), tuple(Found(name, name, columns) for name in content.tables), names)
    table = content.tables[""]
    if (one := one_tag(table)) is not None:
        return Unit((path,), names=names, one_tag=one)
    tags = tuple(dict.fromkeys(text_cells(table.column(schema_of(names).by)).drop_nulls().to_list()))
    loops = of_tags(tags)
    return Unit((path,), loops, tags, "" if loops else NOT_TWO, failed=not loops)


def in_rows(content: Opened) -> Opened:
    """A table with OP and PV of many loops below each other, cut into one for each; any other as it is."""
    table = content.tables.get("")
    schema = None if table is None else schema_of(table.names)
    if table is None or schema is None or schema.kind is not Kind.ROWS:
        return content
    cells = text_cells(table.column(schema.by))
    places = pl.DataFrame({"by": cells, "row": range(len(cells))}).drop_nulls()
    rows = places.group_by("by", maintain_order=True).agg("row")
    return Opened({str(by): table.taken(part.to_numpy()) for by, part in zip(rows["by"], rows["row"], strict=True)})


def first_rows(path: Path) -> Table:
    """Few rows where they tell enough, else more."""
    if path.stat().st_size > PEEKED:
        try:
            table = peeked(path, FEW)
            if len(table.frame) > 1:
                return table
        except LostMotionError:
            pass  # a long preamble, or many columns
    return peeked(path)


def loops_by_names(
    names: tuple[str, ...], reading: Mapping[str, Any] | Sequence[tuple[str, Any]]
) -> tuple[tuple[Found, ...], str]:
    """Loops by the names of columns, or why there are none."""
    return _of_names(names, _asked(dict(reading)))


def _asked(reading: Mapping[str, Any]) -> tuple[tuple[str, Any], ...]:
    """Settings that name columns."""
    return tuple((role, reading[role]) for role in (*ROLES, "time") if role in reading)


@lru_cache(maxsize=4096)
def _of_names(names: tuple[str, ...], asked: tuple[tuple[str, Any], ...]) -> tuple[tuple[Found, ...], str]:
    """Loops by the names of columns, or why there are none."""
    try:
        columns = _columns(names, asked)
    except SeveralLoopsError:
        found = columns_of_loops(names, **dict(asked))
        return tuple(Found(tag, tag, dict(_by_role(one))) for tag, one in found.items()), ""
    except DataError as error:
        return (), one_line(error)
    by_columns = _one_of(dict(columns)) if not {"op", "pv"} & dict(asked).keys() else ""
    return (Found("", by_columns, dict(columns)),), ""


@lru_cache(maxsize=4096)
def _columns(names: tuple[str, ...], asked: tuple[tuple[str, Any], ...]) -> tuple[tuple[str, str], ...]:
    """Column of each role; the same for all files of one export."""
    try:
        found = resolve(names, **dict(asked))
    except SeveralLoopsError:
        raise
    except DataError as error:
        ways = likely(names, {})
        if ways and not error.ways:
            raise error.leads_on(*ways) from None
        raise
    return _by_role(found)


def _by_role(found: Columns) -> tuple[tuple[str, str], ...]:
    return tuple((role, name) for role in ROLES if (name := getattr(found, role)) is not None)


def _one_of(columns: Mapping[str, str]) -> str:
    """Tag that OP and PV share by their names."""
    return next(iter(loops_of([columns["op"], columns["pv"]])), "")


def one_line(error: Exception) -> str:
    """Message of an error, with the columns that may be meant."""
    said = " ".join(str(error).split())
    ways = getattr(error, "ways", ())
    pairs = [way for way in ways if {"op", "pv"} <= set(way)]
    if not pairs:
        return said
    shown = " or ".join(f"op={way['op']}, pv={way['pv']}" for way in pairs[:1])
    return f"{said} (perhaps {shown}: write it into a loop list)"


def listing(table: Table) -> bool:
    """Whether the rows of a table are things with names of their own (labels, results, loops), not moments."""
    for name in table.names[:2]:
        series = table.column(name)
        if not is_text(series):
            continue
        cells = [cell for cell in text_cells(series).drop_nulls().to_list() if cell.strip()]
        plain = [cell for cell in cells if not looks_numeric(cell) and not looks_like_a_time(cell)]
        if cells and len(plain) == len(cells) == len(set(cells)):
            return True
    return False
