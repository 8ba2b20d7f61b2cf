"""Readers in a process of their own: what they hand over, and what is said when they die."""

import json
import os
import struct
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from lostmotion.errors import DataError
from lostmotion.files import apart, limits, read_loop
from lostmotion.files.apart import ReaderDiedError, leaves_apart, leaves_of
from lostmotion.files.child import HDF5, MARK, SHEETS, _leaf, _packed
from tests.hostile_files import bases, contained

DIES = {
    "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)": "it stops its reader by SIGSEGV",
    "import os; os.abort()": "it stops its reader by SIGABRT",
    "raise SystemExit(3)": "its reader ended with 3",
    "print('hello')": "no answer of its reader",
    "": "no answer of its reader",
}


def script(patch, folder, text):
    path = folder / "reader.py"
    path.write_text(text)
    patch.setattr(apart, "_CHILD", str(path))


@pytest.mark.parametrize(("text", "said"), DIES.items())
def test_a_reader_that_dies_is_one_line(monkeypatch, tmp_path, text, said):
    script(monkeypatch, tmp_path, text)
    (tmp_path / "a.mat").write_bytes(bases("mat 7.3")[0])
    with pytest.raises(DataError) as caught:
        read_loop(tmp_path / "a.mat", dt=1.0)
    assert str(caught.value) == f"expected a whole MAT file, got a damaged one, 'a.mat' ({said}); save it again"


def test_a_reader_that_does_not_come_to_an_end(monkeypatch, tmp_path):
    script(monkeypatch, tmp_path, "import time; time.sleep(60)")
    monkeypatch.setenv(limits.MOST_SECONDS, "0.5")
    start = time.monotonic()
    with pytest.raises(ReaderDiedError, match=r"not read within 0\.5 s; LOSTMOTION_MOST_SECONDS allows more"):
        leaves_apart(HDF5, b"")
    assert time.monotonic() - start < 20


def test_a_reader_that_cannot_be_started(monkeypatch):
    monkeypatch.setattr(sys, "executable", "/nowhere/python")
    with pytest.raises(ReaderDiedError, match="no process for its reader"):
        leaves_apart(HDF5, b"")


def test_sectors_that_lead_in_a_circle_end_at_the_limit_of_memory(tmp_path):
    """The second sector of the stream leads to the first: the reader gathers them until there is no memory."""
    pytest.importorskip("fastexcel")
    raw = bytearray(contained(bytes(5000)))
    place = len(raw) - 512 + 4 * 1
    raw[place : place + 4] = struct.pack("<I", 0)
    raw[48:52] = struct.pack("<I", 0)  # the folder is looked for in the circle
    (tmp_path / "a.xls").write_bytes(raw)
    with pytest.raises(DataError, match="got a damaged one") as caught:
        read_loop(tmp_path / "a.xls")
    assert "\n" not in str(caught.value)


def test_what_a_reader_finds_wrong_is_said():
    pytest.importorskip("h5py")
    with pytest.raises(ReaderDiedError, match="OSError: Unable to"):
        leaves_apart(HDF5, bytes(3000))


def test_modules_of_the_working_folder_are_not_run(monkeypatch, tmp_path):
    pytest.importorskip("fastexcel")
    (tmp_path / "numpy.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'w')")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", ["", *sys.path])
    (name, cells), *more = leaves_apart(SHEETS, bases("xlsx")[0])
    assert (name, cells[:6], more) == ("S1", b"Trend\t", [])
    assert not (tmp_path / "ran").exists()


def test_values_come_back_as_they_were():
    values = {
        "f8": np.array([1.5, np.nan]), "i2": np.array([1, -2], dtype="i2"), "big": np.array([3, 4], dtype=">u4"),
        "bool": np.array([True, False]), "half": np.array([0.5, 2], dtype="f2"), "one": np.float64(2.0), "text": "a\nb",
        "texts": np.array(["AUTO", "MAN"]), "bytes": b"\0\1", "matrix": np.eye(2), "complex": np.array([1j, 2]),
    }  # fmt: skip
    told = [(name, *_leaf(value)) for name, value in values.items()]
    found = dict(leaves_of(_packed({"leaves": [leaf[:3] for leaf in told]}, *(leaf[3] for leaf in told))))
    assert list(found) == list(values)
    for name in ("f8", "i2", "big", "bool", "half", "texts"):
        np.testing.assert_array_equal(found[name], values[name])
    assert found["i2"].dtype == np.int16
    assert (found["one"].tolist(), found["text"], found["bytes"]) == ([2.0], "a\nb", b"\0\1")
    assert found["matrix"] is None
    assert found["complex"] is None


NO_ANSWERS = (
    [], {}, {"leaves": 1}, {"leaves": [1]}, {"leaves": [["a"]]}, {"leaves": [["a", "f8", 2]]}, None,
    {"leaves": [["a", "f8", -1]]}, {"leaves": [["a", "f8", 1e9]]}, {"leaves": [["a", "texts", 3]]},
    {"leaves": [["a", [], 1]]}, {"error": "memory"},
    {"leaves": [["a", "f8", 10**30]]}, {"leaves": None},
)  # fmt: skip


@pytest.mark.parametrize("told", NO_ANSWERS, ids=str)
def test_a_reader_gone_wrong_may_say_anything(told):
    with pytest.raises(ReaderDiedError):
        leaves_of(_packed(told))


@pytest.mark.parametrize("answer", [b"", MARK, MARK + b"\xff" * 8, MARK + bytes(8), MARK + bytes([9]) + bytes(20)])
def test_half_an_answer(answer):
    with pytest.raises(ReaderDiedError):
        leaves_of(answer)


def test_deep_answers():
    text = b'{"leaves": ' + b"[" * 100_000
    with pytest.raises(ReaderDiedError):
        leaves_of(MARK + struct.pack("<Q", len(text)) + text)


@pytest.mark.skipif(sys.platform == "win32", reason="no resource limits")
def test_its_limits_hold(monkeypatch, tmp_path):
    """The reader cannot write a file, nor take more memory or time than said."""
    child = Path(apart.__file__).with_name("child.py")
    here = json.dumps(str(tmp_path / "written"))
    text = f"""
import runpy, sys
made = runpy.run_path({str(child)!r})
made["limit"](int(sys.argv[2]), int(sys.argv[3]))
said = []
for work in (lambda: open({here}, "w").write("x" * 10**6), lambda: bytes(10**11)):
    try:
        work()
        said.append("done")
    except (OSError, MemoryError) as error:
        said.append(type(error).__name__)
sys.stdout.buffer.write(made["_packed"]({{"error": ", ".join(said)}}))
"""
    script(monkeypatch, tmp_path, text)
    with pytest.raises(ReaderDiedError, match="OSError, MemoryError"):
        leaves_apart(HDF5, b"")
    assert os.path.getsize(tmp_path / "written") == 0  # noqa: PTH202
