"""Parquet in partitions and in pieces: one table; files of other names stay records of their own."""

import shlex

import numpy as np
import polars as pl
import pytest

import lostmotion as lm
from lostmotion.errors import ColumnError, DataError
from tests.e2e.test_commands import run

N = 240
SIGNALS = pl.DataFrame(
    {
        "Timestamp": pl.datetime_range(
            pl.datetime(2024, 1, 31, 23, 58), pl.datetime(2024, 2, 1, 0, 1, 59), "1s", eager=True
        ),
        "OP": np.round(50 + 9 * np.sin(np.arange(N) / 7), 2),
        "PV": np.round(20 + 3 * np.cos(np.arange(N) / 7), 2),
    }
)


def put(path, frame):
    path.parent.mkdir(parents=True, exist_ok=True)
    frame.write_parquet(path)
    return path


def assert_whole(record):
    np.testing.assert_array_equal(record.op, SIGNALS["OP"])
    np.testing.assert_array_equal(record.pv, SIGNALS["PV"])
    assert (record.dt, record.gaps) == (1.0, ())


@pytest.mark.parametrize("keys", [("year=2024/month=1", "year=2024/month=2"), ("date=2024-01-31", "date=2024-02-01")])
def test_partitions_by_date(tmp_path, keys):
    for key, rows in zip(keys, (SIGNALS[:120], SIGNALS[120:]), strict=True):
        put(tmp_path / "FIC101" / key / "part-0.parquet", rows)
    for source in (tmp_path / "FIC101", tmp_path / "FIC101" / "**" / "*.parquet"):
        record = lm.read_loop(source, tag="FIC101")
        assert_whole(record)
        assert "Joined from 2 Parquet files" in record.notes[0]


@pytest.mark.parametrize("names", [("part-0", "part-1"), ("flow_2024-01", "flow_2024-02"), ("000", "001")])
def test_pieces_in_a_folder_and_by_a_pattern(capsys, tmp_path, names):
    for name, rows in zip(names, (SIGNALS[:120], SIGNALS[120:]), strict=True):
        put(tmp_path / "FIC101" / f"{name}.parquet", rows)
    assert_whole(lm.read_loop(tmp_path / "FIC101"))
    assert_whole(lm.read_loop(tmp_path / "FIC101" / "*.parquet"))
    code, text, error = run(capsys, "check", tmp_path / "FIC101")
    assert (code, error) == (0, "")
    assert "loop 'FIC101', a flow loop by its tag: 240 samples" in text


def test_partitions_by_loop_are_loops(capsys, tmp_path):
    for tag, rows in (("FIC101", SIGNALS), ("PIC102", SIGNALS[::-1])):
        for month, part in ((1, rows[:120]), (2, rows[120:])):
            put(tmp_path / f"loop={tag}" / f"month={month}" / "a.parquet", part)
    with pytest.raises(ColumnError, match="2 loops: FIC101, PIC102"):
        lm.read_loop(tmp_path)
    found = lm.read_loops(tmp_path)
    assert list(found) == ["FIC101", "PIC102"]
    for record in found.values():
        assert_whole(record)
    text = run(capsys, "check", tmp_path)[1]
    command = next(line for line in text.splitlines() if line.startswith("    lostmotion check"))
    assert "loop 'FIC101'" in run(capsys, *shlex.split(command)[1:])[1]


def test_partitions_of_tags_are_a_long_table(tmp_path):
    for role in ("OP", "PV"):
        values = SIGNALS.select(pl.col("Timestamp"), pl.col(role).alias("Value"))
        put(tmp_path / f"tag=FIC101.{role}" / "a.parquet", values)
    assert_whole(lm.read_loop(tmp_path))


def test_a_file_for_each_tag_or_loop_is_no_piece(tmp_path):
    for role in ("OP", "PV"):
        values = SIGNALS.select(pl.col("Timestamp"), pl.col(role).alias("Value"))
        put(tmp_path / "tags" / f"FIC101_{role}.parquet", values)
    assert_whole(lm.read_loop(tmp_path / "tags"))
    for tag in ("FIC101", "FIC102"):
        put(tmp_path / "loops" / f"{tag}.parquet", SIGNALS)
    assert list(lm.read_loops(tmp_path / "loops")) == ["FIC101", "FIC102"]
    with pytest.raises(DataError, match="give one of them"):
        lm.read_loop(tmp_path / "loops")


def test_pieces_of_different_columns(tmp_path):
    put(tmp_path / "part-0.parquet", SIGNALS[:120])
    put(tmp_path / "part-1.parquet", SIGNALS[120:].rename({"OP": "CO"}))
    with pytest.raises(DataError, match="whole Parquet files of the same columns"):
        lm.read_loop(tmp_path)


def test_feather_files(tmp_path):
    SIGNALS.write_ipc(tmp_path / "FIC101.feather")
    assert_whole(lm.read_loop(tmp_path / "FIC101.feather"))
