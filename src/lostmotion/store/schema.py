"""Tables of the store. What stands in a row of :mod:`lostmotion.store.rows` has a column of the same name."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any

from sqlalchemy import (
    BigInteger,
    Boolean,
    Column,
    ColumnElement,
    DateTime,
    Dialect,
    Double,
    ForeignKey,
    FromClause,
    Index,
    Integer,
    LargeBinary,
    MetaData,
    Table,
    Text,
    TypeDecorator,
    case,
    func,
)
from sqlalchemy.types import TypeEngine

from lostmotion.store.changed import New
from lostmotion.store.encoded import coded, utc
from lostmotion.store.rows import AssessmentRow, EstimateRow, GroupRow, SpectrumRow, Stage, TraceRow
from lostmotion.store.run_rows import LoopRow, ReviewRow, RunRow, UnreadRow, WatchRow

VERSION = "0005"  # of the schema: the last of migrations/versions


class Utc(TypeDecorator[datetime]):
    """A moment in UTC, whatever the database has; one without a zone is refused."""

    impl = DateTime(timezone=True)
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """SQLite keeps it as a text without a zone."""
        if value is None:
            return None
        moment = utc(value)
        return moment.replace(tzinfo=None) if dialect.name == "sqlite" else moment

    def process_result_value(self, value: datetime | None, dialect: Dialect) -> datetime | None:  # noqa: ARG002
        """With its zone, whatever the session's is."""
        if value is None:
            return None
        return value.replace(tzinfo=UTC) if value.tzinfo is None else value.astimezone(UTC)


WORDS = Text().with_variant(Text(collation="C"), "postgresql")  # the order of SQLite: by code point
TYPES: dict[str, TypeEngine[Any]] = {
    "text": WORDS, "json": Text(), "float": Double(), "int": BigInteger(), "bool": Boolean(), "moment": Utc(),
    "bytes": LargeBinary(),
}  # fmt: skip

PAGE = (  # what tables are filtered and sorted by: read from a narrow index, a row is 2 kB
    "verdict", "rule", "severity", "label", "split", "stage", "kind", "performance", "priority", "size",
    "size_percent", "excluded_percent", "confidence", "probability", "manual", "limited", "missing", "travel",
    "reversals", "variability", "harris", "period", "regularity", "power", "value",
)  # fmt: skip

metadata = MetaData()


def _columns(row: type[Any], *apart: str) -> list[Column[Any]]:
    return [Column(one.column, TYPES[one.kind], nullable=one.optional) for one in coded(row) if one.name not in apart]


def _id() -> Column[Any]:
    """Numbers are given by the coordinator: the same in every database."""
    return Column("id", Integer, primary_key=True, autoincrement=False)


def _key(name: str, table: str, *, key: bool = True, optional: bool = False) -> Column[Any]:
    return Column(name, Integer, ForeignKey(f"{table}.id"), primary_key=key, nullable=optional, autoincrement=False)


def _window() -> list[Column[Any]]:
    """What an assessment is known by."""
    return [_key("run_id", "run"), _key("loop_id", "loop"), Column("window_start", Utc(), primary_key=True)]


schema_version = Table("schema_version", metadata, Column("version_num", Text, primary_key=True))
loop = Table(
    "loop",
    metadata,
    _id(),
    *_columns(LoopRow),
    Column("search", WORDS, nullable=False),  # tag, area and names without upper case, for the search of pages
    Index("loop_tag", "tag", unique=True),
)
run = Table(
    "run",
    metadata,
    _id(),
    *_columns(RunRow, "number"),
    Column("coordinator", WORDS, nullable=False),  # host, process, and a number that no other has
)
assessment = Table(
    "assessment",
    metadata,
    *_window(),
    *_columns(AssessmentRow, "tag", "window_start", "rule"),
    _key("screened_in", "run", key=False, optional=True),  # the run that made it, and in which the spectrum lies
    _key("assessed_in", "run", key=False, optional=True),  # .. and the trace
    Column("newest", Boolean, nullable=False),  # whether it is the last window of its loop in the run
    Column("rule", WORDS, nullable=False, server_default=""),  # where an upgrade puts it
    Index("assessment_loop", "loop_id", "run_id"),
    Index("assessment_priority", "run_id", "priority"),
    Index("assessment_page", "run_id", "newest", "loop_id", "window_start", *PAGE),
)


def said(of: FromClause) -> ColumnElement[str]:
    """What is said of a loop, as :attr:`lostmotion.store.rows.AssessmentRow.said` has it; all of it in the index."""
    diagnosed = case((of.c.stage == Stage.ASSESSED, of.c.verdict), (of.c.stage == Stage.FAILED, "failed"))
    return case((of.c.rule != "", of.c.rule), else_=func.coalesce(diagnosed, "not assessed"))


spectrum = Table("spectrum", metadata, *_window(), *_columns(SpectrumRow, "tag", "window_start"))
trace = Table("trace", metadata, *_window(), *_columns(TraceRow, "tag", "window_start"))
unread = Table(
    "unread",
    metadata,
    _key("run_id", "run"),
    Column("number", Integer, primary_key=True, autoincrement=False),  # in the order of the source
    *_columns(UnreadRow),
)
oscillation_group = Table(
    "oscillation_group",
    metadata,
    _key("run_id", "run"),
    Column("number", Integer, primary_key=True, autoincrement=False),
    *_columns(GroupRow, "number", "members"),
)
member = Table(
    "member",
    metadata,
    _key("run_id", "run"),
    Column("number", Integer, primary_key=True, autoincrement=False),  # of the group
    Column("place", Integer, primary_key=True, autoincrement=False),  # in the group, from 1
    _key("loop_id", "loop", key=False),
    Column("window_start", Utc(), nullable=False),
    Column("likeness", Double(), nullable=False),
    Column("score", Double(), nullable=False),
    Index("member_loop", "loop_id", "run_id"),
)
review = Table(
    "review",
    metadata,
    _id(),
    _key("loop_id", "loop", key=False),
    *_columns(ReviewRow, "tag"),
    Index("review_loop", "loop_id", "id"),
)
watch = Table(
    "watch",
    metadata,
    _id(),
    *_columns(WatchRow, "number"),
    Column("coordinator", WORDS, nullable=False),
)
estimate = Table(
    "estimate",
    metadata,
    _key("watch_id", "watch"),
    _key("loop_id", "loop"),
    Column("at", Utc(), primary_key=True),
    *_columns(EstimateRow, "tag", "at"),
    Index("estimate_loop", "loop_id", "at"),
)
comparison = Table(
    "comparison",
    metadata,
    _key("run_id", "run"),  # what is new in it was written down when it ended
    _key("earlier_id", "run", key=False),  # .. since this one
)
change = Table(
    "change",
    metadata,
    _key("run_id", "run"),
    Column("place", Integer, primary_key=True, autoincrement=False),  # from 1, what matters most first
    _key("loop_id", "loop", key=False),
    *_columns(New, "tag"),
)
