"""What a user does in Python, in a folder with ``a.csv``, ``a.xlsx`` and ``plant.csv``; run like on Windows."""

import os
import sys
import threading
import time
from importlib import import_module
from pathlib import Path

import polars as pl
import pytest

import lostmotion as lm
from lostmotion.errors import FileAccessError
from lostmotion.files import alone, writer
from lostmotion.workers import Pool, isolated


def platform(module):
    return import_module(module).sys.platform


def the_mode_holds():
    """Here and in what is started from here: otherwise nothing below shows anything."""
    assert isolated.sys.platform == "win32"
    assert not hasattr(isolated.os, "getuid")
    assert not hasattr(os, "fork")
    with Pool(1) as pool:
        assert list(pool.map(platform, ["lostmotion.files.alone"])) == ["win32"]
    with pytest.raises(OSError, match="Invalid argument"):
        Path("FIC:101.csv").write_text("x")
    with Path("open").open("w") as stream:
        stream.write("x\n")
        with pytest.raises(PermissionError):
            Path("open").unlink()
    assert Path("open").read_bytes() == b"x\r\n"


def records():
    frame = pl.read_csv("a.csv")
    frame.write_parquet("a.parquet")
    read = [lm.read_loop(name) for name in ("a.csv", "a.parquet", "a.csv.gz")]
    assert [len(one.op) for one in read] == [2000] * 3
    assert lm.read_loop("a.xlsx").op.size  # in a process of its own
    return read[0]


def fits(record):
    fit = lm.identify(record)
    fit.save("fit.json")
    fit.save("fit.json", force=True)
    assert lm.read_fit("fit.json").status == fit.status
    assert lm.diagnose(record).verdict == "stiction"
    u = [lm.signals.prs(400, -5, 5, hold=10, seed=seed) for seed in range(2)]
    both = [lm.RecursiveML(3, 2, 3, 1.0, start_samples=300) for _ in u]
    assert len(lm.run_many(both, u, [2 * row for row in u], workers=2)) == 2


def writes():
    with writer.lock_file(Path("state")), pytest.raises(FileAccessError, match="for this process alone"):
        writer.lock_file(Path("state"))
    path = writer.write_bytes("held", b"old")
    with pytest.raises(FileAccessError, match="exists"):
        writer.write_bytes(path, b"new")
    held = path.open("rb")
    threading.Thread(target=lambda: (time.sleep(0.3), held.close())).start()
    assert writer.write_bytes(path, b"new", force=True).read_bytes() == b"new"  # who reads it is waited for
    alone.retried.__defaults__ = (0.1,)
    with path.open("rb"), pytest.raises(FileAccessError, match="open in another program"):
        writer.write_bytes(path, b"newer", force=True)
    assert path.read_bytes() == b"new"
    writer.write_folder("folder", {"one": b"1", "two": b"2"})
    writer.write_folder("folder", {"one": b"3", "two": b"4"}, force=True)
    assert sorted(one.name for one in Path("folder").iterdir()) == ["one", "two"]
    assert not list(Path().glob(".lostmotion*"))


if __name__ == "__main__":
    the_mode_holds()
    fits(records())
    writes()
    sys.stdout.write("done\n")
