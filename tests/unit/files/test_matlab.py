"""MAT files: vectors of the file or of its only struct."""

import shlex
import sys

import numpy as np
import pytest
from scipy.io import savemat

from lostmotion import files
from lostmotion.errors import ColumnError, DataError
from tests.e2e.test_commands import run

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


def test_several_loops_are_read_by_name(capsys, tmp_path):
    shorter = {name: values[:-9] for name, values in SIGNALS.items()} | {"Ts": 3.0}
    edges = {"x": [1, 2], "y": [1, 2]}
    path = saved(tmp_path, {"data": {"loop1": SIGNALS | {"Ts": 1.0}, "loop2": shorter, "edges": edges}})
    with pytest.raises(ColumnError, match=r"2 loops: data\.loop1, data\.loop2; name one: loop='data\.loop") as caught:
        files.read_loop(path)
    for way, length in zip(caught.value.ways, (N, N - 9), strict=True):
        record = files.read_loop(path, **way)
        assert (len(record), record.tag) == (length, way["loop"])
    record = files.read_loop(path, loop="Loop2")
    assert (len(record), record.tag) == (N - 9, "data.loop2")
    with pytest.raises(ColumnError, match=r"a loop 'loop3', got data\.loop1, data\.loop2; name one"):
        files.read_loop(path, loop="loop3")
    assert [one.dt for one in files.read_loops(path).values()] == [1.0, 3.0]
    code, text, _ = run(capsys, "check", path)
    assert code == 1
    assert "OP OP, PV PV, SP SP" in text
    command = next(line for line in text.splitlines() if line.startswith("    lostmotion check"))
    assert "loop 'data.loop1'" in run(capsys, *shlex.split(command)[1:])[1]
    error = run(capsys, "check", path, "--loop", "loop3")[2]
    commands = [shlex.split(line)[1:] for line in error.splitlines() if line.startswith("    lostmotion")]
    assert commands == [["check", str(path), "--loop", f"data.loop{number}"] for number in (1, 2)]
    for words in commands:
        assert run(capsys, *words)[2] == ""


def test_array_of_structs_is_several_loops(tmp_path):
    loops = np.array([(SIGNALS["OP"], SIGNALS["PV"])] * 2, dtype=[("OP", object), ("PV", object)])
    path = saved(tmp_path, {"loops": loops})
    with pytest.raises(ColumnError, match=r"loops\(1\), loops\(2\)"):
        files.read_loop(path, dt=1.0)
    assert list(files.read_loops(path, dt=1.0)) == ["loops(1)", "loops(2)"]


def test_structs_that_say_their_tag_are_called_by_it(tmp_path):
    path = saved(tmp_path, {"a": SIGNALS | {"Tag": "FIC101"}, "b": SIGNALS | {"Tag": "PIC102"}})
    found = files.read_loops(path, dt=1.0)
    assert [(record.tag, record.loop_type) for record in found.values()] == [("FIC101", "flow"), ("PIC102", "pressure")]


def test_the_only_struct_with_op_and_pv_is_read(tmp_path):
    record = files.read_loop(saved(tmp_path, {"loop": SIGNALS, "hist": {"x": [1, 2], "n": [3, 4]}}), dt=1.0)
    assert_signals(record)
    assert record.notes[0] == "OP and PV are in 'loop'; hist was left out."


def hdf5(path, content):
    """What save(.., '-v7.3') writes of structs, vectors, texts, cells and arrays of structs."""
    h5py = pytest.importorskip("h5py")

    def put(group, name, value):
        if isinstance(value, dict):
            inside = group.create_group(name)
            inside.attrs["MATLAB_class"] = np.bytes_("struct")
            for field, one in value.items():
                put(inside, field, one)
            return inside
        if isinstance(value, list):
            cell = isinstance(value[0], str)
            places = [put(file.require_group("#refs#"), f"{id(group)}{name}{k}", one) for k, one in enumerate(value)]
            if cell:
                item = group.create_dataset(name, (len(value), 1), h5py.ref_dtype)
                item[:, 0] = [one.ref for one in places]
                item.attrs["MATLAB_class"] = np.bytes_("cell")
                return item
            struct = group.create_group(name)
            struct.attrs["MATLAB_class"] = np.bytes_("struct")
            for field in value[0]:
                item = struct.create_dataset(field, (len(value), 1), h5py.ref_dtype)
                item[:, 0] = [one[field].ref for one in places]
            return struct
        text = isinstance(value, str)
        numbers = np.array([ord(sign) for sign in value], dtype=np.uint16) if text else np.atleast_1d(value)
        item = group.create_dataset(name, data=numbers.reshape(-1, 1) if text else numbers.reshape(1, -1))
        item.attrs["MATLAB_class"] = np.bytes_("char" if text else "double")
        return item

    with h5py.File(path, "w", userblock_size=512) as file:
        for name, value in content.items():
            put(file, name, value)
    raw = path.read_bytes()
    path.write_bytes(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(128) + raw[128:])
    return path


def test_version_7_3(tmp_path):
    path = tmp_path / "FIC-101.mat"
    mode = ["AUTO"] * 40 + ["MAN"] * 10
    record = files.read_loop(hdf5(path, SIGNALS | {"t": 0.5 * np.arange(N), "mode": mode, "about": "a flow"}))
    assert_signals(record)
    assert (record.dt, record.tag, record.mode.tolist()) == (0.5, "FIC-101", mode)
    assert "left out: 'about'" in record.notes[0]


def test_several_loops_of_version_7_3(tmp_path):
    path = hdf5(tmp_path / "plant.mat", {"data": {"a": SIGNALS | {"Ts": 2.0}, "b": SIGNALS | {"Ts": 4.0}}})
    assert [one.dt for one in files.read_loops(path).values()] == [2.0, 4.0]
    assert_signals(files.read_loop(path, loop="b"))
    path = hdf5(tmp_path / "array.mat", {"loops": [SIGNALS | {"tag": "FIC1"}, SIGNALS | {"tag": "FIC2"}]})
    found = files.read_loops(path, dt=1.0)
    assert list(found) == ["FIC1", "FIC2"]
    assert_signals(found["FIC2"])


def test_version_7_3_without_its_reader(tmp_path, monkeypatch):
    path = tmp_path / "a.mat"
    path.write_bytes(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(128) + b"\x89HDF")
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(DataError, match=r'pip install "lostmotion\[matlab\]", or save it with save'):
        files.read_loop(path)


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
    pytest.importorskip("h5py")
    with pytest.raises(DataError, match="a whole MAT file"):
        files.read_loop(path)
