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
    """The fit with `actuator`, where it is of one record with a position.

    A fault that the position shows and PV does not is the more likely kind. One that PV names stays: it may lie behind
    the position transmitter, in a loose linkage.
    """
    record = _one(records)
    if record is None or record.position is None or not np.isfinite(record.position).any():
        return fit
    response = actuator_response(record)
    fit = replace(fit, actuator=response)
    if not response.status.identified or response.kind == NONE or fit.preferred not in UNNAMED:
        return fit
    evidence = replace(fit.evidence, other_kind=(response.kind, AHEAD))
    return replace(fit, status=Status.OTHER_KIND, evidence=evidence, widest=None)


def shown_by_position(fit: HammersteinFit) -> bool:
    """Whether the position, and not PV, shows the kind that is more likely than the fitted one."""
    return fit.actuator is not None and fit.evidence.other_kind == (fit.actuator.kind, AHEAD)


def _one(records: object) -> LoopRecord | None:
    """The record of `identify`, if it is one."""
    if isinstance(records, list | tuple) and len(records) == 1:
        records = records[0]
    if isinstance(records, Prepared):
        records = records.record
    return records if isinstance(records, LoopRecord) else None
