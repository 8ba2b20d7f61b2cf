"""ListedSource: the loops of a loop list, in the data of another source."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from functools import cached_property
from typing import Any, Protocol, runtime_checkable

from lostmotion.errors import LostMotionError
from lostmotion.files.tags import same_tag
from lostmotion.plant.address import parsed
from lostmotion.plant.loop import PlantLoop
from lostmotion.plant.loop_list import in_loop_list
from lostmotion.plant.source import PlantSource, Unread
from lostmotion.records.record import LoopRecord

OVER = (
    "op",
    "pv",
    "sp",
    "mode",
    "loop_type",
    "op_span",
    "pv_span",
    "op_unit",
    "pv_unit",
    "area",
    "notes",
    "dt",
    "slave",
    "time",
)


@runtime_checkable
class _Placing(Protocol):
    """A source of files."""

    def placed(self, loop: PlantLoop) -> PlantLoop: ...


@runtime_checkable
class _Holding(Protocol):
    """A source that knows the names of its columns."""

    def holding(self, columns: Collection[str]) -> str: ...


@dataclass(frozen=True)
class ListedSource:
    """Loops as a list names them; what the list leaves open is as the source says.

    Parameters
    ----------
    base : PlantSource
        Where the data are.
    listed : tuple of PlantLoop
        Found in the data by their `where` (the column `file`), else by their tag, else by their columns.
    notes : tuple of str
        What was passed over in the list.
    """

    base: PlantSource
    listed: tuple[PlantLoop, ...]
    notes: tuple[str, ...] = ()

    def loops(self) -> tuple[PlantLoop, ...]:
        """Loops of the list that have data, in its order."""
        return self._found[0]

    def unread(self) -> tuple[Unread, ...]:
        """Loops of the list without data, loops that are not in it, and what the source does not read."""
        return self._found[1]

    def read(
        self, loops: Sequence[PlantLoop], since: datetime | None = None, until: datetime | None = None
    ) -> Iterator[tuple[PlantLoop, LoopRecord | LostMotionError]]:
        """Record of each loop; see :class:`lostmotion.plant.PlantSource`."""
        return self.base.read(loops, since, until)

    def __reduce__(self) -> tuple[Any, ...]:
        return ListedSource, (self.base, ())  # a worker is told which loops to read

    @cached_property
    def _found(self) -> tuple[tuple[PlantLoop, ...], tuple[Unread, ...]]:
        there = self.base.loops()
        by_tag = {loop.tag: loop for loop in there}
        by_where = {loop.where: loop for loop in there}
        found: list[PlantLoop] = []
        out: list[Unread] = []
        taken: set[str] = set()
        for loop in self.listed:
            try:
                known = by_where.get(loop.where) if loop.where else _of_tag(loop.tag, by_tag)
                made = self._placed(loop) if known is None else _merged(loop, known)
            except LostMotionError as error:
                out.append(Unread(loop.tag, in_loop_list(" ".join(str(error).split()))))
                continue
            if made is None:
                out.append(Unread(loop.tag, _nothing(loop, list(by_tag))))
                continue
            found.append(made)
            taken |= {file for place in parsed(made.where) for file in place.files}
            taken.add(made.where)
        other = [
            Unread(loop.where, f"{loop.tag!r} is not in the loop list", failed=False)
            for loop in there
            if loop.where not in taken
        ]
        rest = [one for one in self.base.unread() if one.where not in taken]
        said = [Unread("the loop list", note, failed=False) for note in self.notes]
        return tuple(found), (*said, *out, *other, *rest)

    def _placed(self, loop: PlantLoop) -> PlantLoop | None:
        """Loop with the address of its data; None: there are none."""
        where = loop.where
        if not where and isinstance(self.base, _Holding):
            where = self.base.holding([name for name in (loop.op, loop.pv, loop.sp, loop.mode) if name])
        if not where:
            return None
        found = replace(loop, where=where)
        return self.base.placed(found) if isinstance(self.base, _Placing) else found


def _of_tag(tag: str, by_tag: dict[str, PlantLoop]) -> PlantLoop | None:
    """Loop of the same tag, but for case, separators and the letters IC."""
    if tag in by_tag:
        return by_tag[tag]
    fits = [other for other in by_tag if same_tag(tag, other)]
    return by_tag[fits[0]] if len(fits) == 1 else None


def _merged(loop: PlantLoop, known: PlantLoop) -> PlantLoop:
    """What the list says, else what the source says."""
    own = {name: getattr(loop, name) for name in OVER if getattr(loop, name) not in ("", None, ())}
    return replace(known, tag=loop.tag, weight=loop.weight, **own)


def _nothing(loop: PlantLoop, tags: Sequence[str]) -> str:
    shown = ", ".join(tags[:5])
    more = f" and {len(tags) - 5} more" if len(tags) > 5 else ""
    named = f" nor of columns {loop.op!r} and {loop.pv!r}" if loop.op else ""
    said = f"the source has {shown}{more}" if tags else "the source has no loop that tells its tag"
    return f"expected data of {loop.tag!r}{named}, got none: {said}; name the file in the loop list"
