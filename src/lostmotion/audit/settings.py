"""Settings of an audit that decide about its results."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass, field, fields
from datetime import datetime
from typing import Any

from lostmotion.diagnose.op_span import TOLERANCE

LOOP_MINUTES = 30.0  # a diagnosis takes seconds


@dataclass(frozen=True)
class AuditSettings:
    """What the rows of an audit depend on, beside data and code.

    Attributes
    ----------
    tolerance : float
        Lost motion that does not matter, as a share of the span of OP.
    window : float, optional
        Seconds of an assessment; windows begin at whole multiples of it. None: all that the source has of a loop.
    since, until : datetime, optional
        With time zone.
    screen_only : bool
        Nothing is diagnosed.
    cpu_minutes : float, optional
        Processor time of the diagnoses together; the most valuable come first. None: no limit.
    loop_minutes : float, optional
        On the clock, for one loop in one window; what takes longer has failed. None: no limit.
    """

    tolerance: float = TOLERANCE
    window: float | None = None
    since: datetime | None = field(default=None)
    until: datetime | None = field(default=None)
    screen_only: bool = False
    cpu_minutes: float | None = None
    loop_minutes: float | None = LOOP_MINUTES

    def digest(self) -> str:
        """16 hex digits of those that change a row; how long it may take and from when on are none of them."""
        apart = ("cpu_minutes", "loop_minutes", "screen_only", "since", "until")
        kept: dict[str, Any] = {one.name: getattr(self, one.name) for one in fields(self) if one.name not in apart}
        return hashlib.sha256(json.dumps(kept, sort_keys=True, default=str).encode()).hexdigest()[:16]
