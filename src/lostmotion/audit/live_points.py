"""Estimates of a running plant beside the sizes that audits have found: the same valve, told apart."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from lostmotion.audit.plant_view import SizePoint
from lostmotion.errors import Status
from lostmotion.store.rows import AssessmentRow, EstimateRow
from lostmotion.store.run_rows import LoopRow, RunRow
from lostmotion.store.store import Store

MOST = 10_000  # estimates of a loop, the newest: one an hour for a year
SINGLE = 50  # more are thinned to the last of each day
SAID = {Status.OK.name: "dead zone", Status.NOT_SEEN.name: "none seen"}

Estimates = Sequence[tuple[int, EstimateRow]]  # with the number of their watch, the oldest first


def live_estimates(store: Store, run: RunRow, tag: str) -> tuple[tuple[int, EstimateRow], ...]:
    """What watches said of a loop by the end of a run; of the last run all until now."""
    last = store.last_run()
    until = None if last is None or run.number >= last.number else run.ended
    found = [one for one in reversed(store.estimates(tag, MOST)) if until is None or one[1].at <= until]
    if len(found) <= SINGLE:
        return tuple(found)
    return tuple({(watch, row.at.date()): (watch, row) for watch, row in found}.values())


def live_points(found: Estimates, loop: LoopRow, rows: Iterable[AssessmentRow]) -> tuple[SizePoint, ...]:
    """Points of the history of a loop in % of what its sizes are; in words where that is not known."""
    each = percent_each(loop, rows)
    return tuple(_point(watch, row, each) for watch, row in found)


def percent_each(loop: LoopRow, rows: Iterable[AssessmentRow]) -> float | None:
    """% that a unit of OP is: of its span, else as the sizes of its rows have it; None: not known."""
    if loop.op_span is not None:
        return 100.0 / abs(loop.op_span[1] - loop.op_span[0])
    return next((row.size_percent / row.size for row in rows if row.size and row.size_percent), None)


def _point(watch: int, row: EstimateRow, each: float | None) -> SizePoint:
    said = SAID.get(row.status, row.status.lower().replace("_", " "))
    if each is None:
        return SizePoint(row.tag, watch, row.at, f"{said}, {_units(row)}", live=True)
    low, high = (None if end is None else each * end for end in (row.low, row.high))
    if row.status == Status.NOT_SEEN.name:
        return SizePoint(row.tag, watch, row.at, said, excluded=high, live=True)
    return SizePoint(row.tag, watch, row.at, said, each * row.width, low, high, live=True)


def _units(row: EstimateRow) -> str:
    low, high = ("open" if end is None else f"{end:.3g}" for end in (row.low, row.high))
    value = f"{row.width:.3g} " if row.status != Status.NOT_SEEN.name else ""
    return f"{value}({low} .. {high}) units of OP"
