"""What follows from a row alone, for texts, pages and figures alike."""

from __future__ import annotations

from lostmotion.audit.rules import rule_of
from lostmotion.store.changed import ends_percent
from lostmotion.store.rows import AssessmentRow, Stage

__all__ = ["ends_percent", "said_words", "status_words"]


def status_words(row: AssessmentRow) -> str:
    """Verdict of an assessed loop, else how far it came."""
    if row.stage is Stage.ASSESSED:
        return row.verdict
    return "failed" if row.stage is Stage.FAILED else "not assessed"


def said_words(row: AssessmentRow) -> str:
    """What is said of a loop: by the rule that decides its priority, else by its diagnosis.

    Examples
    --------
    >>> from lostmotion.store.rows import UNDATED
    >>> reason = "hardly settles: retune (its amplitude comes and goes); swings every 300 s, 90 % of the variance"
    >>> row = AssessmentRow("FIC-1", UNDATED, UNDATED, priority=36.0, priority_reason=reason)
    >>> said_words(row), status_words(row)
    ('ringing', 'not assessed')
    """
    rule = rule_of(row)
    return status_words(row) if rule is None else rule.name
