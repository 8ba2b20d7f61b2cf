"""Parquet in pieces -> one table: folders of hive partitions, and files that follow each other."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from pathlib import Path

import narwhals.stable.v2 as nw
import polars as pl

from lostmotion.files.apart import leaves_apart
from lostmotion.files.child import PIECES
from lostmotion.files.columns import usual
from lostmotion.files.long import called
from lostmotion.files.paths import fitting, is_folder, is_pattern
from lostmotion.files.table import Table
from lostmotion.files.undamaged import undamaged

ENDINGS = (".parquet", ".pq")
# Pieces of one table are numbered or dated: part-0, 00012-ab34, flows_2024-01.
_PIECE = re.compile(r"(part|chunk|piece|batch)?[-_. ]?\d+([-_.].*)?", re.IGNORECASE)
_DATED = re.compile(r"(19|20)\d\d[-_.]?(0[1-9]|1[0-2])")
DATE_KEYS = frozenset({"year", "month", "week", "day", "date", "hour", "dt", "ds", "ym", "ymd", "yyyymm", "yyyymmdd"})


def pieces_of(path: Path) -> tuple[Path, ...]:
    """Parquet files of one table that a folder or a pattern stands for; empty where it is none.

    Parameters
    ----------
    path : Path
        A folder with partitions (``year=2024/month=1/..``), or a folder or a pattern whose files are numbered or dated
        pieces. Files of other names are not taken as one table: they may be of different loops.
    """
    if is_folder(path):
        inside = sorted(one for one in path.rglob("*") if one.suffix.lower() in ENDINGS and one.is_file())
        if any("=" in part for one in inside for part in one.relative_to(path).parts[:-1]):
            return tuple(inside)
        others = any(one.is_file() and one.suffix.lower() not in ENDINGS for one in path.iterdir())
        inside = [] if others else [one for one in inside if one.parent == path]
    elif is_pattern(path):
        inside = fitting(path)
        if any(one.suffix.lower() not in ENDINGS for one in inside):
            return ()
        if any("=" in part for one in inside for part in one.parts[:-1]):
            return tuple(inside)
    else:
        return ()
    return tuple(inside) if len(inside) > 1 and _numbered([one.stem for one in inside]) else ()


def _numbered(stems: Sequence[str]) -> bool:
    if all(_PIECE.fullmatch(stem) for stem in stems):
        return True
    return all(_DATED.search(stem) for stem in stems) and len({re.sub(r"\d+", "#", stem) for stem in stems}) == 1


def read_dataset(path: Path, pieces: Sequence[Path]) -> dict[str, Table]:
    """One table of all pieces, under ""; where a partition is no date, one for each of its values by that name.

    Raises
    ------
    DataError
        Damaged, or pieces with different columns.
    """
    with undamaged("whole Parquet files of the same columns", str(path), "export them in one way"):
        paths = json.dumps([str(one.absolute()) for one in pieces]).encode()  # its process stays in another folder
        leaves_apart(PIECES, paths, sum(one.stat().st_size for one in pieces))
        frame = pl.read_parquet([str(one) for one in pieces], hive_partitioning=True, glob=False)
    keys = [key for key in _keys(pieces[0]) if key in frame.columns]
    note = f"Joined from {len(pieces)} Parquet files: {pieces[0].name} to {pieces[-1].name}."
    dates = [key for key in keys if key.lower() in DATE_KEYS]
    if usual("time", [name for name in frame.columns if name not in keys]):
        frame = frame.drop(dates)
    table = Table(nw.from_native(frame, eager_only=True), str(path), notes=(note,))
    loops = [key for key in keys if key not in dates and frame[key].n_unique() > 1]
    if not loops or (called(table, "tag") and called(table, "value")):
        return {"": table}
    parts = frame.partition_by(loops, as_dict=True, include_key=False, maintain_order=True)
    return {
        ".".join(map(str, values)): Table(nw.from_native(part, eager_only=True), str(path), notes=(note,))
        for values, part in parts.items()
    }


def _keys(piece: Path) -> list[str]:
    return [part.split("=", 1)[0] for part in piece.parts[:-1] if "=" in part]
