"""What is new since the last run, loop by loop."""

from __future__ import annotations

from dataclasses import dataclass

from lostmotion.audit.plant_view import CLEARED, FAULTS, PlantView
from lostmotion.audit.row_facts import ends_percent, status_words
from lostmotion.report.plant.words import interval_words, of_what, size_words
from lostmotion.store.rows import AssessmentRow, Stage

ORDER = ("new finding", "grew", "another fault", "no longer found", "shrank", "new loop", "not seen any more")


@dataclass(frozen=True)
class Change:
    """One loop that is not as it was.

    Attributes
    ----------
    tag : str
    what : str
        Of ORDER.
    before, now : str
    """

    tag: str
    what: str
    before: str
    now: str


def changes(view: PlantView) -> tuple[Change, ...]:
    """Those that matter, most urgent first; of a size only what the intervals show."""
    if not view.previous:
        return ()
    now = {row.tag: row for row in view.leading}
    found = [_change(tag, view.before.get(tag), row) for tag, row in now.items()]
    found += [Change(tag, "not seen any more", said(row), "") for tag, row in view.before.items() if tag not in now]
    return tuple(sorted((one for one in found if one), key=lambda one: ORDER.index(one.what)))


def _change(tag: str, before: AssessmentRow | None, now: AssessmentRow) -> Change | None:
    if before is None:
        return Change(tag, "new loop", "", said(now))
    what = _what(before, now)
    return Change(tag, what, said(before), said(now)) if what else None


def _what(before: AssessmentRow, now: AssessmentRow) -> str:
    was, is_ = before.verdict in FAULTS, now.verdict in FAULTS
    if is_ and not was:
        return "new finding"
    if was and not is_:
        cleared = now.stage is Stage.ASSESSED and now.verdict in CLEARED
        return "no longer found" if cleared else ""
    if not is_:
        return ""
    if before.verdict != now.verdict:
        return "another fault"
    old, new = ends_percent(before), ends_percent(now)
    if old is None or new is None:
        return ""
    return "grew" if new[0] > old[1] else "shrank" if new[1] < old[0] else ""


def said(row: AssessmentRow) -> str:
    """Verdict and size, short."""
    size = size_words(row)
    return f"{status_words(row)}, {size} % {of_what(row)} ({interval_words(row)})" if size else status_words(row)
