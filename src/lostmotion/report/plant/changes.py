"""What is new since the last run, loop by loop."""

from __future__ import annotations

from dataclasses import dataclass

from lostmotion.audit.plant_view import PlantView
from lostmotion.audit.row_facts import of_what
from lostmotion.report.plant.words import interval_words, size_words
from lostmotion.store.changed import differences
from lostmotion.store.rows import AssessmentRow


@dataclass(frozen=True)
class Change:
    """One loop that is not as it was.

    Attributes
    ----------
    tag : str
    what : str
        Of :data:`lostmotion.store.changed.ORDER`.
    before, now : str
    """

    tag: str
    what: str
    before: str
    now: str


def changes(view: PlantView) -> tuple[Change, ...]:
    """Those that matter, most urgent first; the last window of each loop counts."""
    if not view.previous:
        return ()
    return tuple(_change(*one) for one in differences(view.previous, view.rows))


def _change(what: str, before: AssessmentRow | None, now: AssessmentRow | None) -> Change:
    tag = next(row.tag for row in (now, before) if row is not None)
    return Change(tag, what, *("" if row is None else said(row) for row in (before, now)))


def said(row: AssessmentRow) -> str:
    """What is said of it with its size, short."""
    size = "" if row.rule else size_words(row)
    return f"{row.said}, {size} % {of_what(row)} ({interval_words(row)})" if size else row.said
