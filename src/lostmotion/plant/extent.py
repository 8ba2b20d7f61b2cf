"""From when to when a file was recorded, without reading it whole."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import narwhals.stable.v2 as nw
import numpy as np
import polars as pl

from lostmotion.errors import LostMotionError
from lostmotion.files.began import moment_of
from lostmotion.files.columns import usual
from lostmotion.files.frames import load, peeked
from lostmotion.files.moments import with_moments
from lostmotion.files.number_cells import decimal_mark
from lostmotion.files.table import Table
from lostmotion.files.text import parse_text
from lostmotion.files.times import read_times
from lostmotion.plant.parquet import is_parquet

ENDS = 1 << 14  # bytes of either end of a text


@dataclass(frozen=True, order=True)
class Extent:
    """First and last moment, in UTC; times without a zone are taken as such, for their order."""

    first: datetime
    last: datetime


def extent_of(files: Sequence[Path]) -> Extent | None:
    """First and last date in files of one record; None: not dated, or not to be told.

    Parameters
    ----------
    files : sequence of Path
        Of one table, or of one tag each.
    """
    try:
        each = [_extent(path) for path in files]
    except (LostMotionError, OSError, pl.exceptions.PolarsError):
        return None
    known = [one for one in each if one is not None]
    if not known or len(known) < len(each):
        return None
    return Extent(min(one.first for one in known), max(one.last for one in known))


def _extent(path: Path) -> Extent | None:
    table = with_moments(_ends(path))
    times = usual("time", table.names)
    if len(times) != 1:
        return None
    stamps = read_times(table, times[0], decimal_mark(table, [times[0]]))
    seconds = stamps.seconds[~np.isnan(stamps.seconds)]
    if not len(seconds):
        return None
    moments = [moment_of(stamps, float(seconds[row])) for row in (np.argmin(seconds), np.argmax(seconds))]
    first, last = [one if one is None or one.tzinfo else one.replace(tzinfo=UTC) for one in moments]
    return None if first is None or last is None else Extent(first, last)


def _ends(path: Path) -> Table:
    """First and last rows, as far as they hold the times."""
    if is_parquet(path):
        return _times(path)
    if path.stat().st_size <= 4 * ENDS or b"\0" in (start := _start(path)):
        return load(path)
    if not _is_text(start):
        return peeked(path)
    with path.open("rb") as stream:
        stream.seek(-ENDS, 2)
        end = stream.read()
    return parse_text(start[: start.rfind(b"\n") + 1] + end[end.find(b"\n") + 1 :], path.name)


def _start(path: Path) -> bytes:
    with path.open("rb") as stream:
        return stream.read(ENDS)


def _is_text(start: bytes) -> bool:
    try:
        start[: start.rfind(b"\n") + 1].decode()
    except UnicodeDecodeError:
        return False
    return True


def _times(path: Path) -> Table:
    names = usual("time", list(pl.read_parquet_schema(path)))
    column = pl.col(names[0]) if len(names) == 1 else pl.all()
    scan = pl.scan_parquet(path, hive_partitioning=False, glob=False).select(column)
    if len(names) == 1:
        scan = scan.select(pl.concat([pl.col(names[0]).min().implode(), pl.col(names[0]).max().implode()]).explode())
    return Table(nw.from_native(scan.collect(), eager_only=True), path.name)
