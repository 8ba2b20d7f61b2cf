"""``lostmotion audit`` as it is typed, and ``lm.audit``: a small plant from files to the report."""

from __future__ import annotations

import json
import sqlite3

import numpy as np
import polars as pl
import pytest

import lostmotion as lm
from lostmotion.cli import main
from lostmotion.evaluate import random_faulty_loop

pytestmark = pytest.mark.statistics  # diagnoses of whole records


def write(path, loop, start="2026-03-02"):
    times = np.datetime64(start) + np.arange(len(loop.op)).astype("timedelta64[s]")
    pl.DataFrame({"time": times.astype("datetime64[ms]"), "OP": loop.op, "PV": loop.pv, "SP": loop.sp}).write_csv(path)


@pytest.fixture(scope="module")
def plant(tmp_path_factory):
    folder = tmp_path_factory.mktemp("plant")
    write(folder / "FIC-101.csv", random_faulty_loop(4, cause="stiction", process="flow"))
    write(folder / "FIC-102.csv", random_faulty_loop(3, cause="none", process="flow"))
    (folder / "README.txt").write_text("what this is\n")
    (folder / "FIC-103.csv").write_bytes(b"\x00\x01\x02 no table")
    return folder


@pytest.fixture(scope="module")
def audited(plant, tmp_path_factory):
    store = tmp_path_factory.mktemp("store") / "plant.db"
    return lm.audit(plant, store, engine="inline")


def run(words, capsys):
    with pytest.raises(SystemExit) as ended:
        main([str(word) for word in words])
    out, err = capsys.readouterr()
    return ended.value.code, out, err


def test_the_valve_is_found_and_everything_is_accounted_for(audited):
    assert [(row.tag, row.said) for row in audited.findings] == [("FIC-101", "stiction"), ("FIC-102", "wear by travel")]
    assert audited.rows[0].verdict == "stiction"
    assert audited.rows[1].verdict != "stiction", "sound, but OP never rests"
    assert {row.tag for row in audited.rows} == {"FIC-101", "FIC-102"}
    assert {(one.where, one.failed) for one in audited.unread} == {("README.txt", False), ("FIC-103.csv", True)}
    assert audited.run.state == "finished"


def test_table_summary_figure_and_history_are_there(audited):
    table = audited.table()
    assert table["tag"].to_list()[0] == "FIC-101"
    assert table["priority"][0] > 0
    assert "Where to look first" in audited.summary()
    assert "FIC-101" in audited._repr_html_()
    assert audited.plot().axes
    assert json.dumps(audited.to_dict(), allow_nan=False)
    assert audited.loop("FIC-101").sized
    with pytest.raises(lm.ParameterError, match="a loop of the run"):
        audited.loop("FIC-999")


def test_a_second_audit_does_nothing_again_and_says_the_same(plant, audited):
    again = lm.audit(plant, audited.store, engine="inline")
    assert again.run.number == audited.run.number + 1
    assert [row.fingerprint for row in again.rows] == [row.fingerprint for row in audited.rows]
    assert [row.seconds for row in again.rows] == [row.seconds for row in audited.rows], "carried over"
    assert not again.news


def test_other_programs_read_the_tables(audited):
    with sqlite3.connect(audited.store) as store:
        line = store.execute(
            "select loop.tag, a.verdict, a.kind, a.size, a.low, a.high, a.size_percent, a.confidence, a.severity, "
            "a.priority, a.status, a.error, a.window_start, a.window_end from assessment a join loop on "
            "loop.id = a.loop_id join run on run.id = a.run_id where a.run_id = 1 order by a.priority desc"
        ).fetchone()
    assert line[:3] == ("FIC-101", "stiction", "actuator")
    assert line[4] <= line[3] <= line[5]


def test_command_writes_its_reports_and_says_what_it_found(plant, tmp_path, capsys):
    store, report, table = tmp_path / "plant.db", tmp_path / "plant.html", tmp_path / "plant.csv"
    pages = tmp_path / "loops"
    words = ["audit", plant, "--store", store, "--engine", "inline", "--report", report, "--table", table]
    code, out, _ = run([*words, "--report-loops", pages], capsys)
    assert code == 1
    assert "stiction" in out
    assert "<html" in report.read_text()
    assert pl.read_csv(table)["tag"].to_list()[0] == "FIC-101"
    assert (pages / "FIC-101.html").exists()
    code, out, _ = run(["audit", "--show", store, "--json"], capsys)
    assert code == 1
    assert json.loads(out)["assessments"][0]["tag"] == "FIC-101"
    code, _, err = run([*words, "--report-loops", pages], capsys)
    assert code == 1
    assert "exists" in err
    assert "--force" in err


def test_a_list_is_proposed_and_taken(plant, tmp_path, capsys):
    main_words = ["audit", "--propose", plant]
    with pytest.raises(SystemExit) as ended:
        main([str(word) for word in main_words])
    proposed = capsys.readouterr().out
    assert ended.value.code == 0
    assert proposed.startswith("tag,op,pv,sp")
    (tmp_path / "loops.csv").write_text("\n".join(line for line in proposed.splitlines() if "FIC-103" not in line))
    words = ["audit", plant, "--loops", tmp_path / "loops.csv", "--store", tmp_path / "p.db", "--engine", "inline"]
    code, out, _ = run([*words, "--screen-only"], capsys)
    assert code in (0, 1)
    assert "not assessed" in out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["audit", "EMPTY"], "none in the folder"),
        (["audit", "NOWHERE"], "NOWHERE"),
        (["audit", "PLANT", "--window", "soon"], "a window of a second and more"),
        (["audit", "PLANT", "--engine", "tcp://10.0.0.9:8786"], "--insecure"),
        (["audit", "PLANT", "--engine", "spark"], "an engine"),
        (["audit", "PLANT", "--since", "never"], "date"),
        (["audit", "PLANT", "--loops", "NOWHERE.csv"], "NOWHERE.csv"),
        (["audit", "--show", "NOWHERE.db"], "NOWHERE.db"),
        (["audit", "--show", "PLANT/README.txt"], "README.txt"),
        (["audit", "--upgrade", "NOWHERE.db"], "NOWHERE.db"),
    ],
)
def test_bad_input_is_one_line(words, said, plant, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty").mkdir()
    typed = [word.replace("PLANT", str(plant)).replace("EMPTY", "empty") for word in words]
    code, out, err = run(
        [*typed, *(["--store", "s.db"] if "--show" not in words and "--upgrade" not in words else [])], capsys
    )
    assert (code, out) == (1 if said == "README.txt" else 2, "")
    assert said in err
    assert len(err.strip().splitlines()) == 1


def test_no_source_is_wrong_usage(capsys):
    code, _, err = run(["audit"], capsys)
    assert code == 2
    assert "SOURCE" in err


def test_a_file_that_needs_a_word_says_it_in_those_of_a_loop_list(tmp_path):
    """Then the list settles it."""
    rows = "".join(f"{30 * k},{20 + k % 7},{50 + k % 5},1.0\n" for k in range(400))
    (tmp_path / "FIC-1.csv").write_text(f"Time,PV,OP,ts\n{rows}")
    found = lm.audit(tmp_path, tmp_path / "a.db", engine="inline", screen_only=True)
    assert found.rows[0].error.endswith(
        "give the true one: dt=30, or dt=1 and time=none to ignore the times (columns of the loop list)"
    )
    (tmp_path / "loops.csv").write_text("tag,op,pv,dt,time\nFIC-1,OP,PV,1,none\n")
    told = tmp_path / "loops.csv"
    settled = lm.audit(tmp_path, tmp_path / "b.db", engine="inline", screen_only=True, loops=told)
    assert settled.rows[0].error == ""
    assert settled.rows[0].dt == 1.0
