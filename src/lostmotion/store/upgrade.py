"""An older store is brought to the version of this package."""

from __future__ import annotations

import os
from pathlib import Path

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from lostmotion.extras import extra
from lostmotion.store.connect import connected_as_it_is, lock, shown, store_url
from lostmotion.store.said import store_error, told
from lostmotion.store.schema import VERSION, schema_version


def upgrade(address: str | os.PathLike[str], version: str = VERSION) -> tuple[str, str]:
    """Bring the tables of a store to the version of this package; all of it, or nothing.

    Returns
    -------
    (str, str)
        Version before and after.

    Raises
    ------
    FileAccessError
        No store, a newer one, or none that can be written.
    DataError
        Alembic is not installed.
    """
    name = shown(store_url(address))
    connected_as_it_is(address, write=False).dispose()  # one that is not there is refused, and not made
    engine = connected_as_it_is(address)
    try:
        with told(name), engine.connect().execution_options(writing=True) as connection, connection.begin():
            lock(connection)
            if not sa.inspect(connection).has_table("schema_version"):
                raise store_error(name, "a database that is none", "check the name")
            before = str(connection.scalar(sa.select(schema_version.c.version_num)))
            if not before.isdigit() or before > VERSION:
                raise store_error(name, f"the newer version {before}", "update lostmotion")
            if before < version:
                migrate(connection, version)
            return before, max(before, version)
    finally:
        engine.dispose()


def migrate(connection: Connection, version: str = VERSION) -> None:
    """Run the migrations up to a version in the transaction of a connection.

    Raises
    ------
    DataError
        Alembic is not installed.
    """
    with extra("audit"):
        from alembic import command  # noqa: PLC0415  only an upgrade needs it
        from alembic.config import Config  # noqa: PLC0415
    config = Config()
    config.set_main_option("script_location", str(Path(__file__).with_name("migrations")).replace("%", "%%"))
    config.set_main_option("path_separator", "os")
    config.attributes["connection"] = connection
    command.upgrade(config, version)
