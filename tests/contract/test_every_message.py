"""Every message of the readers is provoked here, and what it says to type is typed.

A new message makes `test_no_message_is_left` fail with its place: add a case that provokes it.
"""

import gzip
import io
import shlex
import sys
import zipfile
from datetime import date
from importlib.util import find_spec
from pathlib import Path
from threading import Event

import numpy as np
import polars as pl
import pytest

from lostmotion.cli import main
from lostmotion.cli.wording import FLAGS, OPTIONS
from lostmotion.errors import LostMotionError
from lostmotion.files import matlab, packed, read_loop, text_lines, workbook
from lostmotion.files.follow import Follower
from lostmotion.files.growing import GrowingFile
from lostmotion.files.layout import Asked
from lostmotion.records import LoopRecord, check, prepare
from tests.messages import PACKAGE, passed, places_in, refusals_in
from tests.unit.test_packed import ROWS
from tests.unit.test_packed import workbook as spreadsheet

NOT_READERS = ("write.py", "results.py", "fields.py")  # they write, or read results
READERS = sorted(f"files/{path.name}" for path in (PACKAGE / "files").glob("*.py") if path.name not in NOT_READERS)
CHECKS = ["records/findings.py", "records/prepared.py", "records/record.py"]

N = 60
OP = np.round(50 + 8 * np.sin(np.arange(N) / 4), 2)
PV = np.round(20 + 3 * np.cos(np.arange(N) / 5) + np.arange(N) % 3, 2)


def rows(times=None, head="time,OP,PV", more=""):
    times = range(N) if times is None else times
    return "\n".join([head, *(f"{t},{o},{p}{more}" for t, o, p in zip(times, OP, PV, strict=False)), ""])


def changed(row, cells):
    lines = rows().split("\n")
    lines[row] = cells
    return "\n".join(lines)


WIDE = rows(head="time,FIC1.OP,FIC1.PV,FIC2.OP,FIC2.PV", more=",1,2")
LONG = "\n".join(
    ["Tag,Time,Value", *(f"F1.{tag},{k},{k % 7}" for k in range(N) for tag in ("OP", "PV", "PV")[: 2 + (k == 9)])]
)
LONG = LONG.replace("F1.PV,9,2\nF1.PV,9,2", "F1.PV,9,2\nF1.PV,9,3")
DATES = [f"{1 + k // 9:02d}/{1 + k % 9:02d}/24" for k in range(N)]

TEXTS = {  # text of a file, and the settings it is read with
    "empty": (" \n", {}),
    "binary": (b"\0\1\2", {}),
    "blank lines and comments only": ("# a\n\n", {}),
    "header only": ("time,OP,PV\n", {}),
    "no header": (rows().split("\n", 1)[1], {}),
    "no columns": ("speed\n1\n2\n", {}),
    "a row too long": (changed(9, "8,1,2,3"), {}),
    "a quote that is not closed": ('time,OP,PV\n0,1,2\n1,"2,3\n2,3,4\n', {}),
    "one row": ("time,OP,PV\n0,1,2\n", {}),
    "a word for a number": (changed(9, "8,open,2"), {}),
    "too large a number": (changed(9, "8,1e35,2"), {}),
    "two decimal marks": (rows().replace(",", ";").replace("50.0", "50,0"), {}),
    "a thousand or a decimal": ("\n".join(["OP,PV", *(f'"{k % 9 + 1},12{k % 7}",3' for k in range(N))]), {}),
    "no OP": (rows(head="time,valve,PV"), {}),
    "two of one role": (rows(head="time,CO,PV,MV", more=",1"), {}),
    "two that differ in case": (rows(head="time,Out1,OUT1,PV", more=",1"), {"op": "out1"}),
    "a name that is not there": (rows(), {"op": "FV1"}),
    "one column for two roles": (rows(head="time,valve,PV"), {"op": "valve", "pv": "valve"}),
    "several loops": (WIDE, {}),
    "a loop that is not there": (WIDE, {"loop": "FIC9"}),
    "two values of one tag": (LONG, {}),
    "no times": (rows(head="n,OP,PV"), {"time": False}),
    "a time is missing": (changed(9, ",1,2"), {}),
    "a word for a time": (rows([f"2024-03-01 10:00:{k:02d}" for k in range(N)]).replace("10:00:09", "later"), {}),
    "times of words": (rows(["noon"] * N), {}),
    "no time at all": (rows([""] * N), {}),
    "dates of two readings": (rows(DATES), {}),
    "days or seconds": (rows([45000.5 + 0.01 * k for k in range(N)]), {}),
    "rows of one time that differ": (rows(np.arange(N) - (np.arange(N) == 9)), {}),
    "one stamp": (rows([7] * N), {}),
    "two recordings one into the other": (rows(np.r_[np.arange(N // 2), 0.5 + np.arange(N // 2)] + 3), {}),
    "times of no rate": (rows(np.cumsum(np.random.default_rng(3).exponential(5.0, N)) + 3.7), {}),
    "two clocks": (rows(head="time,OP,PV,ts", times=10 * np.arange(N), more=",7"), {}),
    "another dt": (rows(times=10 * np.arange(N)), {"dt": 7.0}),
    "dt below zero": (rows(), {"dt": -1.0}),
    "missing values that are not wanted": (changed(9, "8,,2"), {"missing": "error"}),
    "another word for missing": (rows(), {"missing": "no"}),
    "a span turned round": (rows(), {"op_span": (100.0, 0.0)}),
    "packed and damaged": (gzip.compress(rows().encode())[:-9], {}),
    "packed files": (b"", {}),
}  # fmt: skip


def archive(names):
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as whole:
        for name in names:
            whole.writestr(name, rows())
    return stream.getvalue()


def mat(**variables):
    from scipy.io import savemat

    stream = io.BytesIO()
    savemat(stream, variables)
    return stream.getvalue()


TEXTS["packed files"] = (archive(["a.csv", "b.csv"]), {})
TEXTS |= {
    "MAT 7.3": (matlab.MAT_HDF5 + bytes(200), {}),
    "MAT damaged": (mat(OP=OP)[:150], {}),
    "MAT without vectors": (mat(a=1.0), {}),
    "MAT of two loops": (mat(a={"OP": OP, "PV": PV}, b={"OP": OP, "PV": PV}), {}),
    "Parquet damaged": (b"PAR1" + bytes(40), {}),
}


def stored(folder, case):
    content, settings = TEXTS[case]
    path = folder / "FIC 101.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path, settings


def limited(folder, patch):
    patch.setattr(packed, "LARGEST", 10)
    path = folder / "a.csv.gz"
    path.write_bytes(gzip.compress(rows().encode()))
    read_loop(path)


def resumed(folder, asked=None, stream=False, **change):
    path = folder / "a.csv"
    path.write_text(rows())
    with Follower(path) as follower:
        follower.finish()
        position = follower.position | change
    Follower(io.BytesIO(rows().encode()) if stream else path, asked, position)


def other_file(folder):
    path = folder / "a.csv"
    path.write_text(rows())
    with Follower(path) as follower:
        follower.finish()
        path.write_text("time,OP\n")
        follower.wait(0.0, Event())
        follower.read()


def other_stream(_):
    follower = Follower(io.BytesIO(rows().encode()))
    follower.finish()
    again = Follower(io.BytesIO(b"speed of wind\n1\n"), None, follower.position)
    again.finish()


def without_reader(_, patch):
    patch.setitem(sys.modules, "fastexcel", None)
    workbook.load_workbook(b"", "a.xlsx")


def follow(text, asked=None):
    return lambda _: Follower(io.BytesIO(text if isinstance(text, bytes) else text.encode()), asked).finish()


def unreadable(patch, work):
    def fails(*_, **__):
        raise PermissionError(13, "Permission denied")

    patch.setattr("pathlib.Path.open", fails)
    patch.setattr("pathlib.Path.read_bytes", fails)
    work("a.csv")


OTHERS = {  # what no file alone provokes
    "neither path nor frame": lambda _: read_loop(5),
    "a lazy frame": lambda _: read_loop(pl.LazyFrame({"OP": [1.0]})),
    "an empty frame": lambda _: read_loop(pl.DataFrame({"OP": [], "PV": []})),
    "names that are numbers": lambda _: read_loop(pytest.importorskip("pandas").DataFrame([[1, 2], [3, 4]])),
    "a column of dates": lambda _: read_loop(pl.DataFrame({"OP": [1.0, 2.0], "PV": [date(2024, 1, 1)] * 2})),
    "no such file": lambda folder: read_loop(folder / "absent.csv"),
    "a folder": read_loop,
    "no such file to follow": lambda folder: Follower(folder / "absent.csv"),
    "a folder to follow": Follower,
    "a position of another version": lambda folder: resumed(folder, version=99),
    "a position of a file for a stream": lambda folder: resumed(folder, stream=True),
    "a position for other columns": lambda folder: resumed(folder, Asked(op="FV")),
    "another file than before": other_file,
    "another stream than before": other_stream,
    "too few rows to follow": follow("time,OP,PV\n0,1,2\n"),
    "UTF-16 to follow": follow(rows().encode("utf-16")),
    "a mode of unknown words": follow(rows(head="time,OP,PV,Mode", more=",7"), Asked(mode="Mode")),
    "a line without an end": follow(b"a" * (text_lines.LONGEST_LINE + 5000)),
    "record of dt 0": lambda _: LoopRecord(OP, PV, dt=0.0),
    "record of one sample": lambda _: LoopRecord([1.0], [1.0], dt=1.0),
    "record of two lengths": lambda _: LoopRecord(OP, PV[1:], dt=1.0),
    "record of words": lambda _: LoopRecord(["a", "b"], [1.0, 2.0], dt=1.0),
    "record of two dimensions": lambda _: LoopRecord(np.ones((2, 2)), [1.0, 2.0], dt=1.0),
    "record of infinite values": lambda _: LoopRecord([1.0, np.inf], [1.0, 2.0], dt=1.0),
    "record of modes in two dimensions": lambda _: LoopRecord(OP, PV, dt=1.0, mode=[["AUTO"]]),
    "one row of a record": lambda _: LoopRecord(OP, PV, dt=1.0)[3],
    "a refused record": lambda _: prepare(LoopRecord(np.full(N, 5.0), PV, dt=1.0)).require(),
}
PATCHED = {
    "too much in an archive": limited,
    "a file that cannot be read": lambda _, patch: unreadable(patch, read_loop),
    "a file that cannot be followed": lambda _, patch: unreadable(patch, lambda path: GrowingFile(Path(path))),
    "no reader of spreadsheets": without_reader,
}
BOOKS = {
    "a damaged workbook": b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(600),
    "two sheets with rows": spreadsheet(ROWS, ROWS),
}


def checked():
    """Records that each finding of the checks is about."""
    wave, noise = np.sin(np.arange(600) / 9), np.random.default_rng(0).normal(size=(2, 600))
    live = {"op": 50 + 8 * wave + noise[0], "pv": wave + 0.1 * noise[1]}
    made = [
        {"op": OP[:20], "pv": PV[:20]},
        {"op": OP, "pv": np.r_[np.nan, PV[1:]]},
        live | {"gaps": (300,)},
        {"op": np.full(N, np.nan), "pv": PV},
        {"op": np.full(N, 3.0), "pv": PV},
        live | {"pv": np.repeat(live["pv"][::20], 20)},
        live | {"op": np.repeat(live["op"][::20], 20)},
        live | {"pv": np.interp(np.arange(600), np.arange(0, 600, 12), live["pv"][::12])},
        live | {"pv": np.round(live["pv"])},
        live | {"pv": np.where(np.arange(600) == 99, 90.0, live["pv"])},
        {name: np.repeat(values[::3], 3) for name, values in live.items()},
        {name: np.where(abs(np.arange(600) - 220) < 20, values[200], values) for name, values in live.items()},
        live | {"op": 50 + 0.2 * wave + 0.01 * noise[0], "op_span": (0.0, 100.0)},
        live | {"op": 50 + np.arange(600) / 10},
        live | {"op": np.clip(live["op"], 45.0, 55.0)},
    ]  # fmt: skip
    for one in made:
        check(LoopRecord(**one, dt=1.0))


def unusable():
    """Why prepare leaves a record alone."""
    random = np.random.default_rng(0).normal(size=(2, 600))
    holes = np.where(np.arange(600) % 7 == 0, np.nan, random[0])
    lines = np.interp(np.arange(600), np.arange(0, 620, 20), random[1][:31])
    k = np.arange(600)
    still, slow = np.where(k < 500, 1.0, np.where(k % 5, np.sin(k), np.nan)), np.sin(k / 50)
    made = [
        (np.full(600, np.nan), random[1]),
        (np.full(600, 5.0), random[1]),
        (random[0], lines),
        (holes, random[1]),
        (still, slow),
    ]
    return [prepare(LoopRecord(op, pv, dt=1.0)).refusal for op, pv in made]


def refused(work, *given):
    with pytest.raises(LostMotionError) as caught:
        work(*given)
    return str(caught.value)


def run(capsys, *words):
    with pytest.raises(SystemExit):
        main([str(word) for word in words])
    return capsys.readouterr().err


def options(settings):
    """Settings of the reader as they are typed; None: there is no option for one of them."""
    words = []
    for name, value in settings.items():
        flag = FLAGS.get((name, str(value)))
        if flag is None and name not in OPTIONS:
            return None
        words += [flag] if flag else [OPTIONS[name], *map(str, value if isinstance(value, tuple) else (value,))]
    return words


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    """Places that all cases together pass, and the messages."""
    found = {}
    with pytest.MonkeyPatch.context() as patch, passed(patch) as places:
        folder = tmp_path_factory.mktemp("cases")
        for case in TEXTS:
            path, settings = stored(folder, case)
            found[case] = refused(lambda path=path, settings=settings: read_loop(path, **settings))
        for case, work in OTHERS.items():
            found[case] = refused(work, folder)
        for case, work in PATCHED.items():
            with pytest.MonkeyPatch.context() as inner:
                found[case] = refused(work, folder, inner)
        for case, content in BOOKS.items() if find_spec("fastexcel") else ():
            (folder / "a.xlsx").write_bytes(content)
            found[case] = refused(read_loop, folder / "a.xlsx")
        checked()
    return places, found


@pytest.mark.parametrize("file", [*READERS, *CHECKS])
def test_no_message_is_left(seen, file):
    if file == "files/workbook.py":
        pytest.importorskip("fastexcel")
    left = [
        f"{place.file}:{place.first} {place.text}"
        for place in places_in(file)
        if not any(name == place.file and place.first <= line <= place.last for name, line in seen[0])
    ]
    assert left == [], "no case provokes these messages"


def test_no_refusal_of_prepare_is_left():
    left = [text for text in refusals_in("records/findings_words.py") if not any(text.match(one) for one in unusable())]
    assert left == [], "no case provokes these refusals"


def test_messages_say_what_to_do(seen):
    for case, message in seen[1].items():
        assert message.split("expected ", 1)[1].count("; ") >= 1 or case == "no such file to follow", (case, message)
        assert ", got " in message, case


@pytest.mark.parametrize("case", TEXTS)
def test_what_a_message_says_to_type_works(capsys, tmp_path, case):
    path, settings = stored(tmp_path, case)
    words = options(settings)
    if words is None:
        pytest.skip("no option of the command")
    error = run(capsys, "check", path, *words)
    assert error.startswith("error: expected "), error
    lines = [line.strip() for line in error.splitlines()[1:]]
    for line in lines:
        assert run(capsys, *shlex.split(line)[1:]) == "", line
    for remedy in ("--dt SECONDS --ignore-time", "--dt SECONDS"):
        if remedy in error.partition("; ")[2]:
            assert run(capsys, "check", path, *remedy.replace("SECONDS", "1").split()) == "", remedy
            break
