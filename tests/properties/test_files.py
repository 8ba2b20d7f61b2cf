import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from lostmotion import files
from lostmotion.errors import DataError

numbers = st.floats(-1e9, 1e9).map(lambda value: value + 0.0) | st.just(float("nan"))
tables = st.integers(2, 30).flatmap(lambda n: hnp.arrays(np.float64, (n, 3), elements=numbers))
styles = st.sampled_from([(",", "."), (";", "."), ("\t", "."), (";", ","), ("\t", ",")])


@pytest.mark.long
@given(tables, st.sampled_from([".csv", ".txt", ".tsv", ".parquet"]), st.floats(1e-3, 1e4))
def test_write_then_read(values, suffix, dt):
    op, pv, sp = values.T
    columns = {"time": np.arange(len(op)), "OP": op, "PV": pv, "SP": sp}  # a counter: dt is given
    with tempfile.TemporaryDirectory() as folder:
        record = files.read_loop(files.write_columns(Path(folder) / f"a{suffix}", columns), dt=dt)
    assert record.dt == dt
    for signal, column in zip((record.op, record.pv, record.sp), (op, pv, sp), strict=True):
        np.testing.assert_array_equal(signal, column)


@given(tables, styles, st.sampled_from(["\n", "\r\n", "\r"]), st.sampled_from(["utf-8", "utf-8-sig", "utf-16"]))
def test_any_delimiter_mark_and_line_end(values, style, end, encoding):
    delimiter, decimal = style
    rows = [["OP", "PV", "SP"], *([cell(value, decimal) for value in row] for row in values)]
    text = end.join(delimiter.join(row) for row in rows)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.csv"
        path.write_bytes(text.encode(encoding))
        record = files.read_loop(path, dt=1.0)
    for signal, column in zip((record.op, record.pv, record.sp), values.T, strict=True):
        np.testing.assert_array_equal(signal, column)


def cell(value, decimal):
    return "Bad" if np.isnan(value) else repr(float(value)).replace(".", decimal)


@given(st.integers(5, 200), st.sampled_from([0.01, 0.1, 0.5, 1.0, 2.5, 12.0, 60.0]), st.integers(2, 30_000))
def test_time_column_gives_dt_back(n, dt, start):
    times = start + dt * np.arange(n)
    with tempfile.TemporaryDirectory() as folder:
        path = files.write_columns(Path(folder) / "a.csv", {"time": times, "OP": times, "PV": times})
        record = files.read_loop(path)
    assert record.gaps == ()
    np.testing.assert_allclose(record.dt, dt, rtol=1e-5)


def read_or_refuse(path, **settings):
    """Message of the refusal, which is of the documented kind; empty where the record was read."""
    try:
        files.read_loop(path, **settings)
    except DataError as error:
        return str(error)
    return ""


@given(st.binary(max_size=300))
def test_any_bytes_are_read_or_refused_by_name(raw):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.csv"
        path.write_bytes(raw)
        assert read_or_refuse(path, dt=1.0)[:9] in ("", "expected ")


@given(st.text(alphabet="OPVtime,;\t\"'#01.\n\r-/: ", max_size=200))
def test_any_text_is_read_or_refused_by_name(text):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.csv"
        path.write_text("time,OP,PV\n" + text)
        assert read_or_refuse(path)[:9] in ("", "expected ")
