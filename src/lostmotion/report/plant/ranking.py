"""Lines of the ranking: one a loop, ready to be shown."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from markupsafe import Markup

from lostmotion.audit.health import OPEN, Reason, reasons_of
from lostmotion.audit.plant_view import FAULTS, PlantView
from lostmotion.audit.row_facts import of_what
from lostmotion.audit.rules import sure_of
from lostmotion.report.plant.svg.bars import size_bar
from lostmotion.report.plant.words import (
    LETTER,
    excluded_words,
    interval_words,
    next_step,
    other_reasons,
    second_opinion,
    size_words,
    sure_words,
)
from lostmotion.store.rows import AssessmentRow

LEAST_SCALE = 4.0  # % of span: what counts as bad is never the end of the scale


@dataclass(frozen=True)
class Line:
    """What the ranking says of a loop. Texts are not escaped; `bar` is ready SVG.

    Attributes
    ----------
    place : int
        From 1.
    tag, link, area, loop_type, label, letter, verdict, second, kind, size, interval, excluded, sure, reason, step : str
        `second` is what the diagnosis says where a rule of the audit decides.
    review : str
    bar : Markup
    priority : float or None
    size_key, sure_key : float
        For who sorts.
    new : bool
        Something about it is new.
    """

    place: int
    tag: str
    link: str
    area: str
    loop_type: str
    label: str
    letter: str
    verdict: str
    second: str
    kind: str
    size: str
    interval: str
    excluded: str
    sure: str
    reason: str
    step: str
    review: str
    bar: Markup
    priority: float | None
    size_key: float
    sure_key: float
    new: bool


@dataclass(frozen=True)
class Sections:
    """Lines of the ranking by what is to be done about them, each in the order of the ranking.

    Attributes
    ----------
    valves, others : list of Line
        Findings: valves at fault or at their limits; loops to retune, measurements to inspect, valves that never rest.
    sound : list of Line
        Judged, and nothing is wrong with the loop itself.
    undecided : list of Line
    advice : tuple of Reason
        What to do about the undecided loops, once for all of them that need the same.
    """

    valves: list[Line]
    others: list[Line]
    sound: list[Line]
    undecided: list[Line]
    advice: tuple[Reason, ...]


def sections(rows: Sequence[AssessmentRow], all_lines: Sequence[Line]) -> Sections:
    """Sort the lines of rows, in the same order, into sections."""
    found = Sections([], [], [], [], reasons_of((row.tag, next_step(row)) for row in rows if _undecided(row)))
    for row, line in zip(rows, all_lines, strict=True):
        if row.is_finding:
            (found.valves if row.said in FAULTS else found.others).append(line)
        else:
            (found.undecided if row.said in OPEN else found.sound).append(line)
    return found


def _undecided(row: AssessmentRow) -> bool:
    return row.said in OPEN and bool(next_step(row))


def lines(
    view: PlantView, rows: Sequence[AssessmentRow], address: Callable[[str], str], new: frozenset[str], first: int = 1
) -> list[Line]:
    """Lines of rows, in their order; `first` is the place of the first."""
    most = scale(rows)
    return [_line(view, row, place, address, most, row.tag in new) for place, row in enumerate(rows, first)]


def scale(rows: Sequence[AssessmentRow]) -> float:
    """End of the bars in % of span: the upper quarter of what was found, so that one large value hides nothing."""
    sizes = sorted(row.size_percent for row in rows if row.size_percent is not None)
    return max(1.25 * sizes[(3 * len(sizes)) // 4], LEAST_SCALE) if sizes else LEAST_SCALE


def _line(
    view: PlantView, row: AssessmentRow, place: int, address: Callable[[str], str], most: float, new: bool
) -> Line:
    loop, size = view.by_tag[row.tag], size_words(row)
    return Line(
        place=place,
        tag=row.tag,
        link=address(row.tag),
        area=loop.area,
        loop_type=loop.loop_type,
        label=row.label,
        letter=LETTER.get(row.label, "?"),
        verdict=row.said,
        second=second_opinion(row),
        kind="" if row.rule or row.kind in ("none", "unknown", "actuator") else row.kind,
        size=f"{size} % {of_what(row)}" if size else "",
        interval=interval_words(row),
        excluded=excluded_words(row),
        sure=sure_words(row),
        reason=other_reasons(row),
        step=next_step(row),
        review=view.reviews.get(row.tag, ""),
        bar=size_bar(row, most),
        priority=row.priority,
        size_key=row.size_percent or 0.0,
        sure_key=sure_of(row) or 0.0 if row.is_finding or row.rule else 0.0,
        new=new,
    )
