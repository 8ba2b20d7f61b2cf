"""DatabaseSource: the loops of an SQL query."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any

from lostmotion.addresses import absolute, without_password
from lostmotion.errors import LostMotionError
from lostmotion.files.database import database_name, read_query
from lostmotion.files.number_cells import text_cells
from lostmotion.files.opened import Opened
from lostmotion.files.tags import loop_type, loops_of
from lostmotion.plant.contents import loops_by_names, of_tags
from lostmotion.plant.loop import PlantLoop
from lostmotion.plant.parquet import Kind, Schema, needed, schema_of
from lostmotion.plant.reading import Reading, between, checked_range, record_of, tried
from lostmotion.plant.source import Unread
from lostmotion.plant.unit import Found
from lostmotion.records.record import LoopRecord

FIRST = 20  # rows by which the columns are told


@dataclass(frozen=True)
class DatabaseSource:
    """Loops of the rows of a query: columns of each loop, loops below each other, or a row for each value of each tag.

    Parameters
    ----------
    url : str
        As SQLAlchemy has it, or the path of an SQLite file.
    query : str or None
        In the SQL of the database. What is read of one loop is chosen from it by the database.
    reading : tuple of (str, value)
        Settings of :func:`lostmotion.read_loop` for all loops alike.
    """

    url: str = field(repr=False)
    query: str | None
    reading: Reading = ()

    def __reduce__(self) -> tuple[Any, ...]:
        return DatabaseSource, (absolute(self.url), self.query, self.reading)  # workers have another working folder

    def loops(self) -> tuple[PlantLoop, ...]:
        """All loops of the query.

        Raises
        ------
        DataError, FileAccessError
            As in :func:`lostmotion.files.database.read_query`.
        """
        return tuple(_plant_loop(one) for one in self._found()[0])

    def unread(self) -> tuple[Unread, ...]:
        """The query, where its columns show no loop."""
        loops, why = self._found()
        return () if loops else (Unread(without_password(self.url), why or "no tags of OP and PV of one loop"),)

    def read(
        self, loops: Sequence[PlantLoop], since: datetime | None = None, until: datetime | None = None
    ) -> Iterator[tuple[PlantLoop, LoopRecord | LostMotionError]]:
        """Record of each loop, by a query of its own; see :class:`lostmotion.plant.PlantSource`."""
        checked_range(since, until)
        schema: Schema | None = None
        for loop in loops:
            try:
                schema = schema or self._schema()
                yield loop, between(self._record(loop, schema), since, until)
            except (LostMotionError, MemoryError) as error:
                yield loop, tried(error, loop)

    def holding(self, columns: Collection[str]) -> str:
        """Address of a loop whose columns or tags are all there: the loop is alone in what is read of it."""
        schema = self._schema()
        there = self._values(schema) if schema.kind is Kind.LONG else schema.names
        return "*" if columns and set(columns) <= set(there) else ""

    def _found(self) -> tuple[tuple[Found, ...], str]:
        schema = self._schema()
        if schema.kind is Kind.COLUMNS:
            return loops_by_names(schema.names, self.reading)
        if schema.kind is Kind.LONG:
            return of_tags(self._values(schema)), ""
        rest = tuple(name for name in schema.names if name != schema.by)
        columns, why = loops_by_names(rest, self.reading)
        return tuple(Found(tag, tag, columns[0].columns) for tag in self._values(schema)) if columns else (), why

    def _schema(self) -> Schema:
        if self.query is None:
            read_query(self.url, None)  # says which tables there are
        return schema_of(read_query(self.url, f"SELECT * FROM ({self._inner}) AS rows_of_plant LIMIT {FIRST}").names)  # noqa: S608

    def _values(self, schema: Schema) -> tuple[str, ...]:
        asked = f"SELECT DISTINCT {_name(schema.by)} FROM ({self._inner}) AS rows_of_plant ORDER BY 1"  # noqa: S608
        cells = text_cells(read_query(self.url, asked).column(schema.by))
        return tuple(str(cell) for cell in cells.drop_nulls().to_list())

    @property
    def _inner(self) -> str:
        return str(self.query).strip().rstrip(";")

    def _record(self, loop: PlantLoop, schema: Schema) -> LoopRecord:
        own = [name for name in (loop.op, loop.pv, loop.sp, loop.mode) if name]
        name = "" if loop.where == "*" else loop.where
        columns, where = "*", ""
        if schema.kind is Kind.LONG:
            tags = own or list(loops_of(self._values(schema)).get(name, {}).values())
            where = f" WHERE {_name(schema.by)} IN ({', '.join(_text(tag) for tag in tags)})"
        elif schema.kind is Kind.ROWS:
            columns = ", ".join(_name(one) for one in schema.names if one != schema.by)
            where = f" WHERE {_name(schema.by)} = {_text(name or loop.tag)}"
            name = ""
        else:
            columns = ", ".join(_name(one) for one in (needed(schema.names, own) if own else schema.names))
        table = read_query(self.url, f"SELECT {columns} FROM ({self._inner}) AS rows_of_plant{where}")  # noqa: S608
        return record_of(Opened({"": table}, database_name(self.url)), loop, name, self.reading)


def _name(column: str) -> str:
    return '"' + column.replace('"', '""') + '"'


def _text(value: str) -> str:
    return "'" + value.replace("'", "''") + "'"


def _plant_loop(found: Found) -> PlantLoop:
    columns: dict[str, Any] = dict(found.columns)
    kind = loop_type(found.tag)
    notes = (f"Type {kind!r} by the first letter of the tag.",) if kind else ()
    return PlantLoop(
        found.tag or "loop",
        columns.get("op", ""),
        columns.get("pv", ""),
        columns.get("sp", ""),
        columns.get("mode", ""),
        kind,
        where=found.name or "*",
        notes=notes,
    )
