"""A file with several loops: listed by check, all diagnosed by one command, read by name in Python."""

import json
import shlex

import numpy as np
import polars as pl
import pytest

import lostmotion as lm
from lostmotion.errors import DataError, ParameterError
from tests.e2e.test_commands import run
from tests.support.diagnoses import loop_record

TAGS = ("FIC101", "PIC102", "LIC103")


@pytest.fixture(scope="module")
def record():
    return loop_record(800)


@pytest.fixture(scope="module")
def plant(tmp_path_factory, record):
    """A stiff valve, the same upside down, and a controller that stands still."""
    columns = {"t_s": np.arange(len(record)) * record.dt}
    for tag, op in zip(TAGS, (record.op, 100 - record.op, np.full(len(record), 42.0)), strict=True):
        columns |= {f"{tag}.OUT": op, f"{tag}.PV": record.pv, f"{tag}.SP": record.sp}
    path = tmp_path_factory.mktemp("plant") / "unit 1.csv"
    pl.DataFrame(columns).write_csv(path)
    return path


def test_check_lists_the_loops_and_what_to_type(capsys, plant):
    code, text, error = run(capsys, "check", plant, "--op-span", 0, 100)
    lines = text.splitlines()
    assert (code, error, lines[0]) == (1, "", "unit 1.csv holds 3 loops:")
    assert [line.split()[:2] for line in lines[1:4]] == [
        ["FIC101", "flow"],
        ["PIC102", "pressure"],
        ["LIC103", "level"],
    ]
    assert "OP PIC102.OUT, PV PIC102.PV, SP PIC102.SP" in lines[2]
    one, every = (shlex.split(line)[1:] for line in lines if line.startswith("    lostmotion"))
    assert one == ["check", str(plant), "--op-span", "0", "100", "--loop", "FIC101"]
    code, text, error = run(capsys, *one)
    assert (code, error) == (0, "")
    assert "loop 'FIC101', a flow loop by its tag" in text
    assert every == ["diagnose", str(plant), "--op-span", "0", "100"]  # run below
    data = json.loads(run(capsys, "check", plant, "--json")[1])
    assert [loop["columns"]["pv"] for loop in data["loops"]] == [f"{tag}.PV" for tag in TAGS]


def test_one_of_them_is_asked_for_where_one_is_needed(capsys, plant):
    for command in ("identify", "solve"):
        code, _, error = run(capsys, command, plant)
        assert code > 0
        assert f"    lostmotion {command} '{plant}' --loop PIC102" in error.splitlines()


def test_all_loops_in_python(plant, record):
    found = lm.read_loops(plant)
    assert list(found) == list(TAGS)
    assert [one.loop_type for one in found.values()] == ["flow", "pressure", "level"]
    np.testing.assert_array_equal(found["PIC102"].op, lm.read_loop(plant, loop="PIC102").op)
    assert list(lm.read_loops(pl.read_csv(plant), op_span=(0, 100))) == list(TAGS)
    assert found["FIC101"].tag == "FIC101"
    with pytest.raises(ParameterError, match="settings for all loops alike"):
        lm.read_loops(plant, loop="FIC101")


def test_loops_of_files_and_folders_in_python(tmp_path, plant, record):
    whole = pl.DataFrame({"t_s": np.arange(800) * record.dt, "OP": record.op, "PV": record.pv})
    for name in ("FC7", "FC8"):
        whole.write_csv(tmp_path / f"{name}.csv")
    assert list(lm.read_loops(tmp_path)) == ["FC7", "FC8"]
    assert list(lm.read_loops([plant, tmp_path / "FC7.csv"])) == [*TAGS, "FC7"]
    assert list(lm.read_loops(tmp_path / "FC7.csv")) == ["FC7"]
    for tag, values in (("FC9_OP", record.op), ("FC9_PV", record.pv)):
        pl.DataFrame({"t_s": np.arange(800) * record.dt, "value": values}).write_csv(tmp_path / f"{tag}.csv")
    found = lm.read_loops(tmp_path)
    assert list(found) == ["FC7", "FC8", "FC9"]
    np.testing.assert_allclose(found["FC9"].op, record.op)
    (tmp_path / "again").mkdir()
    whole.write_csv(tmp_path / "again" / "FC7.csv")
    with pytest.raises(DataError, match="'FC7' twice"):
        lm.read_loops([tmp_path / "FC7.csv", tmp_path / "again" / "FC7.csv"])


@pytest.mark.statistics
def test_diagnose_takes_every_loop(capsys, plant, tmp_path):
    code, text, error = run(
        capsys, "diagnose", plant, "--op-span", 0, 100, "--figure", tmp_path, "--out", tmp_path / "a.json"
    )
    lines = text.splitlines()
    assert (code, error) == (1, "")
    assert [line.split()[0] for line in lines[:3]] == list(TAGS)
    assert lines[-1].startswith("3 loops: ")
    assert sorted(path.name for path in tmp_path.glob("*.png")) == ["FIC101.png", "PIC102.png"]
    data = json.loads((tmp_path / "a.json").read_text())
    assert [(one["file"], one["loop"]) for one in data] == [(str(plant), tag) for tag in TAGS]
    alone = json.loads(run(capsys, "diagnose", plant, "--loop", "PIC102", "--op-span", 0, 100, "--json")[1])
    assert (alone["verdict"], alone["size"]) == (data[1]["verdict"], data[1]["size"])


def test_an_error_of_one_loop_says_the_command_that_leads_on(capsys, tmp_path):
    rows = [f"{10 * k},{k % 7},{k % 5},{k % 3},{k % 4},12" for k in range(100)]
    path = tmp_path / "unit.csv"
    path.write_text("\n".join(["time,FC1.OP,FC1.PV,FC2.OP,FC2.PV,ts", *rows, ""]))
    code, text, error = run(capsys, "diagnose", path)
    assert (code, error) == (1, "")
    lines = [line for line in text.splitlines() if "error: " in line]
    assert len(lines) == 2
    commands = lines[1].split(" Type ")[1].split(" or ")
    assert [shlex.split(command)[2:5] for command in commands] == [[str(path), "--loop", "FC2"]] * len(commands)
    for command in commands:
        words = ["check", *shlex.split(command)[2:]]
        assert run(capsys, *words)[2] == ""
