"""What is reported of a loop in one line: needs no database, so that reports of a record have it too."""

from __future__ import annotations

from typing import NamedTuple

from lostmotion.store.rows import Stage, diagnosed


class Judged(NamedTuple):
    """Whether a loop was judged, and what is said of its data."""

    tag: str
    stage: Stage
    verdict: str
    rule: str
    fit_for_use: bool
    error: str
    reason: str
    why: str
    health: tuple[str, ...]

    @property
    def said(self) -> str:
        """As the row has it."""
        return self.rule or diagnosed(self.stage, self.verdict)
