"""A batch that is stopped half-way keeps what was done; a long file shows how far it is."""

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.cli import several
from lostmotion.files import text, text_blocks, watch, write_columns
from tests.e2e.test_commands import run
from tests.support.diagnoses import loop_record

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="no pipes with names, and no such signals")
MOST = 60.0  # s


@pytest.fixture(scope="module")
def batch(tmp_path_factory):
    """Two records, and a third that never comes to its end."""
    folder = tmp_path_factory.mktemp("batch")
    record = loop_record(400)
    columns = {"time_s": np.arange(400) * record.dt, "SP": record.sp, "PV": record.pv, "OP": record.op}
    files = [write_columns(folder / name, columns) for name in ("FC7.csv", "FC8.csv")]
    os.mkfifo(folder / "FC9.csv")
    return [*files, folder / "FC9.csv"]


@pytest.fixture(scope="module")
def many(tmp_path_factory):
    """So many records that nobody waits for the last."""
    folder = tmp_path_factory.mktemp("many")
    record = loop_record(400)
    columns = {"time_s": np.arange(400) * record.dt, "SP": record.sp, "PV": record.pv, "OP": record.op}
    return [write_columns(folder / f"FC{number}.csv", columns) for number in range(7, 107)]


@contextmanager
def begun(tmp_path, *words):
    """What a command prints that is killed at the end."""
    said = tmp_path / "said.txt"
    with said.open("w") as stream:
        program = [sys.executable, "-m", "lostmotion", *map(str, words)]
        running = subprocess.Popen(program, stdout=stream, stderr=subprocess.STDOUT)
    try:
        yield said
    finally:
        running.send_signal(signal.SIGKILL)
        running.wait()


def wait_for(there):
    end = time.monotonic() + MOST
    while not there():
        assert time.monotonic() < end
        time.sleep(0.05)


def test_lines_of_check_outlive_a_kill(many, tmp_path):
    with begun(tmp_path, "check", *many) as said:
        wait_for(lambda: said.read_text().count("\n") >= 2)
    assert [line.split()[0] for line in said.read_text().splitlines()][:2] == ["FC7", "FC8"]


def test_elements_of_json_outlive_a_kill(many, tmp_path):
    with begun(tmp_path, "check", *many, "--json") as said:
        wait_for(lambda: said.read_text().count('"samples"') >= 2)
    whole = said.read_text().rpartition("\n  }")[0] + "\n  }]"
    assert [one["usable"] for one in json.loads(whole)][:2] == [True, True]


@pytest.mark.statistics
def test_diagnoses_are_written_as_they_are_done(capsys, batch, tmp_path, monkeypatch):
    out, seen, read = tmp_path / "all.json", [], lm.read_loop

    def reads(path, **settings):
        seen.append(json.loads(out.read_text()) if out.exists() else [])
        return read(path, **settings)

    monkeypatch.setattr("lostmotion.cli.progress.lm.read_loop", reads)
    run(capsys, "diagnose", batch[0], batch[1], batch[0].with_name("absent.csv"), "--out", out)
    assert [[one["file"] for one in found] for found in seen] == [[], [str(batch[0])]]  # an absent one is not read
    assert seen[1][0]["verdict"]
    assert len(json.loads(out.read_text())) == 3
    code, _, error = run(capsys, "diagnose", batch[0], batch[1], "--out", out)
    assert (code, "--force" in error) == (1, True)


def test_an_interrupt_by_hand_leaves_a_whole_list(capsys, batch, monkeypatch):
    monkeypatch.setattr("lostmotion.cli.progress.lm.read_loop", interrupted())
    code, out, error = run(capsys, "check", batch[0], batch[1], batch[0], "--json")
    assert (code, error) == (1, f"stopped at {batch[1]}: 1 of 3 files are done\n")
    found = json.loads(out)
    assert out == json.dumps(found, indent=2) + "\n"
    assert [one.get("error") for one in found] == [None, several.STOPPED, several.STOPPED]


def interrupted():
    """Reader that is interrupted in its second file."""
    read, calls = lm.read_loop, []

    def reads(path, **settings):
        calls.append(path)
        if len(calls) > 1:
            raise KeyboardInterrupt
        return read(path, **settings)

    return reads


def test_one_file_that_is_interrupted_is_no_result(capsys, batch, monkeypatch):
    reader = interrupted()
    monkeypatch.setattr("lostmotion.cli.progress.lm.read_loop", reader)
    assert run(capsys, "check", batch[0])[0] == 0
    code, out, error = run(capsys, "check", batch[0])
    assert (code, out) == (130, "") or (code != 0 and "Aborted" in error)


def test_a_long_file_shows_how_far_it_is(capsys, batch, monkeypatch):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    monkeypatch.setattr(text, "LONG", 1)
    monkeypatch.setattr(text_blocks.cuts, "__defaults__", (4000,))
    _, _, error = run(capsys, "check", batch[0], batch[1])
    shown = [line.removeprefix("\x1b[K") for line in error.split("\r")]
    assert "1 of 2, FC7.csv: looking at the rows of FC7.csv: 100 %" in shown
    assert any(line.startswith("2 of 2, FC8.csv: reading the columns of FC8.csv") for line in shown)
    assert "2 of 2, FC8.csv: checking 400 rows .." in shown
    assert shown[-1] == ""


def test_short_files_tell_nothing(batch):
    said = []
    with watch.watched(said.append):
        several_rows = text.parse_text(batch[0].read_bytes(), "FC7.csv")
    assert (len(several_rows.frame), said) == (400, [])
