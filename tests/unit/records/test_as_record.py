"""Paths and frames wherever a record is taken, and records that are cut like lists."""

import numpy as np
import pandas as pd
import pytest

import lostmotion as lm
from lostmotion.errors import ParameterError
from lostmotion.evaluate import random_faulty_loop
from lostmotion.records import LoopRecord
from lostmotion.records.as_record import as_record, as_records

RECORD = LoopRecord(np.arange(100.0), -np.arange(100.0), dt=2.0, gaps=(50,), tag="<FIC-1>", notes=("a & b",))


def test_paths_frames_and_records(tmp_path):
    frame = pd.DataFrame({"t_s": np.arange(10), "CO": np.arange(10), "PV": np.arange(10)})
    path = tmp_path / "FIC-1.csv"
    frame.to_csv(path, index=False)
    for source in (path, str(path), frame):
        np.testing.assert_array_equal(as_record(source).op, np.arange(10))
    assert as_record(RECORD) is RECORD
    assert as_record(path, dt=1.0, tag="X").tag == "X"
    assert [type(one) for one in as_records([path, RECORD, frame])] == [LoopRecord] * 3
    array = np.arange(3)
    assert as_records(array) is array
    assert as_records(RECORD) is RECORD


def test_rows_as_of_a_list():
    np.testing.assert_array_equal(RECORD[10:20].op, np.arange(10.0, 20.0))
    assert RECORD[40:60].gaps == (10,)
    np.testing.assert_array_equal(RECORD[-5:].pv, -np.arange(95.0, 100.0))
    np.testing.assert_array_equal(RECORD.between(20, 40).op, np.arange(10.0, 20.0))
    for rows in (3, slice(0, 10, 2)):
        with pytest.raises(ParameterError, match="start:stop"):
            RECORD[rows]


def test_html_of_a_record_is_escaped():
    text = RECORD._repr_html_()
    assert "&lt;FIC-1&gt;" in text
    assert "a &amp; b" in text


@pytest.mark.statistics
def test_paths_and_frames_are_identified_and_diagnosed(tmp_path):
    loop = random_faulty_loop(4, cause="stiction", process="flow")
    path = tmp_path / "FIC-7.csv"
    frame = pd.DataFrame({"t_s": np.arange(loop.op.size), "OP": loop.op, "PV": loop.pv, "SP": loop.sp})
    frame.to_csv(path, index=False)
    found = lm.diagnose(path)
    assert (found.verdict, found.performance.loop_type) == ("stiction", "flow")  # the tag says so
    assert lm.diagnose(frame).verdict == lm.diagnose(str(path)).verdict == "stiction"
    assert lm.identify(path, nonlinearity="none").parameters == lm.identify(frame, nonlinearity="none").parameters
