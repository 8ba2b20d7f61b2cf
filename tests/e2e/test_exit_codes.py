"""One table of exit codes for all commands; folders that are named for output are made."""

import json
import os

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.cli.commands import COMMANDS
from lostmotion.cli.exit_codes import ATTENTION, DONE, TABLE, USAGE
from lostmotion.files import write_columns
from tests.support.command import run
from tests.support.diagnoses import loop_record
from tests.support.fits import made_fit

FIT = ("--orders", "1,0,1", "--noise", "white", "--raw", "--nonlinearity", "dead zone")
EXPORT = ("--name", "FY_101", "--date", "2026-01-31", "--replay", "0", "--out", "new/code")
LIMITS = ("--op-limits", "40", "60", "--duration", "300")
PLANT = """address = "opc.tcp://127.0.0.1:1"
[[loop]]
tag = "FIC1"
op = "ns=2;s=OP"
pv = "ns=2;s=PV"
dt = 1.0
fit = "absent.json"
"""


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder with a record, one that is refused, and a fit."""
    monkeypatch.chdir(tmp_path)
    record = loop_record()
    write_columns("good.csv", {"time_s": 5.0 * np.arange(len(record)), "OP": record.op, "PV": record.pv})
    write_columns("bad.csv", {"time_s": np.arange(300.0), "OP": np.full(300, 42.0), "PV": np.arange(300.0) % 7})
    made_fit("dead zone").save("fit.json")
    made_fit("dead zone", lm.Status.WIDE).save("wide.json")
    (tmp_path / "plant.toml").write_text(PLANT)
    (tmp_path / "other.json").write_text("{}")
    return tmp_path


ABSENT = [
    *[(command, "absent.csv") for command in ("check", "diagnose", "identify", "simulate", "solve", "audit", "serve")],
    ("check", "absent_*.csv"),
    ("check", "sqlite:///absent.db", "--query", "select 1"),
    ("simulate", "absent.json"),
    ("simulate", "fit.json", "--record", "absent.csv"),
    ("simulate", "fit.json", "--block", "absent.json", "--kp", "1", "--ki", "0.1"),
    ("simulate", "fit.json", "--diagnosis", "absent.json", "--kp", "1", "--ki", "0.1"),
    ("simulate", "--model", "absent.toml"),
    ("compensate", "absent.csv", "--left", "49", "--right", "51", "--out", "new/out.csv"),
    ("compensate", "good.csv", "--fit", "absent.json", "--out", "new/out.csv"),
    ("design", "--fit", "absent.json", *LIMITS),
    ("design", "--model", "absent.toml", *LIMITS),
    ("design", "--fit", "fit.json", "--achievable", "absent.csv"),
    ("export", "absent.json", *EXPORT),
    ("online", "absent.csv", "--orders", "1,0,1", "--no-follow", "--state", "new/a.state"),
    ("online", "good.csv", "--fit", "absent.json", "--no-follow"),
    ("live", "absent.toml"),
    ("live", "plant.toml", "--insecure"),
    ("request", "absent.toml", "FIC1", "fit.json"),
    ("audit", "--show", "absent.db"),
    ("audit", "good.csv", "--loops", "absent.csv", "--store", "new/plant.db"),
    ("serve", "--store", "absent.db", "--no-open"),
    ("serve", "good.csv", "--token-file", "absent.txt", "--no-open"),
    ("demo-live", "--port", "0", "--plc", "./no-such-program", "--seconds", "0"),
]


@pytest.mark.parametrize("words", ABSENT, ids=" ".join)
def test_an_input_that_does_not_exist_is_wrong_usage(capsys, here, words):
    code, text, error = run(capsys, *words)
    assert (code, text) == (USAGE, "")
    assert error.splitlines()[-1].startswith("error: expected")
    assert not (here / "new").exists(), "nothing is made for it"


@pytest.mark.parametrize("command", COMMANDS)
def test_help_and_unknown_options(capsys, command):
    assert run(capsys, command, "--help")[0] == DONE
    assert run(capsys, command, "--no-such-option")[0] == USAGE


@pytest.mark.parametrize(
    "words",
    [
        ("check", "good.csv", "--dt", "-1", "--ignore-time"),
        ("identify", "good.csv", "--orders", "many"),
        ("diagnose", "good.csv", "--tolerance", "2"),
        ("simulate", "--width", "2", "--left", "48", "--right", "52"),
        ("compensate", "good.csv", "--left", "49", "--out", "new/out.csv"),
        ("design", "--fit", "fit.json"),
        ("export", "fit.json", *EXPORT, "--to", "pascal"),
        ("online", "good.csv", "--orders", "many", "--no-follow"),
        ("live", "opc.tcp://127.0.0.1:1"),
        ("audit",),
        ("serve", "--bind", "192.0.2.1", "--no-open"),
        ("demo-live", "--speed", "-1"),
        ("demo-plant", "new/plant", "--loops", "-1"),
        ("paper", "--seeds", "0"),
        ("solve", "good.csv", "--accept", " "),
    ],
    ids=" ".join,
)
def test_a_value_out_of_range_is_wrong_usage(capsys, here, words):
    assert run(capsys, *words)[0] == USAGE
    assert not (here / "new").exists()


@pytest.mark.parametrize(
    "words",
    [
        *[(command, "bad.csv") for command in ("check", "diagnose", "identify", "simulate", "solve")],
        ("identify", "good.csv", "--op", "no such column"),
        ("simulate", "wide.json", "--kp", "1", "--ki", "0.1"),
        ("compensate", "good.csv", "--fit", "wide.json", "--out", "new/out.csv"),
        ("design", "--fit", "other.json", *LIMITS),
        ("export", "wide.json", *EXPORT),
        ("online", "good.csv", "--fit", "other.json", "--no-follow"),
        ("request", "plant.toml", "FIC1", "fit.json"),
        ("check", "good.csv", "absent.csv"),
        ("serve", "other.json", "--store", "other.json", "--no-open"),
    ],
    ids=" ".join,
)
def test_what_is_refused_needs_attention(capsys, here, words):
    if words[0] == "request":
        (here / "plant.toml").write_text("address = 1")
    assert run(capsys, *words)[0] == ATTENTION
    assert not (here / "new").exists()


def test_what_is_done_is_done_and_folders_are_made(capsys, here):
    (here / "again.csv").write_bytes((here / "good.csv").read_bytes())
    for words in (
        ("check", "good.csv"),
        ("identify", "good.csv", *FIT, "--out", "a/b/fit.json", "--figure", "c/fit.png"),
        ("identify", "good.csv", "again.csv", *FIT, "--out", "d/results"),
        ("compensate", "good.csv", "--left", "49", "--right", "51", "--out", "e/out.csv"),
        ("export", "fit.json", *EXPORT),
        ("demo-plant", "f/plant", "--loops", "6", "--days", "0.05", "--faults", "0", "--swings", "0"),
        (
            "audit",
            "f/plant",
            "--screen-only",
            "--engine",
            "inline",
            "--store",
            "g/plant.db",
            "--report",
            "h/plant.html",
        ),
    ):
        assert run(capsys, *words)[0] == DONE, words
    made = ("a/b/fit.json", "c/fit.png", "d/results/good.json", "e/out.csv", "new/code/FY_101.st", "g/plant.db")
    assert all((here / path).is_file() for path in (*made, "h/plant.html"))
    run(capsys, "online", "good.csv", "--orders", "1,0,1", "--no-follow", "--state", "i/j/good.state")
    assert (here / "i/j/good.state").is_file()


@pytest.mark.parametrize("path", ["good.csv/fit.json", "good.csv/below/fit.json"])
def test_a_file_is_no_folder(capsys, here, path):
    code, text, error = run(capsys, "identify", "good.csv", *FIT, "--out", path)
    assert (code, text) == (ATTENTION, "")
    assert "got the file" in error


def test_a_folder_that_was_made_in_vain_is_removed(here, monkeypatch):
    def full(*_):
        raise OSError(28, os.strerror(28))

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(lm.FileAccessError, match="room"):
        made_fit("dead zone").save(here / "x" / "y" / "fit.json")
    assert not (here / "x").exists()


def test_the_help_has_the_table(capsys):
    text = " ".join(run(capsys, "--help")[1].split())
    assert all(f"{code} {meaning}" in text for code, meaning in TABLE.items())


def test_an_error_in_json_has_the_same_code(capsys, here):
    code, text, _ = run(capsys, "diagnose", "absent.csv", "--json")
    assert (code, json.loads(text)["error"]) == (USAGE, "FileAccessError")
