"""What follows from a row alone, for texts, pages and figures alike."""

from __future__ import annotations

from lostmotion.store.rows import AssessmentRow, Stage


def ends_percent(row: AssessmentRow) -> tuple[float, float] | None:
    """95 % interval of the size in % of span; None where there is none.

    Examples
    --------
    >>> from lostmotion.store.rows import UNDATED
    >>> ends_percent(AssessmentRow("FIC-1", UNDATED, UNDATED, size=0.5, low=0.25, high=1.0, size_percent=1.0))
    (0.5, 2.0)
    """
    if row.size is None or row.size_percent is None or row.low is None or row.high is None or not row.size:
        return None
    each = row.size_percent / row.size
    return row.low * each, row.high * each


def status_words(row: AssessmentRow) -> str:
    """Verdict of an assessed loop, else how far it came."""
    if row.stage is Stage.ASSESSED:
        return row.verdict
    return "failed" if row.stage is Stage.FAILED else "not assessed"
