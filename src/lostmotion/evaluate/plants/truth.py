"""What is true of a loop of a made plant."""

from __future__ import annotations

from dataclasses import dataclass

VALVES = ("stiction", "backlash", "dead zone")
SENSORS = ("noisy sensor", "frozen sensor", "drifting sensor")
CAUSES = dict.fromkeys(VALVES, "actuator") | {"tight tuning": "tuning"} | dict.fromkeys(SENSORS, "sensor")
FAULTS = tuple(CAUSES)


@dataclass(frozen=True)
class LoopTruth:
    """Truth of one loop.

    Attributes
    ----------
    tag, area, loop_type : str
    fault : str
        Of FAULTS, or "none".
    cause : str
        "actuator", "tuning", "sensor"; "none" without a fault.
    size : float
        Lost motion in % of the span of OP: width, or the band of a stiction. 0 elsewhere.
    jump : float
        Slip jump of a stiction, %; 0 elsewhere.
    swings_with : str
        Tag of the loop, or "outside", whose oscillation reaches it; empty: none that matters.
    period : float
        Seconds of that oscillation; 0: none.
    data : str
        What the historian has done to it: "compressed", "coarse", "stale", "gaps"; empty: nothing.
    manual : float
        Share of the time in manual.
    """

    tag: str
    area: str
    loop_type: str
    fault: str = "none"
    cause: str = "none"
    size: float = 0.0
    jump: float = 0.0
    swings_with: str = ""
    period: float = 0.0
    data: str = ""
    manual: float = 0.0
