"""Connections to a store: an SQLite file by default, PostgreSQL by its address; a new store is made at the door."""

from __future__ import annotations

import os
import sys
import time
from contextlib import closing
from pathlib import Path
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import URL, Connection, Engine, make_url
from sqlalchemy.exc import ArgumentError, OperationalError, SQLAlchemyError

from lostmotion.addresses import is_url
from lostmotion.errors import ParameterError
from lostmotion.extras import extra
from lostmotion.files.folders import make, nearest
from lostmotion.files.paths import is_file, is_folder
from lostmotion.files.postgres import limit_answers
from lostmotion.store.said import damaged, explained, store_error, told
from lostmotion.store.schema import VERSION, metadata, schema_version

PATIENCE = 30.0  # s in which a server may come up, and in which a lock of SQLite may go
FIRST_WAIT = 0.25  # s before the second try; doubled after each
HOPELESS = ("authentication failed", "does not exist", "no password supplied", "could not translate host name")
LOCK = 0x6C6F7374  # of PostgreSQL's advisory locks: one coordinator at a time begins a run or makes the tables
DRIVERS = {"sqlite": "sqlite", "postgresql": "postgresql+psycopg", "postgres": "postgresql+psycopg"}


def connected(address: str | os.PathLike[str], *, write: bool = True, patience: float = PATIENCE) -> Engine:
    """Connections to a store whose tables are there and of this version.

    Parameters
    ----------
    address : str or path
        A file, ``sqlite:///plant.db`` or ``postgresql://user@host/plant``.
    write : bool
        Make it if it is not there. Without: it must be there, and is not changed.
    patience : float
        Seconds in which a server may come up, and for which a lock is waited for.

    Raises
    ------
    FileAccessError
        No store, one of another version (the message names the command that upgrades it), none that can be opened.
    ParameterError
        An address of another database.
    DataError
        Driver or SQLAlchemy's parts are not installed.
    """
    name = shown(store_url(address))
    engine = connected_as_it_is(address, write=write, patience=patience)
    try:
        with told(name):
            if write:
                _make(engine, name)
            version = _version(engine, name)
        check_version(name, version)
    except BaseException:
        engine.dispose()
        raise
    return engine


def connected_as_it_is(address: str | os.PathLike[str], *, write: bool = True, patience: float = PATIENCE) -> Engine:
    """Connections to a database, whatever its tables are; settings and errors as of :func:`connected`."""
    url = store_url(address)
    engine = _engine(url, shown(url), write=write, patience=patience)
    try:
        _first_connection(engine, shown(url), patience)
    except BaseException:
        engine.dispose()
        raise
    return engine


def store_url(address: str | os.PathLike[str]) -> URL:
    """Address with the driver that is used.

    Examples
    --------
    >>> str(store_url("plant.db")), str(store_url("postgres://me@host/plant"))
    ('sqlite:///plant.db', 'postgresql+psycopg://me@host/plant')
    """
    text = os.fspath(address)
    if not is_url(text):
        return URL.create("sqlite", database=text)
    try:
        url = make_url(text)
    except (ArgumentError, ValueError):  # a ValueError: a port that is no number
        url = URL.create("unknown")
    kind = url.drivername.partition("+")[0]
    if kind not in DRIVERS or (kind == "sqlite" and not url.database):
        raise ParameterError.expected(
            "a file, sqlite:///FILE or postgresql://..", f"{kind}://", "give the address of one of these as the store"
        )
    return url.set(drivername=DRIVERS[kind])


def shown(url: URL) -> str:
    """Name of a store for messages: a path, or the address without its password."""
    return str(url.database) if url.drivername == "sqlite" else url.render_as_string(hide_password=True)


def _engine(url: URL, name: str, *, write: bool, patience: float) -> Engine:
    if url.drivername == "sqlite":
        _need_path(url, name, write=write)
        settings: dict[str, Any] = {"connect_args": {"timeout": patience, "isolation_level": None}}
        url = url if write or "uri" in url.query else _reading(url)
    else:
        settings = {"pool_pre_ping": True}
    with extra("postgres"):
        engine = sa.create_engine(url, **settings)
    limit_answers(engine)
    if engine.dialect.name == "sqlite":
        sa.event.listen(engine, "connect", _pragmas if write else _reading_pragmas)
        sa.event.listen(engine, "begin", _begin)
    return engine


def _need_path(url: URL, name: str, *, write: bool) -> None:
    if "uri" in url.query:
        return
    path = Path(str(url.database))
    if is_folder(path):
        raise store_error(name, "a folder", "give the name of a file")
    if not write and not is_file(path):
        error = store_error(name, "no such file", "check the name, or let an audit make it")
        raise error from FileNotFoundError(name)
    if write:
        _make_folder(path, name)


def _make_folder(path: Path, name: str) -> None:
    above = nearest(path.parent)
    if not is_folder(above):
        raise store_error(name, f"the file {above} in its path", "choose another path")
    longest = _longest_name(above) - len("-journal")
    if len(os.fsencode(path.name)) > longest:
        remedy = f"give one of at most {longest}: SQLite puts files with longer names beside it"
        raise store_error(name, f"a name of {len(os.fsencode(path.name))} bytes", remedy)
    try:
        make(path.parent)
    except OSError as error:
        reason = error.strerror or str(error)
        raise store_error(name, f"{reason!r} for its folder", "choose another path") from error


def _longest_name(folder: Path) -> int:
    """Bytes that a name may have in a folder."""
    if sys.platform == "win32":
        return 255  # everywhere
    try:
        return os.pathconf(folder, "PC_NAME_MAX")
    except (OSError, ValueError):
        return 255


def _reading(url: URL) -> URL:
    """Address of a file that is only read; without a journal beside it, also where nothing may be written."""
    path = Path(str(url.database)).absolute()
    still = not os.access(path.parent, os.W_OK) and not path.with_name(f"{path.name}-wal").exists()
    query = {"mode": "ro", "uri": "true"} | ({"immutable": "1"} if still else {})
    return url.set(database=path.as_uri(), query=query)


def _pragmas(connection: Any, _: Any) -> None:
    """A writer-ahead log, so that pages read while an audit writes; durable at its checkpoints, whole always."""
    with closing(connection.cursor()) as cursor:
        cursor.execute("PRAGMA journal_mode=WAL")
        cursor.execute("PRAGMA synchronous=NORMAL")
        cursor.execute("PRAGMA foreign_keys=ON")
    _reading_pragmas(connection, _)


def _reading_pragmas(connection: Any, _: Any) -> None:
    with closing(connection.cursor()) as cursor:
        cursor.execute("PRAGMA cache_size=-65536")  # KiB: the index of a page's run stays in memory; the usual is 2 MB


def _begin(connection: Connection) -> None:
    """The lock of a writer at once: one that comes later fails in the middle, and no waiting helps."""
    writing = connection.get_execution_options().get("writing", False)
    connection.exec_driver_sql("BEGIN IMMEDIATE" if writing else "BEGIN")


def _first_connection(engine: Engine, name: str, patience: float) -> None:
    """Wait for a server that is coming up; what waiting does not cure fails at once."""
    until, wait = time.monotonic() + patience, FIRST_WAIT
    while True:
        try:
            with engine.connect():
                return
        except OperationalError as error:
            hopeless = engine.dialect.name == "sqlite" or any(part in str(error) for part in HOPELESS)
            if hopeless or time.monotonic() + wait > until:
                raise explained(name, error) from None
        except SQLAlchemyError as error:
            raise explained(name, error) from None
        except UnicodeDecodeError:
            raise damaged(name) from None
        time.sleep(wait)
        wait *= 2.0


def lock(connection: Connection) -> None:
    """No other coordinator in this step until the transaction ends; SQLite has its one writer anyway."""
    if connection.dialect.name == "postgresql":
        connection.execute(sa.select(sa.func.pg_advisory_xact_lock(LOCK)))


def _make(engine: Engine, name: str) -> None:
    """Tables, where there are none yet."""
    with engine.connect().execution_options(writing=True) as connection:
        if sa.inspect(connection).has_table("schema_version"):
            return
        connection.rollback()
        with connection.begin():
            lock(connection)
            there = set(sa.inspect(connection).get_table_names())
            if "schema_version" in there:
                return
            ours = there if engine.dialect.name == "sqlite" else there & set(metadata.tables)
            if ours:
                raise _other(name, ours)
            metadata.create_all(connection)
            connection.execute(schema_version.insert().values(version_num=VERSION))


def _version(engine: Engine, name: str) -> str:
    with engine.connect() as connection:
        if not sa.inspect(connection).has_table("schema_version"):
            raise _other(name, set(sa.inspect(connection).get_table_names()))
        return str(connection.scalar(sa.select(schema_version.c.version_num)))


def _other(name: str, tables: set[str]) -> Exception:
    got = f"a database with other tables ({', '.join(sorted(tables)[:4])})" if tables else "a database without tables"
    return store_error(name, got, "give the store another name")


def check_version(name: str, version: str) -> None:
    """Refuse a store of another version.

    Raises
    ------
    FileAccessError
    """
    if version == VERSION:
        return
    if version.isdigit() and version < VERSION:
        remedy = f"make a copy of it, then: lostmotion audit --upgrade {name}"
        raise store_error(name, f"the older version {version}", remedy, f"version {VERSION} of the store")
    raise store_error(
        name,
        f"the newer version {version}",
        "update lostmotion, or give another store",
        f"version {VERSION} of the store",
    )
