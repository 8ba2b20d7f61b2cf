"""A limit of an actuator lies where it lies in every record: kinds without a size are compared at common places."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from lostmotion.diagnose.pooled.evidence import WILD
from lostmotion.diagnose.pooled.record_profile import RecordProfile
from lostmotion.identify.actuators.kind import faults

MOST = 4  # places that are tried: of the records that gain most


def at_common_places(profiles: Sequence[RecordProfile]) -> list[RecordProfile]:
    """The records with the gains that kinds without a size have at one place of the valve, the best for all.

    Each at its own place, every record in which OP goes to one side only would count for a limit, and none against it.
    """
    found = list(profiles)
    for name in (kind.name for kind in faults() if kind.size is None):
        places = [(one.gains[name], place) for one in profiles if (place := one.place(name)) is not None]
        places.sort(key=lambda item: -item[0])
        trials = [[one.placed(name, place) for one in found] for _, place in places[:MOST]]
        nowhere = [replace(one, gains={**one.gains, name: 0.0}) for one in found]
        found = max([nowhere, *trials], key=lambda trial: _sum([one.gains[name] for one in trial]))
    return found


def _sum(gains: Sequence[float]) -> float:
    """Of all records, of which each may be wild."""
    return float(np.clip(gains, np.log(WILD), -np.log(WILD)).sum())
