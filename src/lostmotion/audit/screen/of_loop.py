"""A record with what the loop list says of its loop."""

from __future__ import annotations

from dataclasses import replace

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.audit_class import LEAST_INDEX
from lostmotion.errors import ParameterError
from lostmotion.plant.loop import PlantLoop
from lostmotion.records import LoopRecord
from lostmotion.records.record import refuse_span


def of_loop(loop: PlantLoop, record: LoopRecord) -> LoopRecord:
    """The record with what the loop list says of it; without a type that nothing is known of."""
    loop_type = loop.loop_type or record.loop_type
    return replace(
        record,
        tag=loop.tag or record.tag,
        op_span=_proper("op_span", loop.op_span, record.op) or record.op_span,
        pv_span=_proper("pv_span", loop.pv_span, record.pv) or record.pv_span,
        loop_type=loop_type if loop_type in LEAST_INDEX else "",
    )


def _proper(name: str, span: tuple[float, float] | None, values: FloatArray) -> tuple[float, float] | None:
    """The span, where it is one."""
    if span is None:
        return None
    try:
        refuse_span(name, span, values)
    except ParameterError:
        return None
    return span
