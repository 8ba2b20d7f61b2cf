"""Files as they are packed: gzip, zip, Feather, spreadsheets."""

import gzip
import io
import tracemalloc

import numpy as np
import polars as pl
import pytest

from lostmotion.errors import DataError
from lostmotion.files import limits, read_loop, read_loops
from tests.support.packed_files import tarred, workbook, zipped

TIMES = [f"2024-03-01 10:{k // 60:02d}:{k % 60:02d}" for k in range(200)]
FRAME = pl.DataFrame({"time": TIMES, "OP": np.arange(200) / 8, "PV": np.arange(200) / -4})
TEXT = FRAME.write_csv().encode()
ROWS = [["Trend"], ["time", "OP", "PV"], ["", "%", "bar"], *([t, float(o), float(p)] for t, o, p in FRAME.iter_rows())]


def feather():
    raw = io.BytesIO()
    FRAME.write_ipc(raw)
    return raw.getvalue()


@pytest.mark.parametrize(
    ("name", "raw"),
    [
        ("FIC-1.csv.gz", gzip.compress(TEXT)),
        ("FIC-1.csv.zip", zipped({"x/FIC-1.csv": TEXT, "__MACOSX/._x": b""})),
        ("FIC-1.feather", feather()),
    ],
)
def test_packed(tmp_path, name, raw):
    (tmp_path / name).write_bytes(raw)
    record = read_loop(tmp_path / name)
    np.testing.assert_array_equal(record.op, FRAME["OP"].to_numpy())
    assert (record.tag, record.dt, record.loop_type) == ("FIC-1", 1.0, "flow")


def test_damaged_spreadsheet_of_the_old_kind(tmp_path):
    path = tmp_path / "FIC-1.xls"
    path.write_bytes(bytes.fromhex("d0cf11e0a1b11ae1") + b"x" * 100)
    with pytest.raises(DataError, match=r"whole workbook|install lostmotion\[excel\]"):
        read_loop(path)


def test_spreadsheet(tmp_path):
    pytest.importorskip("fastexcel")
    path = tmp_path / "FIC-1.xlsx"
    path.write_bytes(workbook(ROWS, [["notes"]]))
    record = read_loop(path)
    np.testing.assert_array_equal(record.pv, FRAME["PV"].to_numpy())
    assert record.dt == 1.0
    path.write_bytes(workbook(ROWS, ROWS))
    with pytest.raises(DataError, match="one sheet with rows"):
        read_loop(path)
    path.write_bytes(workbook(ROWS)[:-400])
    with pytest.raises(DataError, match="damaged"):
        read_loop(path)


@pytest.mark.parametrize(
    ("raw", "said"),
    [
        (zipped({"a.pdf": TEXT, "b.doc": TEXT}), "files with tables in"),
        (tarred({"a.csv": TEXT, "b.csv": TEXT})[:-200], "a whole archive"),
        (gzip.compress(TEXT)[:-200], "a whole archive"),
        (feather()[:300], "a whole Feather file"),
    ],
)
def test_what_cannot_be_unpacked(tmp_path, raw, said):
    path = tmp_path / "a.bin"
    path.write_bytes(raw)
    with pytest.raises(DataError, match=said):
        read_loop(path)


def one_tag(name):
    return FRAME.select("time", name).rename({name: "Value"}).write_csv().encode()


TAGS = {"FIC-1_OP.csv": one_tag("OP"), "FIC-1_PV.csv.gz": gzip.compress(one_tag("PV")), "README.txt": b"two tags"}


@pytest.mark.parametrize(
    ("name", "raw"),
    [
        ("FIC-1.zip", zipped(TAGS)),
        ("week.tar.gz", tarred({f"export/{name}": content for name, content in TAGS.items()})),
        ("week.tgz", tarred(TAGS)),
        ("week.tar", tarred(TAGS, "w")),
        ("week.tar", tarred({"x/._FIC-1.csv": b"", "x/FIC-1.csv": TEXT}, "w")),
        ("week.zip", zipped({"FIC-1.csv": TEXT, "page.pdf": b""})),
    ],
)
def test_files_of_an_archive_are_those_of_a_folder(tmp_path, name, raw):
    (tmp_path / name).write_bytes(raw)
    record = read_loop(tmp_path / name)
    np.testing.assert_array_equal(record.op, FRAME["OP"].to_numpy())
    np.testing.assert_array_equal(record.pv, FRAME["PV"].to_numpy())
    assert (record.tag, record.dt, record.loop_type) == ("FIC-1", 1.0, "flow")
    assert str(record.start) == "2024-03-01 10:00:00"


@pytest.mark.parametrize("pack", [zipped, tarred])
def test_records_of_an_archive_are_loops(tmp_path, pack):
    path = tmp_path / "week.bin"
    path.write_bytes(pack({"mon/FIC-1.csv": TEXT, "mon/LIC-2.csv": TEXT, "tue/FIC-1.csv": TEXT}))
    assert list(read_loops(path)) == ["mon/FIC-1", "LIC-2", "tue/FIC-1"]
    record = read_loop(path, loop="LIC-2")
    np.testing.assert_array_equal(record.pv, FRAME["PV"].to_numpy())
    assert (record.tag, record.loop_type) == ("LIC-2", "level")


def with_size(raw, size):
    """The same archive, whose first member has another size in its head."""
    raw = bytearray(raw)
    raw[124:136] = size
    raw[148:156] = b" " * 8
    raw[148:156] = b"%06o\0 " % sum(raw[:512])
    return bytes(raw)


@pytest.mark.parametrize(
    "size", [b"\x80" + b"\xff" * 11, b"\xff" * 12, b"\x80\0\0\0\0" + b"\x7f" + b"\xff" * 6, b"7" * 12, b"x" * 12]
)
@pytest.mark.parametrize("packed", [bytes, gzip.compress])
def test_impossible_sizes_in_an_archive_are_damage(tmp_path, size, packed):
    path = tmp_path / "a.tar"
    path.write_bytes(packed(with_size(tarred({"a.csv": TEXT, "b.csv": TEXT}), size)))
    with pytest.raises(DataError, match=r"^expected "):
        read_loops(path)


@pytest.mark.parametrize("pack", [tarred, zipped])
def test_an_archive_takes_memory_as_it_needs_it(tmp_path, pack):
    path = tmp_path / "a.packed"
    path.write_bytes(pack({"a.csv": TEXT, "b.csv": TEXT}))
    read_loops(path)
    tracemalloc.start()
    read_loops(path)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 50e6  # and not the 8 GiB that a file may have


@pytest.mark.parametrize("packed", [bytes, gzip.compress])
def test_rows_that_take_more_memory_than_there_is_are_refused_before_they_are_parsed(tmp_path, monkeypatch, packed):
    path = tmp_path / "a.csv"
    path.write_bytes(packed(b"OP,PV\n" + b"1,1\n" * 100_000))
    assert len(read_loop(path, dt=1.0)) == 100_000
    monkeypatch.setenv("LOSTMOTION_MOST_GIB", "0.02")
    with pytest.raises(DataError, match=r"100,001 rows in 'a.csv', .*LOSTMOTION_MOST_GIB"):
        read_loop(path, dt=1.0)
    monkeypatch.delenv("LOSTMOTION_MOST_GIB")
    monkeypatch.setattr(limits, "_free_bytes", lambda: 1e7)
    with pytest.raises(DataError, match=r"0.0093 are free; .*larger computer"):
        read_loop(path, dt=1.0)


def test_columns_of_few_bytes_count_as_many_rows(tmp_path, monkeypatch):
    pl.DataFrame({"OP": [1.0] * 100_000, "PV": [1.0] * 100_000}).write_parquet(tmp_path / "a.parquet")
    monkeypatch.setenv("LOSTMOTION_MOST_GIB", "0.02")
    with pytest.raises(DataError):
        read_loop(tmp_path / "a.parquet", dt=1.0)
