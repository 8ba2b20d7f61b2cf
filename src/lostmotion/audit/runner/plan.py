"""What a run has to do: loops of the source as rows, what decides about them, which are worth an assessment."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

from lostmotion.errors import DataError
from lostmotion.plant import PlantLoop, Unread
from lostmotion.store.encoded import as_json, clean
from lostmotion.store.run_rows import LoopRow, UnreadRow

NOT_DECIDING = ("area", "weight", "size", "stamp", "notes")  # of a loop: they are ranked by, or told apart
BUDGET = "not assessed: the processor time went to more valuable ones"


def definition(loop: PlantLoop) -> str:
    """16 hex digits of what the loop list says and the results depend on: columns, spans, units, type, address."""
    kept = {one.name: getattr(loop, one.name) for one in fields(loop) if one.name not in NOT_DECIDING}
    return hashlib.sha256(as_json(kept).encode()).hexdigest()[:16]


def loop_row(loop: PlantLoop) -> LoopRow:
    """Loop as the store keeps it."""
    return LoopRow(**{one.name: getattr(loop, one.name) for one in fields(LoopRow)})


def unread_row(one: Unread) -> UnreadRow:
    """What gives no loop, as the store keeps it."""
    return UnreadRow(one.where, one.why, one.failed)


def loops_of(loops: Sequence[PlantLoop]) -> dict[str, PlantLoop]:
    """Loops by tag, as every database can keep it, in their order.

    Raises
    ------
    DataError
        None at all, or two with one tag.
    """
    if not loops:
        raise DataError.expected("loops in the source", "none", "see what of it could not be read, or give a loop list")
    named = [replace(loop, tag=clean(loop.tag)) for loop in loops]
    twice = sorted(tag for tag, times in Counter(loop.tag for loop in named).items() if times > 1)
    if twice:
        more = f" and {len(twice) - 1} more" if len(twice) > 1 else ""
        raise DataError.expected(
            "loops with different tags", f"two with {twice[0]!r}{more}", "give each its own in a loop list"
        )
    return {loop.tag: loop for loop in named}


@dataclass
class Budget:
    """Processor time that assessments may take together.

    Attributes
    ----------
    seconds : float, optional
        None: no limit.
    spent : float
        Of what is done.
    done, begun : int
        Windows.
    """

    seconds: float | None
    spent: float = 0.0
    done: int = 0
    begun: int = 0

    def allows(self) -> bool:
        """Whether more may be begun, if what is under way takes what the others took."""
        if self.seconds is None:
            return True
        each = self.spent / self.done if self.done else 0.0
        return self.spent + each * (self.begun - self.done) < self.seconds

    def took(self, seconds: float) -> None:
        """A window is done."""
        self.spent += seconds
        self.done += 1


def without_budget(reason: str) -> str:
    """Reason of the screen, without the remark of a run whose budget was spent."""
    return reason.removesuffix(BUDGET).removesuffix("; ")


def over_budget(reason: str) -> str:
    """The same with that remark."""
    first = without_budget(reason)
    return f"{first}; {BUDGET}" if first else BUDGET


def within(batches: Iterable[Any], budget: Budget, size: Callable[[Any], int]) -> Iterator[Any]:
    """Batches until the budget is spent; `size` counts the windows of one."""
    for batch in batches:
        if not budget.allows():
            return
        budget.begun += size(batch)
        yield batch
