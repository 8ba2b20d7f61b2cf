"""A record on the disk, for who computes and for who draws: a folder with one .npy file a column, which can be mapped.

Beside each signal lie the extremes of its blocks, so that any zoom of the longest record is drawn at once; beside all
of them what a diagnosis does not use, and in ``record.json`` what else is known.
"""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion.errors import DataError
from lostmotion.files.results import read_json
from lostmotion.files.schema import checked, each, group, number, or_null, row, text, whole
from lostmotion.files.writer import Buffer, write_folder, write_together
from lostmotion.records import LoopRecord
from lostmotion.web.trend.columns import KINDS, SIGNALS, Columns
from lostmotion.web.trend.pyramid import Pyramid, levels

COLUMNS = ("op", "pv", "sp", "position", "mode")
FACTS = ("dt", "tag", "source", "gaps", "notes", "loop_type", "made_up", "gap_seconds", "op_unit", "pv_unit")
SPANS = ("op_span", "pv_span")
ABOUT = "record.json"
WHAT, REMEDY = "a record as it was kept", "read the data again"
DRAWN = group(  # what of ABOUT is drawn
    dt=number(1e-9), start=or_null(text(40)), columns=each(text(20), len(COLUMNS)), gaps=each(whole(), 1 << 24),
    gap_seconds=each(number(), 1 << 24), **dict.fromkeys(SPANS, or_null(row(number(), number()))),
    **dict.fromkeys(("tag", "source", "op_unit", "pv_unit"), text()),
)  # fmt: skip


def keep_record(folder: Path, record: LoopRecord) -> None:
    """Write a record into a folder, whole or not at all; one that is there already is replaced.

    Times are not written: row k lies k * dt after the first one, and at `gaps` time is missing.

    Raises
    ------
    FileAccessError
        As in :func:`lostmotion.files.writer.write_folder`.
    """
    about: dict[str, Any] = {name: getattr(record, name) for name in (*FACTS, *SPANS)}
    about["start"] = None if record.start is None else record.start.isoformat()
    columns = {name: values for name in COLUMNS if (values := getattr(record, name)) is not None}
    files: dict[str, Buffer] = {f"{name}.npy": _bytes(values) for name, values in columns.items()}
    drawn = Columns.of(record, blocks=True)
    for name, pyramid in drawn.signals.items():
        files |= {f"{name}.{part}.npy": _bytes(getattr(pyramid, part)) for part in ("low", "high")}
    files |= {f"{kind}.npy": _bytes(drawn.shaded.get(kind, np.empty((0, 2), np.int64))) for kind in KINDS}
    files[ABOUT] = json.dumps({**about, "columns": list(columns)}, allow_nan=False).encode()
    if folder.is_dir():
        write_together({folder / name: data for name, data in files.items()}, force=True)
    else:
        write_folder(folder, files)


def kept_record(folder: Path) -> LoopRecord:
    """Record of what :func:`keep_record` wrote; its columns stay on the disk until they are used.

    Raises
    ------
    FileAccessError
        It is not there.
    DataError
        It is damaged.
    """
    about = read_json(folder / ABOUT, WHAT, REMEDY)
    try:
        columns: dict[str, Any] = {name: _mapped(folder / f"{name}.npy") for name in about["columns"]}
        known = {name: about[name] for name in FACTS}
        tuples = {name: tuple(known[name]) for name in ("gaps", "notes", "made_up", "gap_seconds")}
        spans = {name: None if about[name] is None else (about[name][0], about[name][1]) for name in SPANS}
        return LoopRecord(**columns, **{**known, **tuples, **spans}, start=about["start"])
    except (KeyError, TypeError, ValueError, OSError, IndexError) as error:
        raise DataError.expected(WHAT, type(error).__name__, REMEDY) from error


def kept_columns(folder: Path) -> Columns:
    """The same as it is drawn; what an earlier version kept without its extremes is reduced here.

    Raises
    ------
    FileAccessError
        It is not there.
    DataError
        It is damaged.
    """
    about = read_json(folder / ABOUT, WHAT, REMEDY)
    if not all((folder / f"{kind}.npy").exists() for kind in KINDS):
        return Columns.of(kept_record(folder), blocks=True)
    try:
        known = ("dt", "start", "columns", "gaps", "gap_seconds", *SPANS, "tag", "source", "op_unit", "pv_unit")
        facts = checked({name: about[name] for name in known}, DRAWN, WHAT, REMEDY)
        names = [name for name in SIGNALS if name in facts["columns"]]
        rows = _mapped(folder / "op.npy").size
        blocks = sum(count for _, count in levels(rows))
        signals = {name: Pyramid(*(_mapped(folder / f"{name}.{part}npy", size) for part, size in
                                   (("", rows), ("low.", blocks), ("high.", blocks)))) for name in names}  # fmt: skip
        shaded = {kind: _mapped(folder / f"{kind}.npy") for kind in KINDS}
        gaps = np.array(facts["gaps"], dtype=np.int64)
        return Columns({**facts, "rows": rows, "signals": names}, signals, shaded, gaps)
    except (KeyError, TypeError, ValueError, OSError) as error:
        raise DataError.expected(WHAT, str(error)[:200], REMEDY) from error


def _bytes(values: npt.NDArray[Any]) -> memoryview:
    """An array as the bytes of an .npy file."""
    stream = io.BytesIO()
    np.lib.format.write_array(stream, np.ascontiguousarray(values), allow_pickle=False)
    return stream.getbuffer()


def _mapped(path: Path, size: int | None = None) -> npt.NDArray[Any]:
    """Array of a file; an empty one cannot be mapped."""
    found: npt.NDArray[Any] = np.load(path, mmap_mode="r", allow_pickle=False)
    if size is not None and found.shape != (size,):
        raise ValueError(f"{path.name} has the shape {found.shape}, not ({size},)")
    return found
