"""Changed files of every format: a record or one line, and nothing on standard error. The long form is
benchmarks/hostile_readers.py."""

import sys
from pathlib import Path

import narwhals.stable.v2 as nw
import numpy as np
import pandas as pd
import polars as pl
import pytest

from lostmotion.errors import DataError, FileAccessError, TimeError
from lostmotion.files import limits, read_loop
from tests.support.hostile_files import FORMATS, FRAMES, OP, PV, TIMES, bases, mutant, odd_frame, text
from tests.support.packed_files import zipped
from tests.support.use_of_files import outcome

EACH = 25
NEEDS = {"xlsx": "fastexcel", "xls": "fastexcel", "mat 7.3": "h5py"}


@pytest.mark.sampled(4)
@pytest.mark.parametrize("kind", FORMATS)
def test_each_is_read_or_refused_in_one_line(kind, tmp_path, capfd):
    pytest.importorskip(NEEDS.get(kind, "numpy"))
    path = tmp_path / "FIC-101.dat"
    for number in range(EACH):
        path.write_bytes(mutant(kind, number))
        assert outcome(path) in ("read", "refused"), number
    assert capfd.readouterr().err == ""


def test_odd_frames():
    found = {number: outcome(odd_frame(number)) for number in range(EACH)}
    assert {said for said in found.values() if said not in ("read", "refused")} == set(), FRAMES


@pytest.mark.parametrize("cell", [[1.0, 2.0], {"a": 1}, b"\xff", None])
def test_modes_that_are_no_words(cell):
    """Lists were once an error of Polars."""
    frame = pl.DataFrame({"t_s": np.arange(20), "OP": OP[:20], "PV": PV[:20], "Mode": [cell] * 20})
    assert outcome(frame) in ("read", "refused")


@pytest.mark.parametrize("kind", FORMATS)
def test_what_is_changed_is_read_before(kind):
    pytest.importorskip(NEEDS.get(kind, "numpy"))
    assert bases(kind)
    assert mutant(kind, 3) == mutant(kind, 3)


ARCHIVES = {
    "IndexError": b"PK\x03\x04" + bytes(40),
    "a name that is no text": zipped({"a.csv": b"OP,PV\n1,2\n"}).replace(b"a.csv", b"\xc1.csv"),
    "a place before the beginning": zipped({"a.csv": b"OP,PV\n1,2\n"})[20:],
}


def test_members_without_a_name(tmp_path):
    """Once an IndexError of zipfile, where it asks whether they are folders."""
    sound = zipped({"a.csv": b"OP,PV\n1,2\n2,3\n", "\x01": b""})
    for raw in (mutant("xlsx", 671, seed=19), sound.replace(b"\x01", b"\x00")):
        (tmp_path / "a.zip").write_bytes(raw)
        assert outcome(tmp_path / "a.zip") in ("read", "refused")


@pytest.mark.parametrize("raw", ARCHIVES.values(), ids=ARCHIVES)
def test_archives(tmp_path, raw):
    (tmp_path / "a.zip").write_bytes(b"PK\x03\x04" + raw[4:])
    with pytest.raises(DataError):
        read_loop(tmp_path / "a.zip")


def test_a_list_longer_than_any_memory_in_parquet(tmp_path):
    """Polars ends the process at it."""
    (tmp_path / "a.parquet").write_bytes(mutant("parquet", 561, seed=5))
    with pytest.raises(DataError, match="expected a whole Parquet file, got a damaged one"):
        read_loop(tmp_path / "a.parquet")


@pytest.mark.parametrize("tag", ["Time", "Tag", "Value", "null", "tag"])
def test_tags_called_as_columns_are(tmp_path, tag):
    """Once a DuplicateError of Polars, or the values of a tag instead of the times."""
    rows = [(name, f"10:00:{k:02d}", k % 7) for k in range(20) for name in ("F1.OP", "F1.PV", tag)]
    for cells in (rows, sorted(rows, key=lambda row: row[0])):
        (tmp_path / "a.csv").write_bytes(text("Tag,Time,Value", cells))
        if tag == "Time":
            with pytest.raises(DataError, match="expected tags with names of their own, got one called 'Time'"):
                read_loop(tmp_path / "a.csv")
        else:
            assert len(read_loop(tmp_path / "a.csv")) == 20


def test_one_time_of_each_tag_and_qualities_as_long_as_a_book(tmp_path):
    """Once a mean of nothing, and a number too large for a float."""
    path = tmp_path / "a.csv"
    path.write_bytes(text("Tag,Time,Value", [("F1.OP", "10:00:00", 1), ("F1.PV", "10:00:00", 2)] * 3))
    assert outcome(path) == "refused"
    rows = [(name, f"10:00:{k:02d}", k, "9" * 400 if k == 5 else "Good") for k in range(20) for name in ("OP", "PV")]
    path.write_bytes(text("Tag,Time,Value,Status", rows))
    assert outcome(path) == "read"


@pytest.mark.parametrize("unit", ["us", "ms"])
def test_dates_out_of_the_calendar(unit):
    frame = pl.DataFrame(
        {"time": pl.Series([2**60, 2**60 + 10**6]).cast(pl.Datetime(unit)), "OP": [1, 2], "PV": [1, 2]}
    )
    with pytest.raises(
        TimeError, match=r"dates of the years 1 to 9999 in column 'time', got 2 others, the first in row 1"
    ):
        read_loop(frame)


def test_columns_of_one_name():
    frame = pd.DataFrame([[1, 2], [3, 4]], columns=["OP", "OP"])
    with pytest.raises(DataError, match="expected a data frame whose columns have names of their own") as caught:
        read_loop(frame)
    assert "\n" not in str(caught.value)
    assert issubclass(nw.exceptions.DuplicateError, nw.exceptions.NarwhalsError)


@pytest.mark.skipif(sys.platform == "win32", reason="no pipes with names")
def test_pipes_and_devices_are_not_waited_for(tmp_path):
    import os

    os.mkfifo(tmp_path / "a.csv")
    for path in (tmp_path / "a.csv", Path("/dev/zero"), Path("/dev/null")):
        with pytest.raises(FileAccessError, match="got a pipe or a device"):
            read_loop(path)


def wide(columns, name="c{}"):
    head = ",".join(["t_s", "OP", "PV", *(name.format(k) for k in range(columns))])
    return text(head, ([k, k % 7, k % 5, *[1] * columns] for k in range(4)))


def test_a_header_of_two_hundred_thousand_characters(tmp_path):
    (tmp_path / "a.csv").write_bytes(wide(1, "x" * 200_000 + "{}"))
    assert len(read_loop(tmp_path / "a.csv")) == 4


def test_cells_of_millions_of_characters(tmp_path):
    path = tmp_path / "a.csv"
    path.write_bytes(wide(1) + b"4,1,2," + b"y" * 5_000_000 + b"\n")
    assert len(read_loop(path)) == 5
    path.write_bytes(wide(1) + b"4,1," + b"y" * 5_000_000 + b",1\n")
    with pytest.raises(DataError) as caught:
        read_loop(path)
    assert len(str(caught.value)) < 1500
    path.write_bytes(wide(1, "x" * 20_000_000 + "{}"))
    with pytest.raises(DataError, match="cells of text, got one that cannot be read"):
        read_loop(path)


def test_columns_and_bytes_are_limited_and_more_can_be_allowed(tmp_path, monkeypatch):
    path = tmp_path / "a.csv"
    path.write_bytes(wide(60))
    monkeypatch.setenv(limits.MOST_COLUMNS, "50")
    with pytest.raises(DataError, match=r"expected at most 50 columns, got 63; .* or set LOSTMOTION_MOST_COLUMNS"):
        read_loop(path)
    with pytest.raises(DataError, match="expected at most 50 columns"):
        read_loop(pl.DataFrame({f"c{k}": [1, 2] for k in range(60)}))
    monkeypatch.setenv(limits.MOST_COLUMNS, "70")
    assert len(read_loop(path)) == 4
    monkeypatch.setenv(limits.MOST_GIB, "1e-7")
    with pytest.raises(DataError, match=r"more than 1e-07 GiB in 'a\.csv'; cut the export, or set LOSTMOTION_MOST_GIB"):
        read_loop(path)


def test_line_ends_in_a_name_are_written_out():
    frame = pl.DataFrame({"x\ny\x1b[31m": [1.0, 2.0], "PV": [1.0, 2.0]})
    with pytest.raises(DataError) as caught:
        read_loop(frame, dt=1.0)
    assert not set("\n\x1b") & set(str(caught.value))


def test_the_bases_hold_the_same_record(tmp_path):
    for kind in ("csv", "parquet", "xls"):
        (tmp_path / "a.dat").write_bytes(bases(kind)[0])
        pytest.importorskip(NEEDS.get(kind, "numpy"))
        record = read_loop(tmp_path / "a.dat")
        np.testing.assert_array_equal(record.op, OP)
        np.testing.assert_array_equal(record.pv, PV)
        assert len(record) == len(TIMES)
