"""A made plant as files: one a loop, the list of the loops, the truth."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl

from lostmotion.arrays import FloatArray
from lostmotion.errors import FileAccessError, ParameterError
from lostmotion.evaluate.plants.plant import MadePlant
from lostmotion.evaluate.plants.truth import LoopTruth
from lostmotion.files.write import write_table
from lostmotion.files.writer import refuse_folder, write_folder
from lostmotion.records import LoopRecord

LIST, TRUTH = "loops.csv", "truth.csv"
FORMATS = ("parquet", "csv")


def refuse(folder: Path, plant: MadePlant, ending: str, force: bool) -> None:
    """Refuse a folder that is there, or (with `force`) one that holds other files than those of such a plant.

    Raises
    ------
    FileAccessError
        As above, or it cannot be written.
    ParameterError
        Another format.
    """
    if ending not in FORMATS:
        raise ParameterError.expected(f"a format out of {list(FORMATS)}", repr(ending), "choose one of them")
    names = [f"{loop.tag}.{ending}" for loop in plant.loops] + [LIST, TRUTH]
    if os.path.lexists(folder) and not force:
        raise FileAccessError(f"expected a new folder, got {str(folder)!r}, which exists; use force=True to replace it")
    refuse_folder(folder, names)
    others = sorted({path.name for path in folder.iterdir()} - set(names)) if folder.is_dir() else []
    if others:
        raise FileAccessError(
            f"expected a folder of a made plant alone, got {len(others)} other files in {str(folder)!r} "
            f"({others[0]!r}); an audit would take them for loops: choose another folder"
        )


def write_plant(
    folder: Path, plant: MadePlant, truth: Sequence[LoopTruth], ending: str, progress: Callable[[float], None]
) -> list[Path]:
    """Write all files; list and truth come last, so that a folder with them is whole.

    Parameters
    ----------
    folder : Path
        Made where it is not there.
    plant : MadePlant
    truth : sequence of LoopTruth
    ending : str
        Of FORMATS.
    progress : callable
        Told the share that is done.
    """
    write_folder(folder, {})
    written = []
    for number, record in enumerate(plant.records()):
        written.append(write_table(folder / f"{record.tag}.{ending}", table(record), force=True))
        progress((number + 1) / len(plant.loops))
    written.append(write_table(folder / LIST, pl.DataFrame(listed(plant, ending)), force=True))
    written.append(write_table(folder / TRUTH, pl.DataFrame([asdict(one) for one in truth]), force=True))
    return written


def table(record: LoopRecord) -> pl.DataFrame:
    """Columns as a historian exports them: time, PV with its quality where some are bad, SP, OP and mode."""
    assert record.start is not None  # noqa: S101  for the type checker
    since = np.round(1000.0 * record.dt * np.arange(len(record))).astype("timedelta64[ms]")
    bad = np.isnan(record.pv)
    columns: dict[str, Any] = {"time": np.datetime64(record.start.replace(tzinfo=None), "ms") + since}
    columns[f"{record.tag}.PV"] = _filled(record.pv).astype(np.float32)
    if bad.any():
        columns[f"{record.tag}.PV.Quality"] = np.where(bad, "Bad", "Good")
    if record.sp is not None:
        columns[f"{record.tag}.SP"] = record.sp.astype(np.float32)
    columns[f"{record.tag}.OP"] = record.op.astype(np.float32)
    columns[f"{record.tag}.MODE"] = record.mode
    return pl.DataFrame(columns)


def _filled(values: FloatArray) -> FloatArray:
    """Last good value, as a historian shows it beside the word Bad; 0 before the first."""
    at = np.maximum.accumulate(np.where(np.isnan(values), 0, np.arange(values.size)))
    return np.asarray(np.nan_to_num(values[at]))


def listed(plant: MadePlant, ending: str) -> list[dict[str, Any]]:
    """Rows of the list of the loops."""
    return [
        {
            "tag": one.tag, "op": one.op, "pv": one.pv, "sp": one.sp, "mode": one.mode, "type": one.loop_type,
            "op_low": 0.0, "op_high": 100.0, "pv_low": loop.pv_span[0], "pv_high": loop.pv_span[1],
            "op_unit": one.op_unit, "pv_unit": one.pv_unit, "area": one.area, "weight": one.weight,
            "file": f"{one.tag}.{ending}",
        }
        for one, loop in zip(plant.plant_loops(), plant.loops, strict=True)
    ]  # fmt: skip
