"""What a measured position shows of the actuator, in a sentence."""

from __future__ import annotations

from lostmotion.actuator import ActuatorResponse
from lostmotion.actuator.response import NONE
from lostmotion.identify.seen_position import UNNAMED

BEHIND = " The {} that PV shows lies behind the position transmitter: look for a loose linkage."


def seen_in_position(response: ActuatorResponse, named: str) -> str:
    """What the position shows, and where the fault lies that PV names (`named`)."""
    if not response.status.identified:
        return f"The position does not tell the dead band: {response.message}"
    low, high = (response.percent_text(end) for end in response.interval)
    if response.kind == NONE:
        seen = f"Seen directly in the position: no dead band larger than {high} of span."
        return seen + ("" if named in UNNAMED else BEHIND.format(named))
    size = f"{response.percent_text(response.dead_band)} of span ({low[:-2]} .. {high[:-2]})"
    return f"Seen directly in the position: {response.kind}, dead band {size}."
