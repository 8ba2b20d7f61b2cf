"""Columns of a record as a page draws them, wherever they lie (:mod:`lostmotion.web.kept_record`)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion.records import LoopRecord
from lostmotion.records.modes import rows_of
from lostmotion.web.trend.pyramid import Pyramid, Rows

SIGNALS = ("sp", "pv", "op", "position")
KINDS = ("missing", "manual", "at a limit")  # what a diagnosis does not use
MARGIN = 1e-3  # of the span: as near to its end OP is at a limit
_TEXTS = ("tag", "source", "op_unit", "pv_unit")


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
