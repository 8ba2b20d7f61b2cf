"""Calls that are refused and that no file alone provokes: frames, records, files that grow, readers that are absent."""

import csv
import gzip
import io
import os
import sys
from dataclasses import replace
from datetime import UTC, date, datetime
from pathlib import Path
from threading import Event

import numpy as np
import polars as pl
import pytest

from lostmotion.files import limits, matlab, packed, read_loop, read_loops, text_lines, workbook
from lostmotion.files.follow import Follower
from lostmotion.files.frames import read_bytes
from lostmotion.files.growing import GrowingFile
from lostmotion.files.layout import Asked
from lostmotion.records import LoopRecord, check, prepare
from tests.support.reader_texts import OP, PV, N, rows
from tests.support.reader_texts import archive as made_archive

RECORD = LoopRecord(OP, PV, dt=1.0, gaps=(30,), start="2026-03-01 06:00")


def limited(folder, patch, most="1e-8"):
    patch.setenv(limits.MOST_GIB, most)
    path = folder / "a.csv.gz"
    path.write_bytes(gzip.compress(rows().encode()))
    read_loop(path)


def packed_among_others(folder):
    (folder / "b.zip").write_bytes(made_archive({"a.csv": rows(), "b.csv": rows()}))
    (folder / "a.csv").write_text(rows())
    read_loop([folder / "b.zip", folder / "a.csv"])


def too_many(folder, patch):
    patch.setenv(limits.MOST_GIB, "1e-8")
    (folder / "a.zip").write_bytes(made_archive({"a.csv": rows(), "b.csv": rows()}))
    read_loop(folder / "a.zip")


def without_memory(folder, patch):
    def content(*_):
        raise MemoryError

    patch.setattr(packed, "content_of", content)
    (folder / "a.csv.gz").write_bytes(gzip.compress(rows().encode()))
    read_loop(folder / "a.csv.gz")


def a_pipe(folder):
    os.mkfifo(folder / "pipe.csv")
    read_loop(folder / "pipe.csv")


def far_dates():
    times = pl.Series([10**15 + 1000 * row for row in range(N)], dtype=pl.Datetime("ms"))
    read_loop(pl.DataFrame({"time": times, "OP": OP, "PV": PV}))


def two_alike():
    frame = pytest.importorskip("pandas").DataFrame([[1.0, 2.0], [3.0, 4.0]], columns=["OP", "OP"])
    read_loop(frame)


def few_columns(folder, patch):
    patch.setenv(limits.MOST_COLUMNS, "2")
    (folder / "a.csv").write_text(rows())
    read_loop(folder / "a.csv")


def long_cell(folder, patch):
    before = csv.field_size_limit(20)
    try:
        (folder / "a.csv").write_text("t_s,OP,PV," + "x" * 50 + "\n" + "\n".join(f"{k},{k},{k},1" for k in range(N)))
        read_loop(folder / "a.csv")
    finally:
        csv.field_size_limit(before)


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


def without_hdf5(folder, patch):
    patch.setitem(sys.modules, "h5py", None)
    (folder / "a.mat").write_bytes(matlab.MAT_HDF5 + bytes(200))
    read_loop(folder / "a.mat")


def without_sqlalchemy(_, patch):
    patch.setitem(sys.modules, "sqlalchemy", None)
    read_loop("postgresql://host/plant", query="SELECT 1")


def two_whole(folder):
    """A record, and another of the same name in another folder."""
    paths = [folder / "a.csv", folder / "again" / "a.csv"]
    for path in paths:
        path.parent.mkdir(exist_ok=True)
        path.write_text(rows())
    return paths


def follow(text, asked=None):
    return lambda _: Follower(io.BytesIO(text if isinstance(text, bytes) else text.encode()), asked).finish()


def unreadable(patch, work):
    def fails(*_, **__):
        raise PermissionError(13, "Permission denied")

    patch.setattr("pathlib.Path.open", fails)
    patch.setattr("pathlib.Path.read_bytes", fails)
    work("a.csv")


def full_memory(folder, patch):
    patch.setattr(limits, "_free_bytes", lambda: 0.0)
    (folder / "a.csv").write_text(rows())
    read_loop(folder / "a.csv")


OTHERS = {  # what no file alone provokes
    "a span that no signal has": lambda _: LoopRecord([1.0, 2.0], [1.0, 2.0], dt=1.0, op_span=(-1e308, 1e308)),
    "neither path nor frame": lambda _: read_loop(5),
    "a dict without columns": lambda _: read_loop({}),
    "a dict of two lengths": lambda _: read_loop({"OP": [1.0, 2.0], "PV": [1.0]}),
    "a dict with one number": lambda _: read_loop({"OP": 1.0, "PV": [1.0]}),
    "a dict of arrays and numbers": lambda _: read_loop({"OP": [np.array([1.0]), 2.0], "PV": [1.0, 2.0]}),
    "a lazy frame": lambda _: read_loop(pl.LazyFrame({"OP": [1.0]})),
    "an empty frame": lambda _: read_loop(pl.DataFrame({"OP": [], "PV": []})),
    "names that are numbers": lambda _: read_loop(pytest.importorskip("pandas").DataFrame([[1, 2], [3, 4]])),
    "a column of dates": lambda _: read_loop(pl.DataFrame({"OP": [1.0, 2.0], "PV": [date(2024, 1, 1)] * 2})),
    "whole records together": lambda folder: read_loop(two_whole(folder)),
    "packed files among others": packed_among_others,
    "loops of one name": lambda folder: read_loops(two_whole(folder)),
    "a setting of one loop for all": lambda folder: read_loops(two_whole(folder), loop="a"),
    "another word for uncertain": lambda _: read_loop(pl.DataFrame({"OP": OP, "PV": PV}), uncertain="drop"),
    "a pipe": a_pipe,
    "dates of no calendar": lambda _: far_dates(),
    "two columns of one name": lambda _: two_alike(),
    "no such file": lambda folder: read_loop(folder / "absent.csv"),
    "a folder": read_loop,
    "a folder for the bytes of a file": read_bytes,
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
    "record of gaps of which some are known": lambda _: replace(RECORD, gap_seconds=(1.0, 2.0)),
    "record that began at no date": lambda _: replace(RECORD, start="yesterday"),
    "record that began at a number": lambda _: replace(RECORD, start=5),
    "a bound that is none": lambda _: RECORD[0.5:9],
    "nothing between the bounds": lambda _: RECORD["10min":],
    "a date of a record without dates": lambda _: replace(RECORD, start=None)["2026-03-01":],
    "a date behind a gap of unknown length": lambda _: RECORD["2026-03-01 06:10":],
    "a date with a time zone": lambda _: RECORD[datetime(2026, 3, 1, 6, tzinfo=UTC) :],
    "a refused record": lambda _: prepare(LoopRecord(np.full(N, 5.0), PV, dt=1.0)).require(),
}
PATCHED = {
    "too much in a packed file": limited,
    "too much in an archive": too_many,
    "a limit that is no number": lambda folder, patch: limited(folder, patch, "much"),
    "no memory for it": without_memory,
    "too many columns": few_columns,
    "rows without memory for them": full_memory,
    "a cell that is too long": long_cell,
    "a file that cannot be read": lambda _, patch: unreadable(patch, read_loop),
    "a file that cannot be followed": lambda _, patch: unreadable(patch, lambda path: GrowingFile(Path(path))),
    "no reader of spreadsheets": without_reader,
    "no reader of MAT 7.3": without_hdf5,
    "no reader of databases": without_sqlalchemy,
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
        live | {"op_span": (0.0, 1.0)},
        live | {"sp": np.repeat([50.0, 50.3, 52.0, 51.4, 51.0, 51.0], [50, 1, 149, 1, 99, 300])},
        live | {"op": 50 + np.arange(600) / 10},
        live | {"op": np.clip(live["op"], 45.0, 55.0)},
    ]  # fmt: skip
    for one in made:
        check(LoopRecord(**one, dt=1.0))


def unusable():
    """Why prepare leaves a record alone."""
    random = np.random.default_rng(0).normal(size=(2, 600))
    holes = np.where(np.arange(600) % 4 == 0, np.nan, random[0])
    lines = np.interp(np.arange(600), np.arange(0, 620, 20), random[1][:31])
    k = np.arange(600)
    still, slow = np.where(k < 500, 1.0, np.where(k % 10 >= 6, np.sin(k), np.nan)), np.sin(k / 50)
    made = [
        (np.full(600, np.nan), random[1]),
        (np.full(600, 5.0), random[1]),
        (random[0], lines),
        (holes, random[1]),
        (still, slow),
    ]
    return [prepare(LoopRecord(op, pv, dt=1.0)).refusal for op, pv in made]
