"""A record on the disk: a folder with one .npy file a column, which can be mapped, and what is known beside them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from lostmotion.errors import DataError
from lostmotion.files.results import read_json
from lostmotion.files.writer import Buffer, write_folder, write_together
from lostmotion.records import LoopRecord
from lostmotion.web.trend.columns import array_bytes

COLUMNS = ("op", "pv", "sp", "position", "mode")
FACTS = ("dt", "tag", "source", "gaps", "notes", "loop_type", "made_up", "gap_seconds", "op_unit", "pv_unit")
SPANS = ("op_span", "pv_span")
ABOUT = "record.json"


def keep_record(folder: Path, record: LoopRecord) -> None:
    """Write a record into a folder, whole or not at all; errors as in :func:`lostmotion.files.writer.write_folder`.

    Times are not written: row k lies k * dt after the first one, and at `gaps` time is missing.
    """
    about: dict[str, Any] = {name: getattr(record, name) for name in (*FACTS, *SPANS)}
    about["start"] = None if record.start is None else record.start.isoformat()
    found = {name: getattr(record, name) for name in COLUMNS}
    columns = {name: values for name, values in found.items() if values is not None}
    files: dict[str, Buffer] = {f"{name}.npy": array_bytes(values) for name, values in columns.items()}
    files[ABOUT] = json.dumps({**about, "columns": list(columns)}, allow_nan=False).encode()
    if folder.is_dir():
        write_together({folder / name: data for name, data in files.items()}, force=True)
    else:
        write_folder(folder, files)


def kept_record(folder: Path) -> LoopRecord:
    """Record of what :func:`keep_record` wrote.

    Raises
    ------
    FileAccessError
        It is not there.
    DataError
        It is damaged.
    """
    about = read_json(folder / ABOUT, "a record", "read the file again")
    try:
        columns = {
            name: np.load(folder / f"{name}.npy", mmap_mode="r", allow_pickle=False) for name in about["columns"]
        }
        known = {name: about[name] for name in FACTS}
        tuples = {name: tuple(known[name]) for name in ("gaps", "notes", "made_up", "gap_seconds")}
        spans = {name: None if about[name] is None else (about[name][0], about[name][1]) for name in SPANS}
        return LoopRecord(**columns, **{**known, **tuples, **spans}, start=about["start"])
    except (KeyError, TypeError, ValueError, OSError, IndexError) as error:
        raise DataError.expected("a record as it was kept", type(error).__name__, "read the file again") from error
