"""Whether a record is too slow for its loop, and how often to record instead."""

from __future__ import annotations

from lostmotion.compensate.gate import PROCESS
from lostmotion.diagnose.diagnosis import Diagnosis

FEWEST_SAMPLES = 10.0  # a period, or a time constant
SHORTEST_LAG = 0.25  # samples: four time constants are over before the next one
SLOWEST_FLOW = 10.0  # s between samples: a flow settles in seconds
FLOW_SAMPLING = 1.0  # s


def sampling_advice(found: Diagnosis) -> str:
    """What to record instead of a record that is too slow for its loop; empty where it is not."""
    dt, linear = found.fit.data.dt, found.fit.linear
    periods = [one.period for one in (found.measured.op, found.measured.pv) if one.regular]
    period = min(periods, default=float("inf"))
    if period < FEWEST_SAMPLES:
        reason = f"it swings with a period of {period:.2g} samples"
        limit = period * dt / FEWEST_SAMPLES
    elif found.record.loop_type == "flow" and dt > SLOWEST_FLOW:
        reason, limit = "a flow settles in seconds", FLOW_SAMPLING
    elif found.fit.status in PROCESS and not linear.integrates() and linear.slowest_lag() < SHORTEST_LAG:
        reason, limit = "the process settles within one sample", dt / FEWEST_SAMPLES
    else:
        return ""
    return (
        f"Record faster: one sample every {dt:.3g} s is too slow for this loop, since {reason}. Record every scan of "
        f"the controller, or one sample every {float(f'{limit:.2g}'):g} s at most, without compression."
    )
