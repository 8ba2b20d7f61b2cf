"""Odd words behind commands: one line and exit code 1 or 2, within seconds; or what was asked for."""

import time
from pathlib import Path

import numpy as np
import pytest

from lostmotion.cli.output import OutputOptions
from tests.e2e.test_commands import run
from tests.support.commands_that_write import KNOWN, ZONE
from tests.support.exports import block

LONGEST = 3000  # characters of a line
MADE = {"FY_101.st", "FY_101_vectors.csv", "FY_101_commissioning.md"}
EXPORT = ["export", "block.json", "--name", "FY_101", "--date", "2026-01-31", "--replay", "20"]
NAMES = {
    "250 letters": "n" * 250,
    "250 letters of two bytes": "\u00fc" * 250,
    "4096 bytes": "/".join(["d" * 127] * 32),
    "4096 bytes in folders": "p/" * 2048,
    "5000 letters": "x" * 5000,
}


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder with a record and a block, where the commands stand."""
    random = np.random.default_rng(0)
    u = np.repeat(random.normal(size=500), 10)
    y = np.convolve(u, [0.0, 0.3, 0.2])[: u.size] + 0.02 * random.normal(size=u.size)
    rows = "".join(f"{k},{u[k]:.4f},{y[k]:.4f}\n" for k in range(u.size))
    (tmp_path / "a.csv").write_text(f"t_s,OP,PV\n{rows}")
    OutputOptions().write_json(tmp_path / "block.json", block("backlash").to_dict())
    monkeypatch.chdir(tmp_path)
    return tmp_path


def there(folder="."):
    return {path.name for path in Path(folder).iterdir()}


def refused(capsys, *words):
    """What is said in the one line of a command that does nothing."""
    before = there()
    code, out, error = run(capsys, *words)
    assert (code in (1, 2), out) == (True, "")  # solve: 1 is a closed gate
    assert error.startswith("error: expected")
    assert error.count("\n") == 1
    assert len(error) < LONGEST
    assert there() == before
    return error


WORDS = ("factor=", "factor", "=", "=1", "", "factor=nan", "factor=1e400", "factor=0,5", "factor=1=2", "fac\ntor=1",
         "none=1", "factor=\0")  # fmt: skip


@pytest.mark.parametrize("word", WORDS)
def test_a_setting_that_is_none(capsys, here, word):
    assert "got" in refused(capsys, *EXPORT, "--set", word, "--out", "fy")


@pytest.mark.parametrize("out", [".", "./", "", "../here"])
def test_export_into_the_folder_where_one_stands(capsys, here, monkeypatch, out):
    """What lies there stays, and with --force the files of the export before are replaced."""
    (here / "here").mkdir()
    monkeypatch.chdir(here / "here")
    (here / "here" / "keep.txt").write_text("kept")
    words = [EXPORT[0], "../block.json", *EXPORT[2:], "--out", out]
    for _ in range(2):
        assert run(capsys, *words, "--force")[0] == 0
        assert there() == {"keep.txt", *MADE}
    assert "use --force to replace them" in refused(capsys, *words)
    assert (here / "here" / "keep.txt").read_text() == "kept"


def commands(name):
    """A long name wherever a path is taken: those that fail, and those that may write it."""
    export = [*EXPORT, "--out", name]
    reading = [
        ["check", f"{name}.csv"], ["diagnose", f"{name}.csv"], ["identify", f"{name}.csv"],
        ["export", name, *EXPORT[2:], "--out", "q"], ["design", "--fit", name],
        ["online", f"{name}.csv", "--orders", "1,0,1", "--no-follow"],
        ["solve", f"{name}.csv"], ["simulate", f"{name}.csv"], ["audit", name], ["check", "a.csv", "--op", name],
        ["export", "block.json", "--name", name, "--date", "2026-01-31", "--out", "q"],
    ]  # fmt: skip
    writing = [
        export, ["compensate", "a.csv", "--left", "-1", "--right", "1", "--out", f"{name}.csv"],
        ["identify", "a.csv", *KNOWN, "--out", f"{name}.json"],
        ["design", *ZONE, "--noise-deviation", "0.2", "--op-limits", "40", "60", "--out", f"{name}.csv"],
    ]  # fmt: skip
    if len(name) > 255:
        reading.append(["audit", "a.csv", "--store", f"{name}.db"])  # a shorter one is there, its journal is not
    return reading, writing


@pytest.mark.parametrize("kind", NAMES)
def test_long_names(capsys, here, kind):
    """One line; a name of 250 bytes and its ending can be had, and is written."""
    reading, writing = commands(NAMES[kind])
    for words in reading:
        refused(capsys, *words)
    for words in writing:
        if kind != "250 letters":
            refused(capsys, *words)
    if kind == "250 letters":
        assert run(capsys, *writing[0])[0] == 0
        assert there(NAMES[kind]) == MADE
        assert run(capsys, *writing[1])[0] == 0


@pytest.mark.parametrize("day", ["2026-W05-6", "20260131", "2026-031", "2026-1-31", "2026-02-30", "\uff12026-01-31"])
def test_a_day_that_is_written_another_way(capsys, here, day):
    words = [*EXPORT, "--to", "plcopen", "--out", "fy"]
    words[words.index("2026-01-31")] = day
    assert "a date as YYYY-MM-DD" in refused(capsys, *words)


ORDERS = {
    "--noise": ("999", "101", "9" * 30, "9" * 5000, "\u00b2", "-1", "1.5", ""),
    "--orders": ("999,999,1", "101,0,1", "1,0", "1,0,1,1", "a,b,c", "", f"{'9' * 5000},0,1"),
}


@pytest.mark.parametrize("option", ORDERS)
@pytest.mark.parametrize("command", ["identify", "online"])
def test_orders_that_no_loop_has_take_no_time(capsys, here, command, option):
    """An AR model of order 999 took minutes on these 5000 rows."""
    others = [] if option == "--orders" else ["--orders", "1,0,1"]
    more = ["--no-follow"] if command == "online" else ["--nonlinearity", "dead zone"]
    begun = time.process_time()
    for order in ORDERS[option]:
        refused(capsys, command, "a.csv", *others, *more, option, order)
    assert time.process_time() - begun < 20.0
