"""Whether PV stood still while OP moved: for one loop as for all of a plant."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lostmotion.diagnose.control_error.rows import ScreenRows
from lostmotion.diagnose.ringing import Found, Source
from lostmotion.records import LoopRecord

LEAST_SHARE = 0.02  # of the time
LEAST_OF_STALE = 0.5  # of the time without live data: else the recording stands still, whatever OP does
FROZEN = Source(
    "It comes from the measurement: PV stood still while OP moved.",
    (
        "Look at the measurement and its recording: transmitter, impulse line, input card, historian. Compare it with "
        "a local gauge.",
        "Record the loop again when PV moves: what was told of the valve rests on a PV that stood still.",
    ),
)


def stood_still(frozen: float, limited: float, stale: float) -> bool:
    """Whether a frozen PV is the finding, from shares of the time; at a limit OP ends whose PV stands still."""
    return frozen >= LEAST_SHARE and frozen + limited >= LEAST_OF_STALE * stale


def frozen_share(rows: ScreenRows) -> float:
    """Share of the time in which PV stood still while OP moved, in automatic."""
    return rows.share(rows.stuck & ~rows.stopped & rows.known & ~rows.manual)


def judged_by_measurement(found: Found, record: LoopRecord) -> Found:
    """The diagnosis, or that a PV which stood still is to be looked at first; a known lost motion stays what it is."""
    if found.kind == "actuator" and np.isfinite(found.size):
        return found
    with np.errstate(all="ignore"):
        rows = ScreenRows(record)
        shares = frozen_share(rows), rows.share(rows.limited & ~rows.manual), rows.share(rows.standing & rows.known)
    if not stood_still(*shares):
        return found
    return replace(found, kind="sensor", source=FROZEN.where, advice=FROZEN.advice)
