"""Columns of a record as a page draws them: in memory, or kept in a folder and mapped from there."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion.errors import DataError
from lostmotion.files.schema import checked, each, group, number, or_null, parsed, row, text, whole
from lostmotion.files.writer import Buffer, write_folder
from lostmotion.records import LoopRecord
from lostmotion.records.modes import rows_of
from lostmotion.web.trend.pyramid import Pyramid, Rows, levels

SIGNALS = ("sp", "pv", "op", "position")
KINDS = ("missing", "manual", "at a limit")  # what a diagnosis does not use
FACTS = "facts.json"
MARGIN = 1e-3  # of the span: as near to its end OP is at a limit
_TEXTS = ("tag", "source", "op_unit", "pv_unit")
_SCHEMA = group(
    rows=whole(2), dt=number(1e-9), start=or_null(text(40)), signals=each(text(20), len(SIGNALS)),
    gap_seconds=each(number(), 1 << 24), op_span=or_null(row(number(), number())),
    pv_span=or_null(row(number(), number())), **{name: text() for name in _TEXTS},
)  # fmt: skip


@dataclass(frozen=True)
class Columns:
    """Signals of a loop, and what of them a diagnosis does not use.

    Attributes
    ----------
    facts : mapping
        "rows", "dt", "start" (ISO text or None), "signals", "gap_seconds", "op_span", "pv_span", "tag", "source",
        "op_unit", "pv_unit".
    signals : mapping of str to Pyramid
        By their names in SIGNALS.
    shaded : mapping of str to ndarray, shape (m, 2)
        First row and row behind the last of each stretch, by their names in KINDS.
    gaps : ndarray
        Rows before which time is missing.
    """

    facts: Mapping[str, Any]
    signals: Mapping[str, Pyramid]
    shaded: Mapping[str, Rows]
    gaps: Rows

    @classmethod
    def of(cls, record: LoopRecord, blocks: bool = False) -> Columns:
        """Columns of a record; with `blocks` the extremes of blocks, which pays for long ones that are kept."""
        signals = {name: value for name in SIGNALS if (value := getattr(record, name)) is not None}
        facts: dict[str, Any] = {name: getattr(record, name) for name in _TEXTS}
        facts |= {"rows": len(record), "dt": record.dt, "signals": list(signals)}
        facts |= {"start": None if record.start is None else record.start.isoformat()}
        facts |= {name: None if (span := getattr(record, name)) is None else [*span] for name in ("op_span", "pv_span")}
        facts |= {"gap_seconds": [float(one) for one in record.gap_seconds]}
        pyramids = {name: Pyramid.of(value, blocks) for name, value in signals.items()}
        return cls(facts, pyramids, _unused(record), np.array(record.gaps, dtype=np.int64))

    def __len__(self) -> int:
        return int(self.facts["rows"])

    @property
    def dt(self) -> float:
        """Sampling time in seconds."""
        return float(self.facts["dt"])

    def moment(self, at: int) -> datetime | None:
        """When a row was recorded; None where it is not known."""
        start, lost = self.facts["start"], self.facts["gap_seconds"]
        behind = int(np.searchsorted(self.gaps, at, side="right"))
        if start is None or (behind and not lost):
            return None
        return datetime.fromisoformat(start) + timedelta(seconds=at * self.dt + sum(lost[:behind]))


def keep(record: LoopRecord, folder: Path) -> None:
    """Write the columns of a record into a folder that is not there yet; it appears with all of them at once.

    Raises
    ------
    FileAccessError
        The folder cannot be made.
    """
    columns = Columns.of(record, blocks=True)
    files: dict[str, Buffer] = {
        FACTS: json.dumps(dict(columns.facts), allow_nan=False).encode(),
        "gaps.npy": array_bytes(columns.gaps),
    }
    for name, pyramid in columns.signals.items():
        files |= {f"{name}.{part}.npy": array_bytes(getattr(pyramid, part)) for part in ("values", "low", "high")}
    files |= {f"{kind}.npy": array_bytes(columns.shaded.get(kind, np.empty((0, 2), np.int64))) for kind in KINDS}
    write_folder(folder, files)


def kept(folder: Path) -> Columns:
    """Columns that were kept; the signals stay on the disk until they are drawn.

    Raises
    ------
    DataError
        They are not there, not whole, or no columns of a record.
    """
    try:
        facts = checked(parsed((folder / FACTS).read_bytes()), _SCHEMA, "kept columns", "read the record again")
        rows = facts["rows"]
        blocks = sum(count for _, count in levels(rows))
        signals = {
            name: Pyramid(
                _mapped(folder / f"{name}.values.npy", rows),
                _mapped(folder / f"{name}.low.npy", blocks),
                _mapped(folder / f"{name}.high.npy", blocks),
            )
            for name in SIGNALS
            if name in facts["signals"]
        }
        shaded = {kind: _mapped(folder / f"{kind}.npy") for kind in KINDS}
        return Columns(facts, signals, shaded, _mapped(folder / "gaps.npy"))
    except (OSError, ValueError) as error:
        raise DataError.expected("kept columns", str(error)[:200], "read the record again") from error


def array_bytes(values: npt.NDArray[Any]) -> memoryview:
    """An array as the bytes of an .npy file."""
    stream = io.BytesIO()
    np.lib.format.write_array(stream, np.ascontiguousarray(values), allow_pickle=False)
    return stream.getbuffer()


def stretches(flags: npt.NDArray[np.bool_]) -> Rows:
    """First row and row behind the last of each stretch of True, shape (m, 2).

    Examples
    --------
    >>> stretches(np.array([True, False, True, True])).tolist()
    [[0, 1], [2, 4]]
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return np.asarray(edges.reshape(-1, 2), dtype=np.int64)


def _unused(record: LoopRecord) -> dict[str, Rows]:
    found = {"missing": stretches(record.missing)}
    automatic = rows_of("automatic", record.mode)
    if automatic is not None:
        found["manual"] = stretches(~automatic)
    if record.op_span is not None:
        low, high = record.op_span
        margin = MARGIN * (high - low)
        found["at a limit"] = stretches((record.op <= low + margin) | (record.op >= high - margin))
    return found


def _mapped(path: Path, size: int | None = None) -> npt.NDArray[Any]:
    """Array of a file; an empty one cannot be mapped."""
    found: npt.NDArray[Any] = np.load(path, mmap_mode="r", allow_pickle=False)
    if size is not None and found.shape != (size,):
        raise ValueError(f"{path.name} has the shape {found.shape}, not ({size},)")
    return found
