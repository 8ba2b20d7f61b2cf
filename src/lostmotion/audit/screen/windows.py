"""Windows of a record: whole, or pieces that begin at whole multiples of their length in UTC."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.audit.settings import AuditSettings
from lostmotion.errors import ParameterError
from lostmotion.records import LoopRecord
from lostmotion.store.rows import UNDATED

SAME = 1e-6  # of a sampling time: a row this little before an edge is at it


@dataclass(frozen=True)
class Window:
    """One assessment's part of a record.

    Attributes
    ----------
    start, end : datetime
        UTC; `end` is not included. Counted from UNDATED where the record has no dates.
    record : LoopRecord
    """

    start: datetime
    end: datetime
    record: LoopRecord


def windows_of(record: LoopRecord, settings: AuditSettings) -> Iterator[Window]:
    """Cut a record into the windows of an audit, in order of time; pieces of a single row are left out.

    Raises
    ------
    ParameterError
        A window that is not positive and finite.

    Examples
    --------
    >>> record = LoopRecord(op=range(600), pv=range(600), dt=10.0, start="2026-03-01 06:50")
    >>> [(one.start.hour, len(one.record)) for one in windows_of(record, AuditSettings(window=3600.0))]
    [(6, 60), (7, 360), (8, 180)]
    """
    start = in_utc(record.start)
    times = seconds_of_rows(record)
    if settings.window is None:
        yield Window(start, start + timedelta(seconds=float(times[-1]) + record.dt), record)
        return
    if not (np.isfinite(settings.window) and settings.window > 0.0):
        raise ParameterError.expected("a window > 0", settings.window, "give seconds, or None for the whole record")
    yield from _pieces(record, (start - UNDATED).total_seconds() + times, settings.window)


def _pieces(record: LoopRecord, times: FloatArray, length: float) -> Iterator[Window]:
    """Runs of rows with the same number of a window; `times` are seconds since UNDATED."""
    numbers = np.floor((times + SAME * record.dt) / length)
    edges = np.r_[0, np.flatnonzero(np.diff(numbers)) + 1, len(record)]
    for first, last in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        if last - first >= 2:
            begin = UNDATED + timedelta(seconds=float(numbers[first]) * length)
            yield Window(begin, begin + timedelta(seconds=length), record.cut(first, last))


def in_utc(moment: datetime | None) -> datetime:
    """A moment in UTC; one without a time zone counts as UTC, none at all as UNDATED."""
    if moment is None:
        return UNDATED
    return moment.replace(tzinfo=UTC) if moment.tzinfo is None else moment.astimezone(UTC)


def seconds_of_rows(record: LoopRecord) -> FloatArray:
    """From the first row to each, shape (n,); a gap of unknown length counts as none."""
    times = np.arange(len(record), dtype=np.float64) * record.dt
    for row, lost in zip(record.gaps, record.gap_seconds, strict=False):
        times[row:] += lost
    return np.asarray(times)
