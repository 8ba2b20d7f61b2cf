"""Of Parquet only the rows of the time that is asked for, where that gives the record that all rows would give."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

import polars as pl

from lostmotion.files.columns import usual


@dataclass(frozen=True)
class Period:
    """From `since` on and before `until`, both with a time zone; None: open."""

    since: datetime | None = None
    until: datetime | None = None

    def __bool__(self) -> bool:
        return self.since is not None or self.until is not None

    def of(self, scan: pl.LazyFrame, names: Sequence[str]) -> pl.DataFrame | None:
        """These rows of a table; None: all of it must be read.

        That is where its times are no times, or several columns could be; where a value is missing, which may stand
        before the first of these rows (modes and set points are often written when they change); and where the rows do
        not follow each other in equal steps, so that the sampling time rests on all of them.
        """
        column = self._column(scan, names)
        if column is None:
            return None
        frame = scan.filter(self._inside(column, scan.collect_schema()[column])).collect()
        return frame if _whole(frame, column) else None

    def _column(self, scan: pl.LazyFrame, names: Sequence[str]) -> str | None:
        fits = usual("time", names) if self else []
        known = len(fits) == 1 and isinstance(scan.collect_schema()[fits[0]], pl.Datetime)
        return fits[0] if known else None

    def _inside(self, column: str, kind: pl.DataType) -> pl.Expr:
        zone = kind.time_zone if isinstance(kind, pl.Datetime) else None
        inside = pl.lit(value=True)
        if self.since is not None:
            inside &= pl.col(column) >= _moment(self.since, zone)
        if self.until is not None:
            inside &= pl.col(column) < _moment(self.until, zone)
        return inside


def _moment(moment: datetime, zone: str | None) -> pl.Expr:
    """As the column has it; one without a zone is compared as UTC."""
    there = pl.lit(moment.astimezone(UTC))
    return there.dt.convert_time_zone(zone) if zone else there.dt.replace_time_zone(None)


def _whole(frame: pl.DataFrame, column: str) -> bool:
    """Rows without a missing value, one after another in equal steps."""
    if frame.height < 2 or any(frame.null_count().row(0)):
        return False
    steps = frame[column].diff().drop_nulls()
    return bool(steps.min() == steps.max())
