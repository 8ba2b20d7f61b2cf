"""What is new since an earlier run."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime

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


Said = tuple[str, str]  # verdict and severity


def news(connection: Connection, number: int, earlier: int) -> list[New]:
    """Loops that differ between two runs, by tag; the last window of each loop counts.

    That a verdict can no longer be reached is no news of the valve: it is left out.
    """
    after, before = _findings(connection, number), _findings(connection, earlier)
    after |= _said(connection, number, before.keys() - after.keys())
    before |= _said(connection, earlier, after.keys() - before.keys())
    found = [(loop_id, _compared(before.get(loop_id), after.get(loop_id))) for loop_id in sorted(after)]
    changed = {loop_id: one for loop_id, one in found if one}
    tags = _tags(connection, changed)
    lines = [
        New(tags[loop_id], what, *_both(before.get(loop_id), after.get(loop_id))) for loop_id, what in changed.items()
    ]
    return sorted(lines, key=lambda one: one.tag)


def _both(before: Said | None, after: Said | None) -> tuple[str, str, str, str]:
    first, then = before or ("", ""), after or ("", "")
    return first[0], then[0], first[1], then[1]


def _compared(before: Said | None, after: Said | None) -> str:
    if after is None or after[0] == "cannot tell":
        return ""
    if before is None or before[0] in QUIET:
        return "" if after[0] in QUIET else "found"
    if after[0] == "none":
        return "gone"
    if before[0] != after[0]:
        return "other"
    step = _rank(after[1]) - _rank(before[1])
    return "worse" if step > 0 else "better" if step < 0 else ""


def _rank(severity: str) -> int:
    return SEVERITIES.index(severity) if severity in SEVERITIES else 0


def _findings(connection: Connection, number: int) -> dict[int, Said]:
    """Loops of a run whose last window has a fault."""
    verdict = assessment.c.verdict
    ids = sa.select(assessment.c.loop_id).where((assessment.c.run_id == number) & verdict.not_in(QUIET)).distinct()
    said = _said(connection, number, connection.scalars(ids))
    return {loop_id: one for loop_id, one in said.items() if one[0] not in QUIET}


def _said(connection: Connection, number: int, loops: Iterable[int]) -> dict[int, Said]:
    """Last window of loops."""
    columns = assessment.c
    found: dict[int, tuple[datetime, Said]] = {}
    ids = sorted(loops)
    for first in range(0, len(ids), 500):
        asked = sa.select(columns.loop_id, columns.window_start, columns.verdict, columns.severity)
        here = (columns.run_id == number) & columns.loop_id.in_(ids[first : first + 500])
        for loop_id, start, verdict, severity in connection.execute(asked.where(here)):
            if loop_id not in found or start > found[loop_id][0]:
                found[loop_id] = start, (verdict, severity)
    return {loop_id: said for loop_id, (_, said) in found.items()}


def _tags(connection: Connection, loops: Iterable[int]) -> dict[int, str]:
    ids = sorted(loops)
    found: dict[int, str] = {}
    for first in range(0, len(ids), 500):
        asked = sa.select(loop.c.id, loop.c.tag).where(loop.c.id.in_(ids[first : first + 500]))
        found.update((one.id, one.tag) for one in connection.execute(asked))
    return found
