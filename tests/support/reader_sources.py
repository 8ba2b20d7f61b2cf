"""Folders, files of one tag each, pieces and databases that the readers refuse: each made in a folder of its own."""

import sqlite3

import numpy as np
import polars as pl

from tests.support.reader_texts import OP, PV, N, rows

TIMES = np.arange(N)


def tag(path, values, times=TIMES, head="t_s,Value"):
    """File of one tag; `times` None: it has none."""
    begins = [""] * len(values) if times is None else [f"{time}," for time in times]
    lines = [f"{begin}{value}" for begin, value in zip(begins, values, strict=True)]
    path.write_text("\n".join([head, *lines, ""]))
    return path


def tags(folder, op="FIC101_OP.csv", pv="FIC101_PV.csv", **of_pv):
    tag(folder / op, OP)
    tag(folder / pv, of_pv.pop("values", PV), **of_pv)
    return folder


def one_tag(folder):
    return tag(folder / "FIC101_OP.csv", OP)


def two_loops(folder):
    tag(folder / "FIC101.csv", OP, head="t_s,OP")
    tag(folder / "FIC102.csv", PV, head="t_s,PV")
    return folder


def twice(folder):
    for name, role, values in (("a", "OP", OP), ("b", "OP", OP), ("c", "PV", PV)):
        tag(folder / f"{name}.csv", values, head=f"t_s,{role}")
    return folder


def contradicting(folder):
    tag(folder / "FIC101_OP.csv", OP, head="t_s,PV")
    tag(folder / "FIC101_PV.csv", PV, head="t_s,OP")
    return folder


def without_times(folder, rows_of_pv):
    for name, values in (("OP", OP), ("PV", PV[:rows_of_pv])):
        tag(folder / f"FIC101_{name}.csv", [f"{value},%" for value in values], None, "Value,Unit")
    return folder


def one_without_times(folder):
    return tags(folder, values=[f"{value},%" for value in PV], times=None, head="Value,Unit")


def no_rate(folder):
    random = np.random.default_rng(4)
    for name, values, step in (("OP", OP, 2.0), ("PV", PV, 5.0)):
        times = np.cumsum(random.uniform(0.5, 1.5, N)) * step
        tag(folder / f"FIC101_{name}.csv", values, times.round(3))
    return folder


def pieces(folder):
    frame = pl.DataFrame({"t_s": TIMES, "OP": OP, "PV": PV})
    frame[:30].write_parquet(folder / "part-0.parquet")
    frame[30:].rename({"OP": "CO"}).write_parquet(folder / "part-1.parquet")
    return folder


def quality(folder):
    path = folder / "a.csv"
    pl.DataFrame({"t_s": TIMES, "OP": OP, "PV": PV, "PV.Status": TIMES % 2}).write_csv(path)
    return path


def whole(folder, name="a.csv"):
    (folder / name).write_text(rows())
    return folder / name


def database(folder):
    path = folder / "plant.db"
    with sqlite3.connect(path) as base:
        for table in ("fic101", '"All values"'):
            base.execute(f"CREATE TABLE {table} (t_s REAL, op REAL, pv REAL)")
            base.executemany(
                f"INSERT INTO {table} VALUES (?, ?, ?)",  # noqa: S608
                zip(TIMES.tolist(), OP.tolist(), PV.tolist(), strict=True),
            )
    base.close()
    return path


SOURCES = {  # what is made and read, and the settings it is read with
    "an empty folder": (lambda folder: folder, {}),
    "a pattern that nothing fits": (lambda folder: folder / "*.dat", {}),
    "one tag alone": (one_tag, {}),
    "tags of two loops": (two_loops, {}),
    "one role twice": (twice, {}),
    "two files that may be OP": (lambda folder: tag(tags(folder) / "FIC101_OUT.csv", OP).parent, {}),
    "a file that contradicts its name": (contradicting, {}),
    "tags without times, of other lengths": (lambda folder: without_times(folder, N - 1), {}),
    "tags without times": (lambda folder: without_times(folder, N), {}),
    "one tag without times": (one_without_times, {}),
    "times of two kinds": (lambda folder: tags(folder, head="t_ms,Value"), {}),
    "two values of a tag at a time": (lambda folder: tags(folder, times=TIMES - (TIMES == 9)), {}),
    "tags of no common rate": (no_rate, {}),
    "one value of PV": (lambda folder: tags(folder, values=PV[:1], times=[0.5]), {}),
    "pieces of different columns": (pieces, {}),
    "qualities of two readings": (quality, {}),
    "a query of a file": (whole, {"query": "SELECT 1"}),
    "no query": (database, {}),
    "no query of an address": (lambda folder: f"sqlite:///{database(folder)}", {}),
    "a query that fails": (database, {"query": "SELECT flow FROM fic101"}),
    "a query without rows": (database, {"query": "SELECT * FROM fic101 WHERE op > 1000"}),
    "no such database": (lambda folder: f"sqlite:///{folder}/plant.db", {"query": "SELECT 1"}),
}  # fmt: skip


def made(folder, case):
    """Source of a case and its settings."""
    place = folder / "".join(letter for letter in case.title() if letter.isalnum())
    place.mkdir()
    make, settings = SOURCES[case]
    return make(place), settings
