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
    return "\n".join([head, "=" * WIDTH, fill(f"{actuator_sentence(response)} {response.message}"), *table])


def actuator_sentence(response: ActuatorResponse) -> str:
    """Kind and size: one sentence."""
    low, high = response.interval
    if response.kind == "none":
        return f"NO DEAD BAND larger than {percent(response, high)} of span."
    if not math.isfinite(response.dead_band):
        open_size = f": at most {percent(response, high)} of span" if math.isfinite(high) else ""
        return f"CANNOT TELL{open_size}."
    between = f"({percent(response, low)[:-2]} .. {percent(response, high)[:-2]})"
    return f"{response.kind.upper()}: dead band {percent(response, response.dead_band)} of span {between}."


def actuator_rows(response: ActuatorResponse) -> list[tuple[str, str, str]]:
    """Meaning, value and % of span of each number that is known."""
    unit = bracketed(response.record.op_unit)
    rows = []
    for name, meaning in MEANING.items():
        value = getattr(response, name)
        if math.isfinite(value):
            share = f"{percent(response, value)} of span" if name in _SHARES else ""
            rows.append((meaning, plain(value) + (unit if name in _SHARES else ""), share))
    return rows


def percent(response: ActuatorResponse, size: float) -> str:
    """Size in % of span, two digits."""
    return f"{plain(float(f'{size / response.percent:.2g}'))} %"
