"""``lostmotion demo-plant``: what it writes can be read, and is what it says."""

import json

import polars as pl
import pytest

import lostmotion as lm
from lostmotion.evaluate.plants import simulated
from tests.e2e.test_commands import run

SMALL = ("--loops", 6, "--days", 0.005, "--faults", 2, "--swings", 0)
LIST = "tag op pv sp mode type op_low op_high pv_low pv_high op_unit pv_unit area weight file"


@pytest.fixture(autouse=True)
def little_before(monkeypatch):
    monkeypatch.setattr(simulated, "SETTLED", 60.0)


@pytest.mark.parametrize("ending", ["parquet", "csv"])
def test_a_plant_is_written_and_read_again(capsys, tmp_path, ending):
    folder = tmp_path / "plant"
    code, out, error = run(capsys, "demo-plant", folder, *SMALL, "--format", ending, "--json")
    assert (code, error) == (0, "")
    said = json.loads(out)
    assert (said["loops"], len(said["faults"])) == (6, 2)
    loops, truth = pl.read_csv(folder / "loops.csv"), pl.read_csv(folder / "truth.csv")
    assert " ".join(loops.columns) == LIST
    assert loops["tag"].to_list() == truth["tag"].to_list()
    assert (truth["fault"] != "none").sum() == 2
    assert {path.name for path in folder.iterdir()} == {*loops["file"], "loops.csv", "truth.csv"}
    for row in loops.iter_rows(named=True):
        record = lm.read_loop(folder / row["file"], op=row["op"], pv=row["pv"], sp=row["sp"])
        assert (len(record), record.dt) == (432, 1.0)
        assert record.start is not None
        assert record.mode is not None
        assert (record.pv[record.pv == record.pv] >= row["pv_low"] - 0.02 * (row["pv_high"] - row["pv_low"])).all()


def test_its_text_says_what_to_expect_and_what_to_type(capsys, tmp_path):
    code, out, _ = run(capsys, "demo-plant", tmp_path / "my plant", *SMALL)
    words = " ".join(out.split())
    assert code == 0
    for said in (
        "6 loops in",
        "1 x stiction, 1 x tight tuning",
        "The answer key is truth.csv.",
        "What to expect: the audit names about two of three",
        'stay "cannot tell"',
        "Then: lostmotion serve plant.db",
    ):
        assert said in words
    assert f"Next: lostmotion audit '{tmp_path / 'my plant'}' --loops" in words
    code, out, _ = run(capsys, "demo-plant", tmp_path / "resting", *SMALL, "--moves", 0)
    assert (code, "only feedback moves OP" in " ".join(out.split())) == (0, True)


def test_a_folder_that_is_there_is_left_alone(capsys, tmp_path):
    folder = tmp_path / "plant"
    run(capsys, "demo-plant", folder, *SMALL)
    before = {path.name: path.stat().st_mtime_ns for path in folder.iterdir()}
    code, _, error = run(capsys, "demo-plant", folder, *SMALL)
    assert (code, "--force" in error) == (1, True)
    assert {path.name: path.stat().st_mtime_ns for path in folder.iterdir()} == before
    assert run(capsys, "demo-plant", folder, *SMALL, "--force")[0] == 0
    (folder / "mine.csv").write_text("1")
    code, _, error = run(capsys, "demo-plant", folder, *SMALL, "--force")
    assert (code, "mine.csv" in error) == (1, True)


@pytest.mark.parametrize(("given", "said"), [(("--format", "xls"), "parquet"), (("--loops", 1), "loops")])
def test_what_cannot_be_is_refused(capsys, tmp_path, given, said):
    code, _, error = run(capsys, "demo-plant", tmp_path / "plant", *SMALL, *given)
    assert (code, said in error) == (2, True)
    assert not (tmp_path / "plant").exists()
