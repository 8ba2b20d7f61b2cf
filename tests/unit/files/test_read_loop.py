from datetime import date

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest

from lostmotion import files
from lostmotion.errors import ColumnError, DataError, FileAccessError, InputError

ROWS = [(0.0, 50.5, 1.25, 2.0), (0.5, 51.5, 1.5, 2.0), (1.0, 52.5, -1.75, 2.5)]


def read(tmp_path, content, name="loop.csv", **settings):
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return files.read_loop(path, **settings)


def table(delimiter=",", decimal=".", end="\n", quote=""):
    cells = [["time", "OP", "PV", "SP"], *([str(x).replace(".", decimal) for x in row] for row in ROWS)]
    return end.join(delimiter.join(f"{quote}{cell}{quote}" for cell in row) for row in cells) + end


def assert_rows(record):
    np.testing.assert_array_equal(record.op, [row[1] for row in ROWS])
    np.testing.assert_array_equal(record.pv, [row[2] for row in ROWS])
    np.testing.assert_array_equal(record.sp, [row[3] for row in ROWS])
    assert record.dt == 0.5


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r", "\r\r\n"])
@pytest.mark.parametrize(
    ("delimiter", "decimal", "quote"),
    [
        (",", ".", ""),
        (";", ".", ""),
        ("\t", ".", ""),
        (";", ",", ""),
        ("\t", ",", ""),
        (",", ",", '"'),
        (";", ",", '"'),
    ],
)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1", "utf-16"])
def test_text_formats(tmp_path, delimiter, decimal, quote, end, encoding):
    assert_rows(read(tmp_path, table(delimiter, decimal, end, quote).encode(encoding)))


def test_tag_and_source(tmp_path):
    record = read(tmp_path, table(), name="FIC-101.csv")
    assert (record.tag, record.source, record.notes) == ("FIC-101", "FIC-101.csv", ())
    assert files.read_loop(str(tmp_path / "FIC-101.csv"), tag="A").tag == "A"


def test_spans_are_kept(tmp_path):
    record = read(tmp_path, table(), op_span=(0, 100), pv_span=(-5, 5))
    assert (record.op_span, record.pv_span) == ((0, 100), (-5, 5))


def test_latin_1_header(tmp_path):
    record = read(tmp_path, "time,OP,Ölstand °C\n0,1,2\n1,2,3\n".encode("latin-1"), pv="Ölstand °C")
    np.testing.assert_array_equal(record.pv, [2, 3])


def test_comments_blank_lines_and_trailing_delimiters(tmp_path):
    content = "# made by x\n\n" + table().replace("\n", ",\n") + "\n,,,,\n# end, of, file\n\n"
    assert_rows(read(tmp_path, content))


def test_header_in_a_comment(tmp_path):
    assert_rows(read(tmp_path, "# " + table()))


def test_comma_in_a_header_name(tmp_path):
    record = read(tmp_path, "t_s;Flow, m3/h;OP\n0;1,5;2\n1;2,5;3\n", pv="Flow, m3/h")
    np.testing.assert_array_equal(record.pv, [1.5, 2.5])


def test_row_of_empty_cells_is_a_missing_row(tmp_path):
    record = read(tmp_path, "OP\tPV\n1\t2\n\t\n3\t4\n", dt=1.0)
    np.testing.assert_array_equal(record.missing, [False, True, False])


@pytest.mark.parametrize("word", ["", "Bad", "NaN", "null", "No Data", "I/O Timeout", "bad INPUT", "#N/A", " "])
def test_bad_values_are_missing(tmp_path, word):
    record = read(tmp_path, f"time,OP,PV\n0,1,2\n1,2,{word}\n2,3,4\n")
    np.testing.assert_array_equal(record.pv, [2, np.nan, 4])
    assert word == "NaN" or any(word.strip() in note for note in record.notes)


def test_first_cell_that_looks_like_a_comment(tmp_path):
    record = read(tmp_path, "OP,PV\n1,2\n#N/A,3\n", dt=1.0)
    np.testing.assert_array_equal(record.op, [1, np.nan])


def test_missing_error_names_rows_and_times(tmp_path):
    with pytest.raises(DataError, match=r"a value of PV in every row, got 1 missing: 1 in row 2 \(line 3\)"):
        read(tmp_path, "time,OP,PV\n0,1,2\n1,2,Bad\n2,3,4\n", missing="error")
    with pytest.raises(ValueError, match="missing='keep' or 'error'"):
        read(tmp_path, table(), missing="drop")


def test_text_in_a_numeric_column(tmp_path):
    with pytest.raises(ColumnError, match=r"numbers in column 'PV', got 'open' in row 2 \(line 5\)"):
        read(tmp_path, "# c\ntime,OP,PV\n0,1,2\n\n1,2,open\n")
    with pytest.raises(ColumnError, match="units, delete it"):
        read(tmp_path, "time,OP,PV\n0,furlong,7\n0,1,2\n1,2,3\n")


def test_infinite(tmp_path):
    with pytest.raises(ColumnError, match=r"finite.*row 2 \(line 3\)"):
        read(tmp_path, "time,OP,PV\n0,1,2\n1,inf,3\n")
    with pytest.raises(ColumnError, match="finite"):
        files.read_loop(pl.DataFrame({"OP": [1.0, np.inf], "PV": [1.0, 2.0]}), dt=1)


def test_largest_float_as_filler(tmp_path):
    with pytest.raises(ColumnError, match=r"below 1e\+30 in column 'PV', got 3.4e\+38 in row 2"):
        read(tmp_path, "time,OP,PV\n0,1,2\n1,2,3.4e38\n")


def test_decimal_marks_that_cannot_be_told(tmp_path):
    with pytest.raises(ColumnError, match="one decimal mark"):
        read(tmp_path, "time;OP;PV\n0;1,5;2.5\n1;2,5;3.5\n")
    with pytest.raises(ColumnError, match="thousands separator"):
        read(tmp_path, 'time,OP,PV\n0,"1,500",2\n1,"2,500",3\n')
    with pytest.raises(ColumnError, match="numbers in column 'OP'"):
        read(tmp_path, "time;OP;PV\n0;1.234,5;2.5\n1;2.234,5;3\n")


@pytest.mark.parametrize(
    ("big", "bigger", "small"),
    [
        ("1.234,5", "1.234.567,5", "2,25"), ("1,234.5", "1,234,567.5", "2.25"), ("1 234,5", "1 234 567,5", "2,25"),
        ("1\u202f234,5", "1\u202f234\u202f567,5", "2,25"), ("1'234.5", "1'234'567.5", "2.25"),
    ],
)  # fmt: skip
def test_thousands_separators(tmp_path, big, bigger, small):
    record = read(tmp_path, f"time;OP;PV\n0;{big};{small}\n1;{bigger};{small}\n")
    assert record.op.tolist() == [1234.5, 1234567.5]
    assert record.pv.tolist() == [2.25, 2.25]


ROWS_3 = "10:00:00;1,5;2,5\n10:00:01;1,6;2,6\n10:00:02;1,7;2,7\n"


@pytest.mark.parametrize(
    ("top", "notes"),
    [
        ("Zeit;OP;PV\nhh:mm:ss;%;m3/h\n", ["Line 2 holds units"]),
        ("Zeit;OP;PV\n;Ventil;Durchfluss\n;%;t/h\n", ["Line 2 holds descriptions", "Line 3 holds units"]),
        ("Zeit;Ventil;Durchfluss\nTimestamp;FIC1.OUT;FIC1.PV\n", ["Line 1 was passed over"]),
        ("Trend of plant 1\nmade by x\n\nZeit;OP;PV\n", ["Lines 1 to 2 were passed over"]),
        ("Server;PI1\nFrom;2024-03-01;\nZeit;OP;PV\n[s];[%];[bar]\n", ["Lines 1 to 2 were", "Line 4 holds units"]),
    ],
)
def test_what_stands_above_the_rows(tmp_path, top, notes):
    record = read(tmp_path, top + ROWS_3)
    assert record.op.tolist() == [1.5, 1.6, 1.7]
    assert all(any(note in said for said in record.notes) for note in notes)


def test_a_header_that_stands_again(tmp_path):
    record = read(tmp_path, "t_s,OP,PV\n0,1,2\n1,2,3\nt_s,OP,PV\n2,3,4\n")
    assert record.op.tolist() == [1, 2, 3]
    assert "stands again in 1 line" in record.notes[0]


def test_decimal_comma_without_quotes_between_commas(tmp_path):
    with pytest.raises(DataError, match=r"3 fields as in the header, got 5 in line 2.*separate columns by ';'"):
        read(tmp_path, "time,OP,PV\n0,1,5,2,5\n1,2,5,3,5\n")


def test_one_field_too_many(tmp_path):
    with pytest.raises(DataError, match="got 4 in line 3"):
        read(tmp_path, "time,OP,PV\n0,1,2\n1,2,3,4\n")


def test_repeated_names_have_to_be_told_apart(tmp_path):
    content = "time,OP,PV,PV\n0,1,2,3\n1,2,3,4\n"
    with pytest.raises(ColumnError, match=r"PV \(1\)"):
        read(tmp_path, content)
    np.testing.assert_array_equal(read(tmp_path, content, pv="PV (2)").pv, [3, 4])


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "empty file"),
        (b" \n\r\n", "empty file"),
        (b"# only\n", "a header line and rows"),
        (b"time,OP,PV\n", "rows below the header"),
        (b"1,2,3\n4,5,6\n", "column names in the first line"),
        (b"just words\nmore\n", "columns separated by"),
        (b"\x00\x01\x02OP,PV", "binary file"),
        (b"PK\x03\x04....", "damaged"),
        (b"%PDF-1.7", "binary file"),
        (b"PAR1 broken", "damaged"),
    ],
)
def test_contents_that_are_no_table(tmp_path, content, said):
    with pytest.raises(DataError, match=said):
        read(tmp_path, content)


def test_paths_that_are_no_files(tmp_path):
    with pytest.raises(FileAccessError, match="no such file"):
        files.read_loop(tmp_path / "absent.csv")
    with pytest.raises(FileAccessError, match="folder"):
        files.read_loop(tmp_path)
    with pytest.raises(FileAccessError, match="readable"):
        files.read_loop(tmp_path / ("x" * 300))
    with pytest.raises(OSError, match="no such file"):
        files.read_loop(tmp_path / "absent.csv")


FRAME = pl.DataFrame(ROWS, schema=["time", "OP", "PV", "SP"], orient="row")


def test_frames():
    pandas = pd.DataFrame(FRAME.to_dict(as_series=False))
    for frame in (FRAME, pandas, pa.table(FRAME.to_dict(as_series=False))):
        record = files.read_loop(frame)
        assert_rows(record)
        assert record.tag == ""
        assert record.source.endswith("frame")


def test_pandas_index_of_dates():
    index = pd.date_range("2024-01-01", periods=3, freq="5s")
    frame = pd.DataFrame({"OP": [1, 2, 3], "PV": [1.0, None, 3.0]}, index=index)
    record = files.read_loop(frame)
    assert record.dt == 5.0
    np.testing.assert_array_equal(record.pv, [1, np.nan, 3])
    assert files.read_loop(frame.rename_axis("stamp"), time="stamp").dt == 5.0
    assert files.read_loop(frame.assign(time=[0.0, 2.0, 4.0])).dt == 2.0


def test_pandas_column_of_no_dates():
    """Its cells are not None, nor NaN."""
    rows = {"time": [0.0, 0.5, 1.0], "OP": [1.0, 2.0, 3.0], "PV": [1.0, 2.0, 4.0]}
    for mode in (pd.array([pd.NaT] * 3, dtype="datetime64[ns]"), [pd.NaT] * 3, [pd.NA] * 3):
        assert files.read_loop(pd.DataFrame(rows | {"Mode": mode})).mode.tolist() == [""] * 3


def test_single_row():
    with pytest.raises(DataError, match="at least 2 rows"):
        files.read_loop(FRAME.head(1))


def test_columns_of_odd_types():
    mixed = pd.DataFrame({"OP": ["1.5", 2, None], "PV": pd.array([1, None, 3], dtype="Int64")})
    record = files.read_loop(mixed, dt=1.0)
    np.testing.assert_array_equal(record.op, [1.5, 2, np.nan])
    np.testing.assert_array_equal(record.pv, [1, np.nan, 3])
    switch = pl.DataFrame({"OP": [True, False], "PV": [1, 2]})
    np.testing.assert_array_equal(files.read_loop(switch, dt=1.0).op, [1, 0])
    with pytest.raises(ColumnError, match="numbers in column 'OP', got Date"):
        files.read_loop(pl.DataFrame({"OP": [date(2024, 1, 1)] * 2, "PV": [1, 2]}), dt=1.0)


def test_frames_are_not_changed():
    before = FRAME.clone()
    files.read_loop(FRAME)
    assert FRAME.equals(before)


@pytest.mark.parametrize("source", [FRAME.lazy(), 5, None, [1, 2], FRAME["OP"]])
def test_no_frame(source):
    with pytest.raises(InputError, match="a path, an eager data frame"):
        files.read_loop(source)


def test_empty_frame_and_numbered_columns():
    with pytest.raises(DataError, match="expected rows"):
        files.read_loop(FRAME.head(0))
    with pytest.raises(DataError, match="column names as text"):
        files.read_loop(pd.DataFrame([[1, 2], [3, 4]]))


def test_parquet_by_content(tmp_path):
    FRAME.write_parquet(tmp_path / "a.dat")
    assert_rows(files.read_loop(tmp_path / "a.dat"))


@pytest.mark.parametrize("name", ["mode", "Mode", "LOOP_MODE", "auto/man", "A/M"])
def test_mode_column(tmp_path, name):
    record = read(tmp_path, f"time,OP,PV,{name}\n0,1,2,AUTO\n1,2,3, MAN \n2,3,4,\n")
    assert record.mode.tolist() == ["AUTO", "MAN", ""]


def test_mode_by_name_or_not_at_all(tmp_path):
    content = "time,OP,PV,state,mode\n0,1,2,3,A\n1,2,3,4,B\n"
    assert read(tmp_path, content, mode="state").mode.tolist() == ["3", "4"]
    assert read(tmp_path, content, mode=False).mode is None
    assert read(tmp_path, "time,OP,PV\n0,1,2\n1,2,3\n").mode is None


@pytest.mark.parametrize("blanks", [" ", "   ", " \t "])
@pytest.mark.parametrize("decimal", [".", ","])
def test_columns_that_blanks_separate(tmp_path, blanks, decimal):
    lines = ["time OP PV SP", *(" ".join(str(x).replace(".", decimal) for x in row) for row in ROWS)]
    text = "".join(f"  {line.replace(' ', blanks)}\n" for line in lines)
    record = read(tmp_path, text, name="loop.txt")
    assert_rows(record)


def test_blanks_do_not_separate_where_a_row_has_more_words(tmp_path):
    with pytest.raises(DataError, match="tab or blanks"):
        read(tmp_path, "time OP\n2024-01-01 10:00:00 1\n2024-01-01 10:00:01 2\n")
    with pytest.raises(DataError, match="numbers in line 1"):
        read(tmp_path, "0 1 2\n1 1 2\n2 1 2\n")


@pytest.mark.parametrize("delimiter", [",", ";", "\t", " "])
@pytest.mark.parametrize(("date", "clock"), [("Date", "Time"), ("DATE", "TIME"), ("day", "Clock")])
def test_dates_and_times_of_day_in_two_columns(tmp_path, delimiter, date, clock):
    cells = [("31.01.2024", "23:59:58"), ("31.01.2024", "23:59:59"), ("01.02.2024", "00:00:00")]
    lines = [(date, clock, "OP", "PV"), *((*cell, "1.5", str(row)) for row, cell in enumerate(cells))]
    record = read(tmp_path, "\n".join(delimiter.join(line) for line in lines))
    assert record.dt == 1.0
    assert f"Times were read from {date!r} and {clock!r} together." in record.notes


def test_dates_and_times_in_two_columns_of_a_frame_with_an_index_of_its_own():
    frame = pd.DataFrame(
        {"Date": ["2024-01-01"] * 3, "Time": ["10:00:00", "10:00:02", "10:00:04"], "OP": [1, 2, 3], "PV": [3, 4, 5]},
        index=[7, 7, 9],
    )
    assert files.read_loop(frame).dt == 2.0


def test_a_column_of_dates_stays_where_time_is_no_time_of_day_or_is_named(tmp_path):
    rows = [("2024-01-01", 0.5 * row, 1, row) for row in range(4)]
    lines = [("Date", "Time", "OP", "PV"), *rows]
    record = read(tmp_path, "\n".join(",".join(map(str, line)) for line in lines))
    assert (record.dt, record.notes) == (0.5, ())
    lines = [("Date", "Time", "OP", "PV"), *(("2024-01-01", f"10:00:0{row}", 1, row) for row in range(4))]
    named = read(tmp_path, "\n".join(",".join(map(str, line)) for line in lines), time="Time")
    assert (named.dt, named.notes) == (1.0, ())
