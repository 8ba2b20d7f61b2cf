"""What is new since an earlier run."""

from __future__ import annotations

from dataclasses import dataclass

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from lostmotion.store.schema import assessment, loop

QUIET = ("none", "cannot tell")
SEVERITIES = ("unknown", "none", "low", "moderate", "high", "severe")  # from nothing to worst


@dataclass(frozen=True)
class New:
    """One loop that is another than it was.

    Attributes
    ----------
    tag : str
    what : str
        "found", "worse", "better", "other" (another verdict) or "gone" (none now).
    before, after : str
        Verdicts; empty: the loop was not in that run.
    severity_before, severity_after : str
    """

    tag: str
    what: str
    before: str
    after: str
    severity_before: str
    severity_after: str


def news(connection: Connection, number: int, earlier: int, limit: int | None = None) -> list[New]:
    """Loops that differ between two runs, by tag; the last window of each loop counts.

    That a verdict can no longer be reached is no news of the valve: it is left out.
    """
    after, before = assessment.alias("after"), assessment.alias("before")
    of_before = (before.c.run_id == earlier) & before.c.newest & (before.c.loop_id == after.c.loop_id)
    joined = after.join(loop, loop.c.id == after.c.loop_id).outerjoin(before, of_before)
    quiet = before.c.verdict.is_(None) | before.c.verdict.in_(QUIET)
    other = (after.c.verdict != before.c.verdict) | (after.c.severity != before.c.severity)
    found = quiet & after.c.verdict.not_in(QUIET)
    changed = before.c.verdict.not_in(QUIET) & (after.c.verdict != "cannot tell") & other
    asked = sa.select(loop.c.tag, before.c.verdict, after.c.verdict, before.c.severity, after.c.severity)
    asked = asked.select_from(joined).where((after.c.run_id == number) & after.c.newest & (found | changed))
    lines = connection.execute(asked.order_by(loop.c.tag).limit(limit))
    return [_new(tag, *(word or "" for word in words)) for tag, *words in lines]


def _new(tag: str, before: str, after: str, severity_before: str, severity_after: str) -> New:
    if before in ("", *QUIET):
        what = "found"
    elif after == "none":
        what = "gone"
    elif before != after:
        what = "other"
    else:
        what = "worse" if _rank(severity_after) > _rank(severity_before) else "better"
    return New(tag, what, before, after, severity_before, severity_after)


def _rank(severity: str) -> int:
    return SEVERITIES.index(severity) if severity in SEVERITIES else 0
