"""A PostgreSQL server that says nothing, nonsense, or never ends: one line within the stated time."""

import time

import pytest

from lostmotion.errors import DataError, FileAccessError
from lostmotion.files import postgres
from lostmotion.files.database import read_query
from lostmotion.files.limits import MOST_SECONDS
from lostmotion.store.connect import connected
from tests.support.hostile_postgres import PEERS, HostilePostgres

pytest.importorskip("psycopg")
pytest.importorskip("sqlalchemy")


def query(address):
    read_query(address.replace("postgresql:", "postgresql+psycopg:"), "select 1")


def store(address):
    connected(address, write=False, patience=0.5)


@pytest.mark.sampled(8)
@pytest.mark.parametrize("door", [store, query])
@pytest.mark.parametrize("kind", PEERS)
def test_a_hostile_server_ends_in_one_line(kind, door, monkeypatch):
    monkeypatch.setattr(postgres, "LOGIN", 2)
    monkeypatch.setenv(MOST_SECONDS, "0.1")
    began = time.monotonic()
    with HostilePostgres(kind) as server, pytest.raises((DataError, FileAccessError)) as refused:
        door(server.address)
    assert time.monotonic() - began < 10.0
    assert "\n" not in str(refused.value)
    assert "secret" not in str(refused.value)
    if "login" in kind and "mute" in kind:
        assert MOST_SECONDS in str(refused.value)
