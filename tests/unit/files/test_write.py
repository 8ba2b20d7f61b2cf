import csv
import os
import stat

import numpy as np
import pandas as pd
import polars as pl
import pytest

from lostmotion import files
from lostmotion.errors import DataError, FileAccessError, InputError, ParameterError
from lostmotion.files.write import write_table
from lostmotion.plant import PlantLoop
from lostmotion.plant.loop_list import loop_list_text, parse_loop_list
from lostmotion.printable import text_of

COLUMNS = {"time": np.arange(3.0), "OP": [1.0, np.nan, 3.0], "PV": [0.1, 0.2, 0.3]}


@pytest.mark.parametrize("name", ["a.csv", "a.txt", "a.tsv", "a.parquet", "a.pq", "A.CSV"])
def test_what_is_written_can_be_read(tmp_path, name):
    path = files.write_table(tmp_path / name, COLUMNS)
    record = files.read_loop(path)
    np.testing.assert_array_equal(record.op, COLUMNS["OP"])
    np.testing.assert_array_equal(record.pv, COLUMNS["PV"])
    assert [entry.name for entry in tmp_path.iterdir()] == [name]


def test_existing_file_is_kept_unless_forced(tmp_path):
    path = files.write_columns(tmp_path / "a.csv", COLUMNS)
    before = path.read_bytes()
    with pytest.raises(FileAccessError, match="exists; use force=True"):
        files.write_columns(path, {"OP": [1.0]})
    assert path.read_bytes() == before
    files.write_columns(path, {"OP": [1.0]}, force=True)
    assert path.read_text() == "OP\n1.0\n"


def test_failure_leaves_the_old_file_and_no_rest(tmp_path, monkeypatch):
    path = files.write_columns(tmp_path / "a.csv", COLUMNS)
    before = path.read_bytes()

    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(pl.DataFrame, "write_csv", full)
    with pytest.raises(FileAccessError, match="No space left"):
        files.write_columns(path, {"OP": [1.0]}, force=True)
    assert path.read_bytes() == before
    assert len(list(tmp_path.iterdir())) == 1


def test_permissions_are_the_usual_ones(tmp_path):
    path = files.write_columns(tmp_path / "a.csv", COLUMNS)
    plain = tmp_path / "plain"
    plain.touch()
    if os.name == "posix":
        assert stat.S_IMODE(path.stat().st_mode) == stat.S_IMODE(plain.stat().st_mode)


def test_frames(tmp_path):
    frame = pl.DataFrame(COLUMNS)
    for place, other in enumerate((frame, pd.DataFrame(COLUMNS), frame.to_arrow())):
        path = files.write_table(tmp_path / f"{place}.csv", other)
        assert path.read_text() == "time,OP,PV\n0.0,1.0,0.1\n1.0,,0.2\n2.0,3.0,0.3\n"


def test_refusals(tmp_path):
    with pytest.raises(ParameterError, match="suffix"):
        files.write_columns(tmp_path / "a.xlsx", COLUMNS)
    with pytest.raises(DataError, match="one length"):
        files.write_columns(tmp_path / "a.csv", {"OP": [1.0], "PV": [1.0, 2.0]})
    with pytest.raises(DataError, match="one length"):
        files.write_columns(tmp_path / "a.csv", {})
    (tmp_path / "file").write_text("")
    with pytest.raises(FileAccessError, match=r"expected a folder .*, got the file .*; choose another path"):
        files.write_columns(tmp_path / "file" / "a.csv", COLUMNS)
    (tmp_path / "b.csv").mkdir()
    with pytest.raises(FileAccessError, match="got the folder"):
        files.write_columns(tmp_path / "b.csv", COLUMNS, force=True)
    with pytest.raises(InputError, match="a mapping of names"):
        files.write_table(tmp_path / "a.csv", [1, 2])


@pytest.mark.parametrize("text", ["=1+1", "+A1", "-x", "@SUM(A1)", "\t=1", "=cmd|' /C calc'!A0", "'=x", "＝1"])
def test_no_text_is_a_formula_of_a_spreadsheet(tmp_path, text):
    path = write_table(tmp_path / "a.csv", pl.DataFrame({text: [text, "-5.2", "FIC101"], "n": [-1.0, 2.0, 3.0]}))
    rows = list(csv.reader(path.read_text(encoding="utf-8").splitlines()))
    assert rows[0][0] == rows[1][0] == f"'{text}"
    assert [text_of(row[0]) for row in rows] == [text, text, "-5.2", "FIC101"]
    assert [row[1] for row in rows] == ["n", "-1.0", "2.0", "3.0"]
    loop = PlantLoop(text.strip(), op=text.strip(), pv="PV", where="-a.csv")
    again = parse_loop_list(loop_list_text([loop])).loops[0]
    assert (again.tag, again.op, again.where) == (loop.tag, loop.op, loop.where)
