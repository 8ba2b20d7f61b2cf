"""Stores that cannot be used: one clear line each, with the remedy and without a password."""

import os
import sqlite3
import subprocess
import sys
import tempfile
from contextlib import closing
from pathlib import Path

import pytest
import sqlalchemy as sa
from alembic.script import ScriptDirectory

from lostmotion.audit.audit_run import AuditRun
from lostmotion.errors import FileAccessError, ParameterError
from lostmotion.store.connect import connected_as_it_is, store_url
from lostmotion.store.run_rows import LoopRow, RunRow
from lostmotion.store.schema import VERSION, metadata
from lostmotion.store.store import Store
from lostmotion.store.upgrade import migrate, upgrade


def made(path, version=VERSION):
    """Store of a version, made by the migrations up to it."""
    engine = connected_as_it_is(path)
    with engine.connect().execution_options(writing=True) as connection, connection.begin():
        migrate(connection, version)
    engine.dispose()
    return path


def assert_refused(match, address, **settings):
    with pytest.raises((FileAccessError, ParameterError), match=match) as caught:
        Store(address, **settings)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def schema(path):
    """Tables and indices as SQLite keeps them, but for white space: a column that is added stands in one line."""
    with closing(sqlite3.connect(path)) as plain:
        rows = plain.execute("SELECT name, sql FROM sqlite_master WHERE name NOT LIKE '%schema_version%' ORDER BY name")
        return [(name, " ".join((sql or "").replace(",", ", ").split())) for name, sql in rows]


def test_migrations_make_the_tables_that_the_code_has(tmp_path):
    Store(tmp_path / "new.db").close()
    assert schema(made(tmp_path / "migrated.db")) == schema(tmp_path / "new.db")


def test_migrations_of_postgresql(postgresql):
    engine = connected_as_it_is(postgresql.database())
    with engine.begin() as connection:
        migrate(connection)
        found = sa.MetaData()
        found.reflect(connection)
    engine.dispose()
    for table in metadata.sorted_tables:
        same = [(column.name, column.nullable) for column in found.tables[table.name].columns]
        assert same == [(column.name, column.nullable) for column in table.columns], table.name
        assert {one.name for one in found.tables[table.name].indexes} == {one.name for one in table.indexes}


def test_the_version_is_the_last_migration():
    assert ScriptDirectory("src/lostmotion/store/migrations").get_current_head() == VERSION


@pytest.mark.parametrize("version", ["0001", "0002", "0003", "0004"])
def test_an_older_store_names_the_command_that_upgrades_it(version, tmp_path):
    path = made(tmp_path / "old.db", version)
    for settings in ({}, {"write": False}):
        expected = f"expected version {VERSION} of the store .*, got the older version {version}; "
        said = assert_refused(expected, path, **settings)
        assert said.endswith(f"then: lostmotion audit --upgrade {path}")
    assert upgrade(path) == (version, VERSION)
    assert upgrade(path) == (VERSION, VERSION)
    Store(path).close()


def test_an_upgrade_keeps_what_is_there(tmp_path):
    path = made(tmp_path / "old.db", "0002")
    with closing(sqlite3.connect(path)) as plain, plain:
        tags = ("FIC-1", "LIC-2")
        for number, tag in enumerate(tags, 1):
            plain.execute(
                "INSERT INTO loop (id, tag, area, type, op, pv, sp, mode, op_unit, pv_unit, weight, place, notes,"
                " search) VALUES (?, ?, '', '', '', '', '', '', '', '', 1.0, '', '[]', '')",
                (number, tag),
            )
        before = plain.execute("SELECT * FROM loop ORDER BY id").fetchall()
    assert upgrade(path) == ("0002", VERSION)
    with closing(sqlite3.connect(path)) as plain:
        assert plain.execute("SELECT * FROM loop ORDER BY id").fetchall() == before
    with Store(path) as store:
        assert [one.tag for one in store.loops()] == list(tags)
        assert (store.watches(), store.estimates("FIC-1")) == ([], [])


REASONS = {
    "PV stood still for 23 % of the time while OP moved: look at the measurement": "frozen measurement",
    "PV scatters over 8 % of span from row to row: look at it; OP travels 90 full strokes an hour: wear": (
        "noisy measurement"
    ),
    "hardly settles: retune (its amplitude comes and goes); OP travels 90 full strokes an hour: wear": "ringing",
    "OP travels 42 full strokes an hour: wear; cannot tell; weight 0.5 of the largest": "wear by travel",
    "OP travels 42 full strokes an hour: wear; not the actuator: look upstream, 99 % sure; swings every 300 s, 90 % of "
    "the variance; its amplitude stays: not its tuning": "wear by travel",
    "not the actuator: look upstream, 99 % sure; its amplitude stays: not its tuning; weight 0.5 of the largest": (
        "forced swing"
    ),
    "backlash of 3 % of span, 90 % sure; OP travels 42 full strokes an hour: wear": "",
    "not the actuator: retune, 90 % sure; swings every 300 s, 90 % of the variance": "",
}


def test_an_upgrade_reads_the_rule_of_each_row_from_its_reason_once(tmp_path):
    """Until then nothing else told it; what has no priority has no rule, whatever its reason says."""
    path = made(tmp_path / "old.db", "0004")
    reasons = [*((reason, 35.0) for reason in REASONS), (next(iter(REASONS)), None)]
    with closing(sqlite3.connect(path)) as plain, plain:
        moment = "2026-03-01 00:00:00.000000"
        needed = {
            table: [(name, kind) for _, name, kind, needs, _, key in plain.execute(f"PRAGMA table_info({table})")
                    if needs or key]
            for table in ("loop", "run", "assessment")
        }  # fmt: skip
        values = {"TEXT": "", "DATETIME": moment, "BOOLEAN": 0, "BIGINT": 1, "INTEGER": 1, "DOUBLE": 1.0}

        def put(table, **given):
            row = {name: values[kind] for name, kind in needed[table]} | given
            marks = ", ".join("?" * len(row))
            names = ", ".join(row)
            plain.execute(f"INSERT INTO {table} ({names}) VALUES ({marks})", list(row.values()))  # noqa: S608

        put("run", settings="{}", state="finished")
        texts = {"health": "[]", "advice": "[]", "evidence": "[]", "indices": "{}", "stage": "assessed"}
        for number, (reason, priority) in enumerate(reasons, 1):
            put("loop", id=number, tag=f"FIC-{number}", notes="[]")
            put("assessment", loop_id=number, priority_reason=reason, priority=priority, **texts)
    assert upgrade(path) == ("0004", VERSION)
    with Store(path) as store:
        assert [row.rule for row in store.rows(1)] == [*REASONS.values(), ""]
    found = AuditRun.of(path)
    assert [row.rule for row in found.findings] == ["frozen measurement", "noisy measurement", "ringing"] + 2 * [
        "wear by travel"
    ]
    assert "Findings: 2 sensors to look at, 2 valves that never rest, 1 loop to retune." in found.summary()


def test_a_newer_store_is_refused(tmp_path):
    path = made(tmp_path / "new.db")
    with closing(sqlite3.connect(path)) as plain, plain:
        plain.execute("UPDATE schema_version SET version_num = '0999'")
    assert_refused("got the newer version 0999; update lostmotion", path)
    with pytest.raises(FileAccessError, match="got the newer version 0999; update lostmotion"):
        upgrade(path)


def test_files_that_are_no_store(tmp_path):
    (tmp_path / "a.csv").write_text("time,OP,PV\n" * 200)
    assert_refused("got a file that is none; give the store another name", tmp_path / "a.csv")
    with closing(sqlite3.connect(tmp_path / "history.db")) as plain, plain:
        plain.execute("CREATE TABLE samples (t, v)")
    assert_refused(r"got a database with other tables \(samples\); ", tmp_path / "history.db")
    assert_refused("got a database with other tables", tmp_path / "history.db", write=False)
    assert [name for name, _ in schema(tmp_path / "history.db")] == ["samples"], "left as it was"
    assert_refused("got a folder; give the name of a file", tmp_path)
    assert_refused("got the file .* in its path; choose another path", tmp_path / "a.csv" / "b.db")
    assert_refused("got no such file; check the name", tmp_path / "b.db", write=False)
    assert_refused(r"expected a file, sqlite:///FILE or postgresql://.., got mysql://; ", "mysql://host/plant")
    assert_refused(r"got sqlite://; ", "sqlite://")


@pytest.mark.parametrize("bytes_of", [248, 253, 255])
def test_a_name_that_leaves_no_room_for_the_files_beside_it(tmp_path, bytes_of):
    said = assert_refused("expected a store .*, got a name of", tmp_path / ("ä" * 20 + "n" * (bytes_of - 40)))
    assert said.endswith(
        f"got a name of {bytes_of} bytes; give one of at most 247: SQLite puts files with longer names beside it"
    )
    assert list(tmp_path.iterdir()) == []


def test_the_longest_name_of_a_store(tmp_path):
    Store(tmp_path / ("n" * 247)).close()
    assert [one.name for one in tmp_path.iterdir()] == ["n" * 247]


def test_a_store_that_is_locked(tmp_path):
    path = tmp_path / "a.db"
    with Store(path, patience=0.05) as store, closing(sqlite3.connect(path)) as other:
        other.execute("BEGIN IMMEDIATE")
        with pytest.raises(FileAccessError, match="got one that is locked by another program; close what has it open"):
            store.begin(RunRow("plant"))
        other.rollback()
        assert store.begin(RunRow("plant")) == (1, False)


def test_a_store_that_is_read_only(tmp_path):
    path = tmp_path / "a.db"
    Store(path).close()
    with Store(f"sqlite:///file:{path}?mode=ro&uri=true", write=False) as store:
        with pytest.raises(FileAccessError, match="got one that is read-only; check its permissions"):
            store.begin(RunRow("plant"))
        assert store.runs() == []


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="needs the right to become somebody else")
def test_a_store_that_nobody_may_write():
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.db"
        Path(folder).chmod(0o755)
        code = (
            "import os, sys; from lostmotion.store.store import Store; path = sys.argv[1]\n"
            "Store(path).close(); os.setuid(65534)\n"
            "with Store(path, write=False) as store: print(store.runs())\n"
            "try: Store(path)\nexcept OSError as error: print(error)"
        )
        done = subprocess.run([sys.executable, "-c", code, path], capture_output=True, text=True, check=True)
    read, refused = done.stdout.splitlines()
    assert read == "[]"
    assert refused.startswith(f"expected a store that can be used at {str(path)!r}, got one that is read-only; check")


def test_a_disk_that_is_full(tmp_path):
    with Store(tmp_path / "a.db") as store:
        run, _ = store.begin(RunRow("plant"))

        @sa.event.listens_for(store.engine, "checkout")
        def _(connection, *_):
            connection.execute("PRAGMA max_page_count = 40")

        with pytest.raises(FileAccessError, match="got a full disk; make room and start again: what was done is kept"):
            store.put_loops(run, [LoopRow(f"FIC-{number}" * 50) for number in range(500)])
        assert store.loops() == []


def test_a_server_that_is_not_there(tmp_path):
    address = "postgresql://ada:secret@127.0.0.1:1/plant"
    said = assert_refused("got no connection; check that the server runs", address, patience=0.3)
    assert "secret" not in said
    assert "secret" not in str(store_url(address))


def test_a_server_is_waited_for(monkeypatch):
    tried = []
    monkeypatch.setattr("time.sleep", tried.append)
    assert_refused("got no connection", "postgresql://127.0.0.1:1/plant", patience=3.0)
    assert tried[:3] == [0.25, 0.5, 1.0]


def test_a_database_that_is_not_there(postgresql):
    there = postgresql.database()
    head, _, tail = there.partition("?")
    assert_refused("got a server without this database; make it", f"{head}x?{tail}", patience=60.0)
