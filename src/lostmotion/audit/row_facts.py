"""What follows from a row alone, for texts, pages and figures alike."""

from __future__ import annotations

import math

from lostmotion.store.changed import ends_percent
from lostmotion.store.rows import DENIED, AssessmentRow, Stage

__all__ = ["ends_percent", "order"]


def order(row: AssessmentRow) -> tuple[float, int, float, float, float]:
    """Key of the ranking: by priority, what has none last.

    Among equals findings come before what cannot be told, that before what is none, what failed last; then by size, by
    probability of a fault, and by what the record leaves open.

    Examples
    --------
    >>> from lostmotion.store.rows import UNDATED
    >>> made = {"stage": Stage.ASSESSED, "priority": 0.0}
    >>> rows = [AssessmentRow(f"FIC-{p}", UNDATED, UNDATED, probability=p, **made) for p in (0.04, 0.24)]
    >>> [row.tag for row in sorted(rows, key=order)]
    ['FIC-0.24', 'FIC-0.04']
    """
    priority = -1.0 if row.priority is None else row.priority
    place = 0 if row.is_finding else 2 if row.said in DENIED else 1
    left = math.inf if row.excluded_percent is None else row.excluded_percent
    place += 3 * (row.stage is Stage.FAILED)
    return -priority, place, -(row.size_percent or 0.0), -(row.probability or 0.0), -left


def in_span(row: AssessmentRow) -> bool:
    """Whether percentages are of the span of OP, not of one that was assumed or of the range seen."""
    return bool(row.indices.get("op_span_known", 1.0))


def of_what(row: AssessmentRow) -> str:
    """Of what the percentages of a row are: the span of OP, one that was assumed, or the range seen."""
    if in_span(row):
        return "of span"
    assumed = row.indices.get("op_span_assumed")
    return f"of an assumed span of {assumed:g}" if assumed else "of the OP range seen"
