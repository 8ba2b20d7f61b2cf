"""Commands that several files and loops suggest can be typed, with the options that were given and each once."""

import json
import re
import shlex

import numpy as np
import polars as pl
import pytest

from tests.e2e.test_commands import run
from tests.support.diagnoses import loop_record

ROWS = 400
RECORD = loop_record(ROWS)


def rows(op="OP", pv="PV", step=10):
    return pl.DataFrame({"t_s": np.arange(ROWS) * step, op: RECORD.op, pv: RECORD.pv})


def commands(text):
    return [shlex.split(line) for line in re.findall(r"lostmotion ([a-z].*?)(?: or (?=lostmotion)|\n|$)", text)]


@pytest.fixture
def whole(tmp_path):
    path = tmp_path / "FC 9.csv"
    rows().write_csv(path)
    return path


def test_an_option_that_was_typed_is_replaced(capsys, whole, tmp_path):
    rows("valve", "PV").write_csv(tmp_path / "FC8.csv")
    options = ("--dt", 1, "--op", "valve")
    code, text, _ = run(capsys, "check", tmp_path / "FC8.csv", whole, *options)
    said = commands(text.splitlines()[0])
    assert code == 1
    file = str(tmp_path / "FC8.csv")
    assert said == [
        ["check", file, "--op", "valve", "--dt", "10"],
        ["check", file, "--op", "valve", "--dt", "1", "--ignore-time"],
    ]
    for words in said:
        assert "expected" not in run(capsys, *words)[2]


def test_a_command_for_files_of_one_tag_each_names_them_all(capsys, whole, tmp_path):
    ends = [tmp_path / "FIC7_OP.csv", tmp_path / "FIC7_PV.csv"]
    for path, name in zip(ends, ("FIC7.OP", "FIC7.PV"), strict=True):
        rows("FIC7.OP", "FIC7.PV").select("t_s", name).write_csv(path)
    code, text, _ = run(capsys, "check", *ends, whole, "--dt", 1)
    said = [words for words in commands(text) if "FIC7" in words[1]]
    assert code == 1
    assert said[0] == ["check", *map(str, ends), "--dt", "10"]
    assert run(capsys, *said[0])[2] == ""
    data = json.loads(run(capsys, "check", *ends, whole, "--json")[1])
    assert shlex.split(data[0]["file"]) == [str(path) for path in ends]


def test_loops_of_a_file_stand_beside_it(capsys, tmp_path):
    both = rows("FIC1.OP", "FIC1.PV").join(rows("FIC2.OP", "FIC2.PV"), on="t_s")
    path = tmp_path / "our plant.csv"
    both.write_csv(path)
    code, text, _ = run(capsys, "diagnose", path, "--dt", 1, "--json")
    data = json.loads(text)
    assert code == 1
    assert [(one["file"], one["loop"], one["error"]) for one in data] == [
        (str(path), "FIC1", "TimeError"),
        (str(path), "FIC2", "TimeError"),
    ]
    words = commands(data[1]["message"])[0]
    assert words == ["diagnose", str(path), "--loop", "FIC2", "--dt", "10"]


@pytest.mark.statistics
def test_modes_that_are_not_known_are_told_with_the_option(capsys, tmp_path):
    path = tmp_path / "FC7.csv"
    rows().with_columns(Mode=pl.lit("1")).write_csv(path)
    for command in ("check", "identify", "diagnose"):
        text = " ".join(run(capsys, command, path)[1].split())
        assert "Say which means automatic: --auto-value 1." in text
    assert "not known" not in run(capsys, "check", path, "--auto-value", 1)[1]


def test_several_modes_leave_the_word_open(capsys, tmp_path):
    path = tmp_path / "FC7.csv"
    rows().with_columns(Mode=pl.Series(["0", "1"] * (ROWS // 2))).write_csv(path)
    assert "Say which means automatic: --auto-value WORD." in run(capsys, "check", path)[1]
