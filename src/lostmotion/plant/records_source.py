"""RecordsSource: records that are in memory already."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime

from lostmotion.errors import DataError, LostMotionError
from lostmotion.plant.loop import PlantLoop
from lostmotion.plant.reading import between, checked_range, told
from lostmotion.plant.source import Unread
from lostmotion.records.record import LoopRecord

BYTES = 8  # of a number


@dataclass(frozen=True, eq=False)
class RecordsSource:
    """Loops in memory; it holds the data, and they go wherever it goes.

    Parameters
    ----------
    records : tuple of LoopRecord
        Of different tags.

    Raises
    ------
    DataError
        One without a tag, or two of one tag.
    """

    records: tuple[LoopRecord, ...]

    def __post_init__(self) -> None:
        tags = [record.tag for record in self.records]
        if "" in tags:
            where = f"none in record {tags.index('') + 1} of {len(tags)}"
            raise DataError.expected("a tag of each record", where, "give tag='FIC101', or a mapping of tags")
        twice = next((tag for tag in tags if tags.count(tag) > 1), None)
        if twice is not None:
            both = " and ".join(str(place + 1) for place, tag in enumerate(tags) if tag == twice)
            raise DataError.expected("records of different tags", f"{twice!r} as records {both}", "rename one")

    def loops(self) -> tuple[PlantLoop, ...]:
        """One for each record."""
        return tuple(_loop(record) for record in self.records)

    def unread(self) -> tuple[Unread, ...]:
        """Nothing."""
        return ()

    def read(
        self, loops: Sequence[PlantLoop], since: datetime | None = None, until: datetime | None = None
    ) -> Iterator[tuple[PlantLoop, LoopRecord | LostMotionError]]:
        """Record of each loop; see :class:`lostmotion.plant.PlantSource`."""
        checked_range(since, until)
        known = {record.tag: record for record in self.records}
        for loop in loops:
            if (loop.where or loop.tag) not in known:
                yield loop, DataError.expected(f"a record of {loop.tag!r}", "none of this tag", "check the loop list")
                continue
            try:
                yield loop, told(between(known[loop.where or loop.tag], since, until), loop)
            except LostMotionError as error:
                yield loop, error


def _loop(record: LoopRecord) -> PlantLoop:
    signals = sum(one is not None for one in (record.op, record.pv, record.sp, record.position))
    return PlantLoop(
        record.tag,
        loop_type=record.loop_type,
        op_span=record.op_span,
        pv_span=record.pv_span,
        op_unit=record.op_unit,
        pv_unit=record.pv_unit,
        where=record.tag,
        size=BYTES * signals * len(record),
        stamp=record.fingerprint,
    )


def records_source(records: Mapping[str, LoopRecord] | Sequence[LoopRecord]) -> RecordsSource:
    """Source of records; those of a mapping get its keys as tags."""
    if isinstance(records, Mapping):
        return RecordsSource(tuple(replace(record, tag=str(tag)) for tag, record in records.items()))
    return RecordsSource(tuple(records))
