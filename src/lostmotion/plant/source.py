"""PlantSource: what every source of a plant's data can do."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Protocol

from lostmotion.errors import LostMotionError
from lostmotion.plant.loop import PlantLoop
from lostmotion.records import LoopRecord


@dataclass(frozen=True)
class Unread:
    """Something of a source that gives no loop: a file that cannot be read, or that holds none.

    Attributes
    ----------
    where : str
        File or table.
    why : str
        In one line.
    failed : bool
        Whether something is wrong; False: it holds no loop's data by its nature (a text, a list of loops).
    """

    where: str
    why: str
    failed: bool = True


class PlantSource(Protocol):
    """Data of many loops. It can be pickled: workers read by themselves; no data are held."""

    def loops(self) -> tuple[PlantLoop, ...]:
        """All loops, in the order of the source; found from names and beginnings, without reading the data."""
        ...

    def unread(self) -> tuple[Unread, ...]:
        """What gives no loop."""
        ...

    def read(
        self, loops: Sequence[PlantLoop], since: datetime | None = None, until: datetime | None = None
    ) -> Iterator[tuple[PlantLoop, LoopRecord | LostMotionError]]:
        """Record of each loop, one after another in any order; a file with several of them is opened once.

        Parameters
        ----------
        loops : sequence of PlantLoop
            Of those of this source.
        since, until : datetime, optional
            Only what was recorded between them (with time zone; `until` not included).
        """
        ...
