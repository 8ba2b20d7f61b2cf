"""MAT files: vectors of the file or of its only struct."""

import numpy as np
import pytest
from scipy.io import savemat

from lostmotion import files
from lostmotion.errors import ColumnError, DataError

N = 50
SIGNALS = {"OP": np.linspace(40.0, 60.0, N), "PV": np.sin(np.arange(N)), "SP": np.zeros(N)}


def saved(tmp_path, content, **settings):
    path = tmp_path / "FIC-101.mat"
    savemat(path, content, **settings)
    return path


def assert_signals(record):
    for name, values in SIGNALS.items():
        np.testing.assert_array_equal(getattr(record, name.lower()), values)


@pytest.mark.parametrize("settings", [{}, {"do_compression": True}, {"oned_as": "column"}])
def test_vectors_of_the_file(tmp_path, settings):
    path = saved(tmp_path, SIGNALS | {"t": 0.5 * np.arange(N)}, **settings)
    record = files.read_loop(path)
    assert_signals(record)
    assert (record.dt, record.tag, record.notes) == (0.5, "FIC-101", ())


def test_struct_with_its_sampling_time_and_what_is_no_signal(tmp_path):
    loop = SIGNALS | {"Ts": 2.0, "Comments": "flow loop", "K": np.eye(3)}
    record = files.read_loop(saved(tmp_path, {"loop1": loop}))
    assert_signals(record)
    assert record.dt == 2.0
    assert "left out: 'Comments', 'K'" in record.notes[0]


def test_mode_as_words(tmp_path):
    mode = np.array(["AUTO"] * 40 + ["MAN"] * 10, dtype=object)
    record = files.read_loop(saved(tmp_path, {"a": SIGNALS | {"mode": mode}}), dt=1.0)
    assert record.mode is not None
    assert record.mode.tolist() == mode.tolist()


def test_whole_numbers_and_struct_in_struct(tmp_path):
    loop = {"OP": np.arange(N, dtype=np.int16), "PV": np.arange(N, dtype=np.uint8)}
    record = files.read_loop(saved(tmp_path, {"data": {"chemicals": {"loop1": loop}}}), dt=1.0)
    np.testing.assert_array_equal(record.op, np.arange(N))
    assert record.sp is None


def test_several_loops_are_refused_by_name(tmp_path):
    path = saved(tmp_path, {"data": {"loop1": SIGNALS, "loop2": SIGNALS}})
    with pytest.raises(DataError, match=r"2 structs with vectors: data\.loop1, data\.loop2; save the fields"):
        files.read_loop(path, dt=1.0)


def test_array_of_structs_is_several_loops(tmp_path):
    loops = np.array([(SIGNALS["OP"], SIGNALS["PV"])] * 2, dtype=[("OP", object), ("PV", object)])
    with pytest.raises(DataError, match=r"loops\(1\), loops\(2\)"):
        files.read_loop(saved(tmp_path, {"loops": loops}), dt=1.0)


def test_file_without_vectors(tmp_path):
    with pytest.raises(DataError, match="vectors of one length"):
        files.read_loop(saved(tmp_path, {"x": 1.0, "name": "a"}))


def test_column_that_is_not_there(tmp_path):
    with pytest.raises(ColumnError, match="PV"):
        files.read_loop(saved(tmp_path, {"OP": SIGNALS["OP"], "flow": SIGNALS["PV"]}), dt=1.0)


def test_days_of_matlab_are_not_taken_as_seconds(tmp_path):
    days = 738000.0 + np.arange(N) / 86400.0
    record = files.read_loop(saved(tmp_path, SIGNALS | {"time": days}))
    assert record.dt == 1.0
    assert "day numbers of MATLAB" in record.notes[-1]


def test_damaged_and_newer_files(tmp_path):
    path = saved(tmp_path, SIGNALS)
    path.write_bytes(path.read_bytes()[:700])
    with pytest.raises(DataError, match=r"a whole MAT file, got a damaged one, 'FIC-101\.mat'"):
        files.read_loop(path, dt=1.0)
    path.write_bytes(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(128) + b"\x89HDF")
    with pytest.raises(DataError, match="'-v7'"):
        files.read_loop(path)
