"""When a loop is another than it was: one rule, for the questions of pages and for reports."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from lostmotion.store.rows import AssessmentRow, Stage

ORDER = ("new finding", "grew", "another fault", "no longer found", "shrank", "new loop", "not seen any more")


@dataclass(frozen=True)
class New:
    """One loop that is another than it was.

    Attributes
    ----------
    tag : str
    what : str
        Of ORDER.
    before, after : str
        What is said of it; empty: the loop was not in that run.
    severity_before, severity_after : str
    """

    tag: str
    what: str
    before: str
    after: str
    severity_before: str
    severity_after: str

    def __post_init__(self) -> None:
        """Raise ValueError where it is none of ours: a row of a damaged store."""
        if self.what not in ORDER or not all(isinstance(text, str) for text in (self.tag, self.before, self.after)):
            raise ValueError(f"{self.what!r} as what has changed")


def changed(before: AssessmentRow | None, now: AssessmentRow | None) -> str:
    """What has changed, of ORDER; empty: nothing that matters. Of a size only what the intervals show.

    That a verdict can no longer be reached, or a swing is no longer blamed on the loop, is no news of it.
    """
    if before is None or now is None:
        return "new loop" if before is None else "not seen any more"
    was, is_ = before.is_finding, now.is_finding
    if is_ and not was:
        return "new finding"
    if not is_:
        return "no longer found" if was and _gone(before, now) else ""
    if before.said != now.said:
        return "another fault"
    old, new = ends_percent(before), ends_percent(now)
    if old is None or new is None:
        return ""
    return "grew" if new[0] > old[1] else "shrank" if new[1] < old[0] else ""


def _gone(before: AssessmentRow, now: AssessmentRow) -> bool:
    """Whether a finding is no longer there: of a valve that was cleared; a rule of the audit that no longer holds."""
    if now.stage is not Stage.ASSESSED:
        return False
    if not before.rule:
        return now.cleared
    return now.fit_for_use and not now.rule and now.verdict != "other oscillation"


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


def newest(rows: Iterable[AssessmentRow]) -> dict[str, AssessmentRow]:
    """The last window of each loop, by tag: what it is compared by."""
    return {row.tag: row for row in sorted(rows, key=lambda row: row.window_start)}


def differences(
    before: Sequence[AssessmentRow], now: Sequence[AssessmentRow]
) -> list[tuple[str, AssessmentRow | None, AssessmentRow | None]]:
    """What has changed with each loop, its row before and its row now, in the order of ORDER and by tag."""
    old, new = newest(before), newest(now)
    pairs = {tag: (old.get(tag), new.get(tag)) for tag in sorted({*old, *new})}
    found = [(what, *pair) for pair in pairs.values() if (what := changed(*pair))]
    return sorted(found, key=lambda one: ORDER.index(one[0]))
