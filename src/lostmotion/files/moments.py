"""A column of dates beside one of times of day -> one column of both."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import narwhals.stable.v2 as nw

from lostmotion.files.dates import all_are
from lostmotion.files.names import CLOCKS, DATES
from lostmotion.files.number_cells import is_text, text_cells
from lostmotion.files.table import Table
from lostmotion.files.tags import folded
from lostmotion.files.text_frame import TextFrame

MOMENTS = "Date Time"


def with_moments(table: Table) -> Table:
    """The table with one column in place of its column of dates and its column of times of day, where it has both.

    Examples
    --------
    >>> import polars as pl
    >>> frame = pl.DataFrame({"Date": ["1.2.2024", "1.2.2024"], "Time": ["09:00:00", "09:00:05"], "OP": ["1", "2"]})
    >>> joined = with_moments(Table(nw.from_native(frame, eager_only=True), "a"))
    >>> joined.names, joined.column("Date Time")[0]
    (['OP', 'Date Time'], '1.2.2024 09:00:00')
    """
    found = moment_columns(table)
    if found is None:
        return table
    date, clock = found
    both = nw.concat_str(nw.col(date), nw.col(clock), separator=" ").alias(MOMENTS)
    frame = table.frame
    if isinstance(frame, TextFrame):
        joined: nw.DataFrame[Any] | TextFrame = frame.with_column(
            frame.select([date, clock]).select(both)[MOMENTS], without=(date, clock)
        )
    else:
        joined = frame.with_columns(both).drop(date, clock)
    note = f"Times were read from {date!r} and {clock!r} together."
    return replace(table, frame=joined, notes=(*table.notes, note))


def moment_columns(table: Table) -> tuple[str, str] | None:
    """Name of the one column of dates and of the one of times of day; None where there are not both."""
    dates, clocks = (_called(table, names) for names in (DATES, CLOCKS))
    if len(dates) != 1 or len(clocks) != 1 or MOMENTS in table.names:
        return None
    cells = [text_cells(table.column(name)) for name in (dates[0], clocks[0])]
    return (dates[0], clocks[0]) if all_are(cells[0], dated=True) and all_are(cells[1], dated=False) else None


def _called(table: Table, names: tuple[str, ...]) -> list[str]:
    return [name for name in table.names if folded(name) in names and is_text(table.column(name))]
