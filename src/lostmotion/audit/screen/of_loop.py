"""A record with what the loop list says of its loop."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lostmotion.diagnose.audit_class import LEAST_INDEX
from lostmotion.plant.loop import PlantLoop
from lostmotion.records import LoopRecord


def of_loop(loop: PlantLoop, record: LoopRecord) -> LoopRecord:
    """The record with what the loop list says of it; without a type that nothing is known of."""
    loop_type = loop.loop_type or record.loop_type
    return replace(
        record,
        tag=loop.tag or record.tag,
        op_span=_proper(loop.op_span) or record.op_span,
        pv_span=_proper(loop.pv_span) or record.pv_span,
        loop_type=loop_type if loop_type in LEAST_INDEX else "",
    )


def _proper(span: tuple[float, float] | None) -> tuple[float, float] | None:
    return span if span is not None and bool(np.isfinite(span).all()) and span[0] < span[1] else None
