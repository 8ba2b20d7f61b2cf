"""A query of a database -> Table: SQLite by itself, every other one by SQLAlchemy; no password is ever shown."""

from __future__ import annotations

import re
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import narwhals.stable.v2 as nw
import polars as pl

from lostmotion.addresses import is_url, password_of, without_password
from lostmotion.errors import DataError, FileAccessError
from lostmotion.extras import extra
from lostmotion.files.paths import is_file
from lostmotion.files.postgres import limit_answers
from lostmotion.files.table import Table

SQLITE = b"SQLite format 3\0"
_SQLITE_URL = re.compile(r"sqlite:///(?P<path>[^?]*)")
SHOWN = 6  # tables in a message


def read_query(source: str, query: str | None) -> Table:
    """Rows of a query.

    Parameters
    ----------
    source : str
        Address as SQLAlchemy has it (``postgresql+psycopg://user@host/plant``), or the path of an SQLite file.
    query : str or None
        In the SQL of the database.

    Raises
    ------
    DataError
        No query (the error names the tables), one that fails, or one without rows; no reader for this database.
    FileAccessError
        No such SQLite file.
    """
    name = without_password(source)
    try:
        with _connected(source) as connection:
            _need_query(query, connection, name)
            frame = pl.read_database(str(query), connection, infer_schema_length=None)
    except (DataError, FileAccessError):
        raise
    except Exception as error:  # noqa: BLE001  every driver has errors of its own
        reason = _said(error, source)
        raise DataError.expected(
            f"an answer of {name!r}", f"{type(error).__name__}: {reason}", "check the address and the query"
        ) from None  # the error of a driver may show the password
    if not isinstance(frame, pl.DataFrame) or frame.is_empty():
        raise DataError.expected(f"rows from {name!r}", "none", "check the query")
    return Table(nw.from_native(frame, eager_only=True), name)


def database_name(source: str) -> str:
    """Name of a database, for its records.

    Examples
    --------
    >>> database_name("sqlite:///data/plant.db"), database_name("postgresql://u:p@host/history?ssl=1")
    ('plant', 'history')
    """
    return Path(source.split("?", maxsplit=1)[0]).stem


@contextmanager
def _connected(source: str) -> Iterator[Any]:
    found = _SQLITE_URL.fullmatch(source.split("?", maxsplit=1)[0])
    if found or not is_url(source):
        path = Path(found["path"] if found else source)
        if not is_file(path):
            error = f"expected a database, got no such file {str(path)!r}; check the path"
            raise FileAccessError(error) from FileNotFoundError(str(path))
        with closing(sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro", uri=True)) as connection:
            yield connection
        return
    with extra("sql"):
        import sqlalchemy  # noqa: PLC0415  only databases other than SQLite need it
    try:
        engine = sqlalchemy.create_engine(source)
    except ImportError as error:
        raise DataError.expected(
            f"the driver of {without_password(source)!r}",
            f"{error.name or error}: not installed",
            "install it with pip",
        ) from None
    limit_answers(engine)
    with closing(engine.connect()) as connection:
        yield connection
    engine.dispose()


def _tables(connection: Any) -> list[str]:
    """Tables and views that a query may name."""
    if isinstance(connection, sqlite3.Connection):
        rows = connection.execute("SELECT name FROM sqlite_master WHERE type IN ('table', 'view') ORDER BY name")
        return [str(name) for (name,) in rows if not str(name).startswith("sqlite_")]
    import sqlalchemy  # noqa: PLC0415

    inspector = sqlalchemy.inspect(connection)
    return [*inspector.get_table_names(), *inspector.get_view_names()]


def _need_query(query: str | None, connection: Any, name: str) -> None:
    if query is not None:
        return
    tables = _tables(connection)
    more = f" and {len(tables) - SHOWN} more" if len(tables) > SHOWN else ""
    said = f"none; its tables are {', '.join(tables[:SHOWN])}{more}" if tables else "none, and no tables"
    error = DataError.expected(f"a query of {name!r}", said, "give query='SELECT ..'")
    raise error.leads_on(*({"query": f"SELECT * FROM {_quoted(table)}"} for table in tables))  # noqa: S608  of its own


def _quoted(table: str) -> str:
    return table if re.fullmatch(r"[a-z_][a-z0-9_]*", table) else '"' + table.replace('"', '""') + '"'


def _said(error: Exception, source: str) -> str:
    """First line of an error without the password."""
    text = without_password(str(error).strip().split("\n", maxsplit=1)[0]).replace(source, without_password(source))
    for secret in {password_of(source), unquote(password_of(source))} - {""}:
        text = text.replace(secret, "***")
    return text
