"""Readers in a process of their own: what they hand over, what is said when they die, and what they leave: nothing."""

import json
import os
import signal
import struct
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from lostmotion.errors import DataError
from lostmotion.files import child, limits, read_loop, reader_process
from lostmotion.files.apart import leaves_apart, leaves_of
from lostmotion.files.child import FEATHER, HDF5, MARK, ONE, PARQUET, SHEETS, _leaf, _packed
from lostmotion.files.reader_process import KEPT, ReaderDiedError, ReaderProcess
from tests.support.hostile_files import bases, contained
from tests.support.killed import forked

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
    patch.setattr(reader_process, "_CHILD", str(path))


@pytest.fixture
def _anew():
    """None is kept from before, nor for what comes after."""
    KEPT.end()
    yield
    KEPT.end()


anew = pytest.mark.usefixtures("_anew")
linux = pytest.mark.skipif(sys.platform != "linux", reason="a process for each file there")


def alive(process):
    """Whether it runs; what nobody has waited for does not."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def gone(process, seconds=10.0):
    until = time.monotonic() + seconds
    while alive(process) and time.monotonic() < until:
        time.sleep(0.01)
    return not alive(process)


def forks_of(process):
    children = Path(f"/proc/{process}/task/{process}/children")
    return [int(one) for one in children.read_text().split()]


def waits(process, seconds=10.0):
    """Its fork, as soon as there is one."""
    until = time.monotonic() + seconds
    while not (found := forks_of(process)) and time.monotonic() < until:
        time.sleep(0.01)
    return found[0]


# A reader of this process that never comes to an end, for as long as its file is read.
ENDLESS = f"""
import runpy, sys, time
made = runpy.run_path({child.__file__!r}, run_name="child")
made["READERS"]["hdf5"] = lambda raw: time.sleep(600)
made["serve"](sys.argv[1], sys.stdin.buffer, sys.stdout.buffer)
"""


@anew
@pytest.mark.parametrize(("text", "said"), DIES.items())
def test_a_reader_that_dies_is_one_line(monkeypatch, tmp_path, text, said):
    script(monkeypatch, tmp_path, text)
    (tmp_path / "a.mat").write_bytes(bases("mat 7.3")[0])
    with pytest.raises(DataError) as caught:
        read_loop(tmp_path / "a.mat", dt=1.0)
    assert str(caught.value) == f"expected a whole MAT file, got a damaged one, 'a.mat' ({said}); save it again"


@anew
@pytest.mark.parametrize("text", ["import time; time.sleep(60)", ENDLESS])
def test_a_reader_that_does_not_come_to_an_end(monkeypatch, tmp_path, text):
    script(monkeypatch, tmp_path, text)
    monkeypatch.setenv(limits.MOST_SECONDS, "0.5")
    start = time.monotonic()
    with pytest.raises(ReaderDiedError, match=r"not read within 0\.5 s; LOSTMOTION_MOST_SECONDS allows more"):
        leaves_apart(HDF5, b"")
    assert time.monotonic() - start < 20


@anew
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


@anew
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


@anew
@pytest.mark.skipif(sys.platform == "win32", reason="no resource limits")
def test_its_limits_hold(monkeypatch, tmp_path):
    """The reader cannot write a file, nor take more memory or time than said."""
    here = json.dumps(str(tmp_path / "written"))
    text = f"""
import runpy, sys
made = runpy.run_path({child.__file__!r}, run_name="child")
def tried(raw):
    said = []
    for work in (lambda: open({here}, "w").write("x" * 10**6), lambda: bytes(10**11)):
        try:
            work()
            said.append("done")
        except (OSError, MemoryError) as error:
            said.append(type(error).__name__)
    raise ValueError(", ".join(said))
made["READERS"]["hdf5"] = tried
made["serve"](sys.argv[1], sys.stdin.buffer, sys.stdout.buffer)
"""
    script(monkeypatch, tmp_path, text)
    with pytest.raises(ReaderDiedError, match="ValueError: OSError, MemoryError"):
        leaves_apart(HDF5, b"")
    assert os.path.getsize(tmp_path / "written") == 0  # noqa: PTH202


@linux
@anew
def test_one_process_for_all_files(monkeypatch):
    pytest.importorskip("fastexcel")
    assert leaves_apart(PARQUET, bases("parquet")[0]) == []
    first = KEPT._process.pid
    for kind, raw in ((FEATHER, bases("feather")[0]), (SHEETS, bases("xlsx")[0]), (PARQUET, bases("parquet")[1])):
        leaves_apart(kind, raw)
    with pytest.raises(ReaderDiedError):
        leaves_apart(PARQUET, b"PAR1")
    leaves_apart(PARQUET, bases("parquet")[0])
    assert KEPT._process.pid == first
    assert forks_of(first) == []
    monkeypatch.setattr(reader_process, "_MOST_FILES", 6)
    leaves_apart(PARQUET, bases("parquet")[0])
    assert gone(first)
    leaves_apart(PARQUET, bases("parquet")[0])
    assert KEPT._process.pid != first


@linux
@anew
def test_it_is_forked_without_threads_that_work():
    """One of Polars is there from its import, and waits for what is spilled to a disk: nothing is."""
    leaves_apart(PARQUET, bases("parquet")[0])
    pytest.importorskip("h5py")
    leaves_apart(HDF5, bases("mat 7.3")[0])
    others = [one for one in Path(f"/proc/{KEPT._process.pid}/task").iterdir() if one.name != str(KEPT._process.pid)]
    assert {(one / "comm").read_text().strip() for one in others} <= {"polars-ooc-clea"}


@linux
@anew
def test_a_reader_that_dies_takes_no_other_with_it(monkeypatch, tmp_path):
    """Half of its answer is lost, and told as lost."""
    pytest.importorskip("h5py")
    text = f"""
import os, runpy, signal, sys
made = runpy.run_path({child.__file__!r}, run_name="child")
def dies(raw):
    if raw:
        os.kill(os.getpid(), signal.SIGSEGV)
    yield "a", b"x" * 3_000_000
made["READERS"]["hdf5"] = dies
made["serve"](sys.argv[1], sys.stdin.buffer, sys.stdout.buffer)
"""
    script(monkeypatch, tmp_path, text)
    ((_, found),) = leaves_apart(HDF5, b"")
    first = KEPT._process.pid
    with pytest.raises(ReaderDiedError, match="it stops its reader by SIGSEGV"):
        leaves_apart(HDF5, b"x")
    assert leaves_apart(HDF5, b"") == [("a", found)]
    assert (KEPT._process.pid, len(found)) == (first, 3_000_000)


@linux
@anew
def test_another_begins_where_one_was_killed():
    leaves_apart(PARQUET, bases("parquet")[0])
    first = KEPT._process.pid
    os.kill(first, signal.SIGKILL)
    assert gone(first)
    assert leaves_apart(PARQUET, bases("parquet")[0]) == []
    assert KEPT._process.pid != first


@linux
@anew
@pytest.mark.parametrize("ends", ["os.kill(os.getpid(), signal.SIGKILL)", "os._exit(3)", "os._exit(0)"])
def test_one_that_ends_when_it_is_asked_says_nothing_of_the_file(monkeypatch, tmp_path, ends):
    """It was killed, but its threads had not yet ended: the request went out, and nothing came back."""
    text = f"""
import os, runpy, signal, sys
made = runpy.run_path({child.__file__!r}, run_name="child")
made["READERS"]["hdf5"] = lambda raw: [("a", str(os.getppid()))]
class Requests:
    answered = 0
    def read(self, size):
        head = sys.stdin.buffer.read(size)
        if head and self.answered == 2:
            {ends}
        self.answered += 1
        return head
made["serve"]("many", Requests(), sys.stdout.buffer)
"""
    script(monkeypatch, tmp_path, text)
    found = [leaves_apart(HDF5, b"")[0][1] for _ in range(6)]
    assert found[::2] == found[1::2]
    assert len(set(found)) == 3


@anew
def test_a_process_for_each_file_where_there_are_no_forks(monkeypatch):
    monkeypatch.setattr(reader_process, "_HOW", ONE)
    for _ in range(2):
        assert leaves_apart(PARQUET, bases("parquet")[0]) == []
        assert KEPT._process is None
    with pytest.raises(ReaderDiedError):
        leaves_apart(PARQUET, b"PAR1")


@anew
def test_an_answer_larger_than_its_memory_is_none(monkeypatch, tmp_path):
    text = """
import struct, sys
sys.stdin.buffer.read(40)
for _ in range(3000):
    sys.stdout.buffer.write(struct.pack("<Q", 1 << 20) + bytes(1 << 20))
"""
    script(monkeypatch, tmp_path, text)
    with pytest.raises(ReaderDiedError, match="more memory than a file of its size may take"):
        KEPT.answer(HDF5, b"", 5 << 20, 30.0)
    assert KEPT._process is None


HOLDS = """
import sys
from lostmotion.files import apart, reader_process
if sys.argv[1] != "-":
    reader_process._CHILD = sys.argv[1]
    from threading import Thread
    Thread(target=apart.leaves_apart, args=("hdf5", b""), daemon=True).start()
    import time
    while reader_process.KEPT._process is None:
        time.sleep(0.01)
else:
    reader_process.KEPT._ready()
print(reader_process.KEPT._process.pid, flush=True)
sys.stdin.read()
"""


@linux
@pytest.mark.parametrize("reads", [False, True])
@pytest.mark.parametrize("how", ["kill -9", "its end"])
def test_it_ends_with_the_process_that_asks(tmp_path, reads, how):
    """Also while it reads, and with its fork."""
    (tmp_path / "reader.py").write_text(ENDLESS)
    words = [sys.executable, "-c", HOLDS, str(tmp_path / "reader.py") if reads else "-"]
    with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as asks:
        reader = int(asks.stdout.readline())
        inner = waits(reader) if reads else None
        assert alive(reader)
        if how == "kill -9":
            asks.kill()
        else:
            asks.stdin.close()
        assert asks.wait(20) in (0, -signal.SIGKILL)
        assert gone(reader)
        assert inner is None or gone(inner)


@linux
@anew
def test_a_fork_of_this_process_has_readers_of_its_own():
    leaves_apart(PARQUET, bases("parquet")[0])
    first = KEPT._process.pid

    def work():
        assert KEPT._process is None
        leaves_apart(PARQUET, bases("parquet")[0])
        assert KEPT._process.pid != first
        KEPT.end()

    assert forked(work) == 0
    leaves_apart(PARQUET, bases("parquet")[0])
    assert KEPT._process.pid == first


@anew
def test_threads_take_turns():
    pytest.importorskip("fastexcel")
    kinds = {SHEETS: bases("xlsx")[0], PARQUET: bases("parquet")[0]}
    expected = {kind: leaves_apart(kind, raw) for kind, raw in kinds.items()}
    found = []
    work = [
        threading.Thread(target=lambda kind=kind: found.append((kind, leaves_apart(kind, kinds[kind]))))
        for kind in (SHEETS, PARQUET) * 4
    ]
    for one in work:
        one.start()
    for one in work:
        one.join()
    assert len(found) == len(work)
    assert all(leaves == expected[kind] for kind, leaves in found)


def test_processes_of_their_own_do_not_meet():
    one, other = ReaderProcess(), ReaderProcess()
    for each in (one, other):
        assert leaves_of(each.answer(PARQUET, bases("parquet")[0], 2 << 30, 60.0)) == []
    assert one._process is None or one._process.pid != other._process.pid
    one.end()
    other.end()
