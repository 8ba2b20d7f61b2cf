"""What the measured position adds to an identification: the actuator is seen, where PV shows it through the process."""

from __future__ import annotations

from dataclasses import replace
from math import log

import numpy as np

from lostmotion.actuator import actuator_response
from lostmotion.actuator.response import CANNOT_TELL, NONE, SEEN_CONFIDENCE
from lostmotion.errors import Status
from lostmotion.identify.fit import HammersteinFit
from lostmotion.records import LoopRecord, Prepared

AHEAD = log(SEEN_CONFIDENCE / (1.0 - SEEN_CONFIDENCE))
UNNAMED = (NONE, CANNOT_TELL)  # what PV says where it names no fault


def beside_position(fit: HammersteinFit, records: object) -> HammersteinFit:
    """The fit with `actuator`, where one of the records has a position; of several it is that with most of it.

    A fault that the position shows and PV does not is the more likely kind. One that PV names stays: it may lie behind
    the position transmitter, in a loose linkage.
    """
    several = records if isinstance(records, list | tuple) else [records]
    seen = {_samples(record): record for record in map(_record, several) if record is not None}
    if not max(seen, default=0):
        return fit
    record = seen[max(seen)]
    response = actuator_response(record)
    fit = replace(fit, actuator=response)
    if not response.status.identified or response.kind == NONE or fit.preferred not in UNNAMED:
        return fit
    evidence = replace(fit.evidence, other_kind=(response.kind, AHEAD))
    return replace(fit, status=Status.OTHER_KIND, evidence=evidence, widest=None)


def shown_by_position(fit: HammersteinFit) -> bool:
    """Whether the position, and not PV, shows the kind that is more likely than the fitted one."""
    return fit.actuator is not None and fit.evidence.other_kind == (fit.actuator.kind, AHEAD)


def _record(one: object) -> LoopRecord | None:
    """A record of `identify`, if it is one."""
    found = one.record if isinstance(one, Prepared) else one
    return found if isinstance(found, LoopRecord) else None


def _samples(record: LoopRecord) -> int:
    """Of the position."""
    return 0 if record.position is None else int(np.isfinite(record.position).sum())
