"""A big plant for measuring: few simulated days under many tags. Made cheaply, told as what it is.

Run: ``.venv/bin/python benchmarks/audit/made_plant.py FOLDER --loops 1000 --days 1 --dt 1``.

Every loop is one of `--distinct` simulated records (a healthy valve, dead zones, backlashes, stictions, one with tight
tuning, one by hand), so results repeat; what is measured is time and memory, not detection. Layouts:

| layout | what | tag |
|---|---|---|
| files | a Parquet file for each loop, a folder for each area of 100; hard links: a record is stored once | name |
| hive | area=A001/tag=FIC00001/part-0.parquet; hard links | partition |
| one | one Parquet file of tag, time, OP, PV, SP, mode; a row group for each loop, sorted by tag; no links | column |
| long | one Parquet file, a row for each value of each tag (FIC00001.PV ..), sorted by tag; no links | column |

Columns: time (UTC, microseconds), OP in %, PV and SP in engineering units as float32, mode. ``truth.csv`` beside the
data says which record each loop repeats, and its actuator.
"""

from __future__ import annotations

import argparse
import os
import shutil
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import polars as pl
from scipy.signal import lfilter

import lostmotion as lm
from lostmotion.models import Identity

MOST_BYTES = 4e9  # of the layouts without links
IN_AREA = 100
START = datetime(2026, 3, 2, tzinfo=UTC)


@dataclass(frozen=True)
class Kind:
    """One distinct record: a letter, an actuator, how it is controlled."""

    letter: str
    name: str
    actuator: object
    kp: float = 0.6
    manual: bool = False


KINDS = (
    Kind("F", "none", Identity()),
    Kind("F", "dead zone", lm.DeadZone(left=-1.0, right=1.0)),
    Kind("P", "backlash", lm.Backlash(width=2.0)),
    Kind("F", "stiction", lm.Stiction(band=3.0, jump=1.5)),
    Kind("L", "none", Identity(), kp=0.2),
    Kind("T", "none, tight tuning", Identity(), kp=2.6),
    Kind("F", "none, in manual", Identity(), manual=True),
    Kind("P", "stiction", lm.Stiction(band=1.0, jump=0.8)),
)


def record(number: int, seconds: float, dt: float) -> pl.DataFrame:
    """A distinct record: first-order process with dead time under PI control, drifting load, noise, set-point moves."""
    kind = KINDS[number % len(KINDS)]
    rng = np.random.default_rng(number)
    n = round(seconds / dt)
    pole = float(np.exp(-dt / (12.0 + 3.0 * (number % 5))))
    linear = lm.LinearModel([-pole], [1.2 * (1.0 - pole)], max(round(3.0 / dt), 1), dt)
    hold = max(round(1800.0 / dt), 1)
    moves = np.repeat(rng.normal(0.0, 2.0, n // hold + 1), hold)[:n]
    drift = lfilter([1.0], [1.0, -np.exp(-dt / 600.0)], rng.normal(0.0, 1.5 * np.sqrt(2.0 * dt / 600.0), n))
    plant = lm.Hammerstein(kind.actuator, linear)  # type: ignore[arg-type]
    controller = lm.PI(0.0 if kind.manual else kind.kp, 0.0 if kind.manual else 0.03, low=-50.0, high=50.0)
    loop = lm.simulate_loop(plant, controller, moves, disturbance=drift, noise=0.04, seed=number)
    return pl.DataFrame(
        {
            "time": _times(n, dt),
            "OP": (50.0 + loop.control).astype(np.float32),
            "PV": (100.0 + 2.0 * loop.measured).astype(np.float32),
            "SP": (100.0 + 2.0 * moves).astype(np.float32),
            "mode": pl.repeat("MAN" if kind.manual else "AUTO", n, eager=True),
        }
    )


def _times(n: int, dt: float) -> pl.Series:
    steps = np.round(np.arange(n) * dt * 1e6).astype(np.int64) + round(START.timestamp() * 1e6)
    return pl.Series("time", steps).cast(pl.Datetime("us", "UTC"))


def tag_of(loop: int, distinct: int) -> str:
    """FIC00001 ..: the letter of its record."""
    return f"{KINDS[loop % distinct % len(KINDS)].letter}IC{loop:05d}"


def area_of(loop: int) -> str:
    """A hundred loops each."""
    return f"A{loop // IN_AREA + 1:03d}"


def made_plant(
    folder: Path, loops: int, days: float = 1.0, dt: float = 1.0, distinct: int = 8, layout: str = "files"
) -> None:
    """Write the plant into a new or empty folder.

    Raises
    ------
    SystemExit
        The folder is not empty, or a layout without links would take too much of the disk.
    """
    if folder.exists() and any(folder.iterdir()):
        raise SystemExit(f"expected an empty folder, got files in {folder}; name another")
    rows = round(days * 86400.0 / dt)
    if layout in ("one", "long") and loops * rows * 20 > MOST_BYTES:
        raise SystemExit(
            f"{loops} loops in one file take more than {MOST_BYTES / 1e9:g} GB; take --layout files or hive"
        )
    folder.mkdir(parents=True, exist_ok=True)
    frames = [record(number, days * 86400.0, dt) for number in range(min(distinct, loops))]
    if layout in ("files", "hive"):
        _linked(folder, frames, loops, layout == "hive")
    else:
        _one_file(folder / "plant.parquet", frames, loops, layout == "long")
    which = [loop % len(frames) for loop in range(loops)]
    truth = [(tag_of(k, len(frames)), area_of(k), one, KINDS[one % len(KINDS)].name) for k, one in enumerate(which)]
    pl.DataFrame(truth, schema=["tag", "area", "record", "actuator"], orient="row").write_csv(folder / "truth.csv")


def _linked(folder: Path, frames: list[pl.DataFrame], loops: int, hive: bool) -> None:
    """A name for each loop, all names of one record for one file; where a file has too many names, one more of it."""
    first: dict[int, Path] = {}
    for loop in range(loops):
        tag, area, which = tag_of(loop, len(frames)), area_of(loop), loop % len(frames)
        path = folder / f"area={area}/tag={tag}/part-0.parquet" if hive else folder / area / f"{tag}.parquet"
        path.parent.mkdir(parents=True, exist_ok=True)
        if which not in first:
            frames[which].write_parquet(path)
            first[which] = path
            continue
        try:
            os.link(first[which], path)
        except OSError:  # the file system has no links, or no more of this one
            shutil.copyfile(first[which], path)
            first[which] = path


def _one_file(path: Path, frames: list[pl.DataFrame], loops: int, long: bool) -> None:
    """Loops by the alphabet, one row group each (three of a long file: one for each tag)."""
    import pyarrow as pa  # noqa: PLC0415  only here: row groups are written one by one
    import pyarrow.parquet as pq  # noqa: PLC0415

    writer = None
    for tag, loop in sorted((tag_of(loop, len(frames)), loop) for loop in range(loops)):
        frame = frames[loop % len(frames)]
        for part in _long(frame, tag) if long else [frame.select(pl.lit(tag).alias("tag"), pl.all())]:
            table = pa.table({name: part[name].to_arrow() for name in part.columns})
            writer = writer or pq.ParquetWriter(path, table.schema, compression="zstd")
            writer.write_table(table, row_group_size=len(part))
    if writer is not None:
        writer.close()


def _long(frame: pl.DataFrame, tag: str) -> list[pl.DataFrame]:
    roles = ("OP", "PV", "SP")
    return [frame.select(pl.lit(f"{tag}.{role}").alias("tag"), "time", pl.col(role).alias("value")) for role in roles]


def main() -> None:
    """Command line."""
    asked = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    asked.add_argument("folder", type=Path)
    asked.add_argument("--loops", type=int, default=1000)
    asked.add_argument("--days", type=float, default=1.0)
    asked.add_argument("--dt", type=float, default=1.0)
    asked.add_argument("--distinct", type=int, default=len(KINDS), help="simulated records that are repeated")
    asked.add_argument("--layout", choices=("files", "hive", "one", "long"), default="files")
    said = asked.parse_args()
    made_plant(said.folder, said.loops, said.days, said.dt, said.distinct, said.layout)
    print(
        f"{said.loops} loops, {said.days:g} days every {said.dt:g} s in {said.folder}: "
        f"{min(said.distinct, said.loops)} simulated records, repeated"
    )


if __name__ == "__main__":
    main()
