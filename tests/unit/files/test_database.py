"""Records from databases: SQLite by itself, others by SQLAlchemy; passwords stay hidden."""

import shlex
import sqlite3
import sys

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import DataError, FileAccessError, InputError, ParameterError
from tests.e2e.test_commands import run

N = 120
OP = np.round(50 + 9 * np.sin(np.arange(N) / 7), 2)
PV = np.round(20 + 3 * np.cos(np.arange(N) / 7), 2)
WIDE = "SELECT time, op, pv FROM fic101 ORDER BY time"
LONG = "SELECT tag, time, value FROM \"All values\" WHERE tag LIKE 'FIC102%'"
SECRET = "s3cret/w@rd"


@pytest.fixture
def plant(tmp_path):
    path = tmp_path / "plant.db"
    with sqlite3.connect(path) as base:
        base.execute("CREATE TABLE fic101 (time TEXT, op REAL, pv REAL)")
        base.execute('CREATE TABLE "All values" (tag TEXT, time TEXT, value REAL)')
        times = [f"2024-03-14 08:{k // 60:02d}:{k % 60:02d}" for k in range(N)]
        base.executemany("INSERT INTO fic101 VALUES (?, ?, ?)", zip(times, OP.tolist(), PV.tolist(), strict=True))
        for tag, values in (("FIC102.OUT", OP), ("FIC102.PV", PV)):
            rows = [(tag, time, value) for time, value in zip(times, values.tolist(), strict=True)]
            base.executemany('INSERT INTO "All values" VALUES (?, ?, ?)', rows)
    base.close()
    return path


def sources(path):
    return (path, f"sqlite:///{path}")


def test_sqlite_by_path_and_by_address(plant):
    for source in sources(plant):
        record = lm.read_loop(source, query=WIDE)
        np.testing.assert_array_equal(record.op, OP)
        np.testing.assert_array_equal(record.pv, PV)
        assert (record.dt, record.tag) == (1.0, "plant")
        assert lm.read_loop(source, query=LONG, loop="FIC102").loop_type == "flow"
        assert list(lm.read_loops(source, query=WIDE)) == ["plant"]
    with pytest.raises(DataError):  # it is opened for reading only
        lm.read_loop(plant, query="DROP TABLE fic101")
    assert len(lm.read_loop(plant, query=WIDE)) == N


def test_by_sqlalchemy(plant):
    pytest.importorskip("sqlalchemy")
    address = f"sqlite+pysqlite:///{plant}"
    np.testing.assert_array_equal(lm.read_loop(address, query=WIDE).op, OP)
    with pytest.raises(DataError, match="its tables are All values, fic101"):
        lm.read_loop(address)
    with pytest.raises(DataError, match="OperationalError"):
        lm.read_loop(address, query="SELECT flow FROM nowhere")


def test_without_a_query_the_tables_are_named_by_commands_that_work(capsys, plant):
    for source in sources(plant):
        code, _, error = run(capsys, "check", source)
        assert code == 1
        assert "its tables are All values, fic101; give --query 'SELECT ..'" in error
        commands = [shlex.split(line)[1:] for line in error.splitlines() if line.startswith("    lostmotion")]
        assert [command[2:] for command in commands] == [
            ["--query", 'SELECT * FROM "All values"'],
            ["--query", "SELECT * FROM fic101"],
        ]
        for command in commands:
            assert run(capsys, *command)[2] == ""


def test_check_goes_on_with_the_query(capsys, plant):
    for source in sources(plant):
        code, text, error = run(capsys, "check", source, "--query", WIDE)
        assert (code, error) == (0, "")
        following = shlex.split(text.splitlines()[-1].removeprefix("Next: lostmotion diagnose"))
        assert following == [str(source), "--query", WIDE]
        assert run(capsys, "check", *following)[1] == text


def test_what_a_database_refuses(tmp_path, plant):
    with pytest.raises(FileAccessError, match="no such file"):
        lm.read_loop(f"sqlite:///{tmp_path}/other.db", query=WIDE)
    with pytest.raises(DataError, match="OperationalError: no such column: flow; check the address and the query"):
        lm.read_loop(plant, query="SELECT flow FROM fic101")
    with pytest.raises(DataError, match="rows from"):
        lm.read_loop(plant, query="SELECT * FROM fic101 WHERE op > 1000")
    (tmp_path / "a.csv").write_text("t_s,OP,PV\n0,1,2\n1,2,3\n")
    with pytest.raises(ParameterError, match="a query of a database only"):
        lm.read_loop(tmp_path / "a.csv", query=WIDE)


ADDRESSES = [f"nosuchdialect://reader:{SECRET}@host/plant", f"postgresql+psycopg2://reader:{SECRET}@127.0.0.1:1/plant"]


@pytest.mark.parametrize("address", [*ADDRESSES, f"nosuch://host/plant?user=reader&password={SECRET}"])
@pytest.mark.parametrize("installed", [True, False])
def test_no_message_shows_the_password(capsys, monkeypatch, address, installed):
    if not installed:
        monkeypatch.setitem(sys.modules, "sqlalchemy", None)
    for words in ((address,), (address, "--query", "SELECT 1"), (address, address), (address, "--json")):
        code, text, error = run(capsys, "check", *words)
        assert code == 1
        assert not installed or "***" in text + error
        assert not any(part in text + error for part in (SECRET, "s3cret", "w@rd"))
    with pytest.raises(InputError) as caught:
        lm.read_loop(address, query="SELECT 1")
    assert SECRET not in str(caught.value)
    assert installed or 'pip install "lostmotion[sql]"' in str(caught.value)
