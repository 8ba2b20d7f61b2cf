"""The valve of a record of any length: whole up to `LONG` rows, by its most informative stretches beyond."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from lostmotion.diagnose.diagnosis import Diagnosis
from lostmotion.diagnose.long_record.diagnose_long import diagnose_long
from lostmotion.diagnose.one_record import diagnose_part
from lostmotion.diagnose.op_span import TOLERANCE
from lostmotion.records import LoopRecord

LONG = 50_000  # rows: a fit of more takes minutes, and its process is not the same all the time


def diagnose_valve(
    record: LoopRecord,
    say: Callable[[str], None] | None = None,
    *,
    integrating: bool | None = None,
    loop_type: str | None = None,
    tolerance: float = TOLERANCE,
) -> Diagnosis:
    """Diagnose the valve alone: what the amplitude of an oscillation and a PV that stands still say is said apart.

    Parameters, errors: as :func:`lostmotion.diagnose`; `say` is told how far the work on a long record is.
    """
    asked: dict[str, Any] = {"integrating": integrating, "loop_type": loop_type, "tolerance": tolerance}
    return diagnose_long(record, say, **asked) if len(record) > LONG else diagnose_part(record, None, **asked)
