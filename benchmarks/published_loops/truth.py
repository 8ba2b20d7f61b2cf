"""What is true of a simulated loop.

A record cannot tell a fault, by construction, where the stem never turns in it (a dead zone: OP never crosses it), or
where OP moves by no more than the fault over the whole record. Nothing else is an excuse: one turn is enough to be
counted.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from published_loops.closed_loop import Recorded
from published_loops.meters import measured_size
from published_loops.valves import Valve


@dataclass(frozen=True)
class Truth:
    """Kind, sizes in % of OP, and whether the record can tell.

    Attributes
    ----------
    kind : str
        "none", "dead zone", "backlash" or "stiction".
    size : float
        As measured from the motion of the stem; by the parameters where it never turned.
    jump : float
        Slip jump by the parameters.
    turns : int
        Of the stem, or crossings of the dead zone, in the record.
    tells : bool
    reason : str
        Why it does not.
    """

    kind: str
    size: float
    jump: float
    turns: int
    tells: bool
    reason: str


def truth_of(valve: Valve, recorded: Recorded) -> Truth:
    """Of a loop that was run."""
    if valve.size == 0:
        return Truth("none", 0.0, 0.0, 0, tells=True, reason="")
    brackets = recorded.meter.brackets
    size = measured_size(brackets, valve.size)
    reason = ""
    if np.ptp(recorded.op) <= valve.size:
        reason = "OP moves by no more than the fault"
    elif len(brackets) == 0:
        reason = "OP never crosses the zone" if valve.kind == "dead zone" else "the stem never turns"
    return Truth(valve.kind, size, valve.jump, len(brackets), not reason, reason)
