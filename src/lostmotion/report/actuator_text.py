"""What an actuator does, as text: the finding first, then its numbers in units of OP and in % of span."""

from __future__ import annotations

import math

from lostmotion.actuator import ActuatorResponse
from lostmotion.report.digits import bracketed, plain
from lostmotion.report.fit_text import WIDTH, fill

MEANING = {
    "dead_band": "dead band, full width",
    "up": "dead band upwards",
    "down": "dead band downwards",
    "resolution": "resolution: smallest step of the motion",
    "rate_limit": "rate limit, a second",
    "lag": "lag of the positioner, s",
    "offset": "offset: OP minus position",
}
_SHARES = ("dead_band", "up", "down", "resolution", "rate_limit", "offset")  # in % of span too


def actuator_summary(response: ActuatorResponse) -> str:
    """Report of an actuator as plain text."""
    record = response.record
    name = record.tag or record.source or "record"
    head = f"{name}: {len(record)} samples of OP and position every {record.dt:g} s"
    table = [f"  {meaning:<42}{value:>10}  {share}".rstrip() for meaning, value, share in actuator_rows(response)]
    return "\n".join([head, "=" * WIDTH, fill(f"{response.finding} {response.message}"), *table])


def actuator_rows(response: ActuatorResponse) -> list[tuple[str, str, str]]:
    """Meaning, value and % of span of each number that is known."""
    unit = bracketed(response.record.op_unit)
    rows = []
    for name, meaning in MEANING.items():
        value = getattr(response, name)
        if math.isfinite(value):
            share = f"{response.percent_text(value)} of span" if name in _SHARES else ""
            rows.append((meaning, plain(value) + (unit if name in _SHARES else ""), share))
    return rows
