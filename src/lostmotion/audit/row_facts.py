"""What follows from a row alone, for texts, pages and figures alike."""

from __future__ import annotations

from lostmotion.store.changed import ends_percent
from lostmotion.store.rows import AssessmentRow, Stage

__all__ = ["ends_percent", "status_words"]


def status_words(row: AssessmentRow) -> str:
    """Verdict of an assessed loop, else how far it came."""
    if row.stage is Stage.ASSESSED:
        return row.verdict
    return "failed" if row.stage is Stage.FAILED else "not assessed"
