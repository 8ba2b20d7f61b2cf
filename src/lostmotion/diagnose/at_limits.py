"""Whether OP is at a limit for so long that this is what is wrong, where only parts of a record were diagnosed."""

from __future__ import annotations

from dataclasses import replace

from lostmotion.diagnose.advice import advise
from lostmotion.diagnose.control_error.rows import ScreenRows
from lostmotion.diagnose.diagnosis import Item
from lostmotion.diagnose.ringing import Found
from lostmotion.diagnose.verdict import SURE, limits_decide

NAN = float("nan")


def judged_by_limits(found: Found, rows: ScreenRows) -> Found:
    """The diagnosis of parts of a record, or that OP is at a limit for long in all of it.

    The parts are at the rest of the record: what they say of the valve is not what is wrong first.
    """
    limited = rows.share(rows.limited & ~rows.manual)
    if not limits_decide(found.verdict, limited):
        return found
    return replace(
        found,
        verdict="saturation",
        kind="actuator",
        severity="unknown",
        size=NAN,
        size_percent=NAN,
        interval=(NAN, NAN),
        confidence=max(found.confidence, SURE) if found.verdict == "saturation" else SURE,
        why="",
        evidence=(Item("share of time with OP at a limit", limited, 0.0, "of all of the record"), *found.evidence),
        advice=advise("saturation", "actuator", "unknown", False, False),
    )
