"""The page of one loop from a diagnosis, without a store."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

from lostmotion.audit.assess.from_diagnosis import row_of, trace_of
from lostmotion.audit.plant_view import LoopView
from lostmotion.diagnose import Diagnosis, PooledDiagnosis
from lostmotion.plant import PlantLoop
from lostmotion.report.plant.pages import loop_report
from lostmotion.report.pooled_text import rests_on
from lostmotion.store.rows import UNDATED


def diagnosis_view(diagnosis: Diagnosis, source: str = "") -> LoopView:
    """Rows of a diagnosis, as an audit would have them; `source` is where its record lies, for the next command."""
    record = diagnosis.record
    loop = PlantLoop(
        tag=record.tag or record.source or "record",
        loop_type=diagnosis.performance.loop_type,
        op_span=record.op_span,
        pv_span=record.pv_span,
        op_unit=record.op_unit,
        pv_unit=record.pv_unit,
        where=source or record.source,
    )
    start, end = _window(diagnosis)
    row = row_of(loop, start, end, diagnosis)
    return LoopView(loop, row, trace_of(loop, start, diagnosis), (row,), notes=_notes(diagnosis))


def diagnosis_report(diagnosis: Diagnosis, source: str = "") -> str:
    """One HTML file about one loop."""
    return loop_report(diagnosis_view(diagnosis, source))


def _window(diagnosis: Diagnosis) -> tuple[datetime, datetime]:
    """From the first to the last row; a clock without time zone is left as it is."""
    record = diagnosis.record
    start = record.start or UNDATED
    end = record.moment(len(record) - 1) or start + timedelta(seconds=(len(record) - 1) * record.dt)
    return (start, end) if start.tzinfo is None else (start.astimezone(UTC), end.astimezone(UTC))


def _notes(diagnosis: Diagnosis) -> tuple[str, ...]:
    if not isinstance(diagnosis, PooledDiagnosis):
        return diagnosis.notes
    shown = f"Trend, plots and indices are those of the one of {len(diagnosis.shares)} records that tells most."
    return (rests_on(diagnosis), shown, *diagnosis.notes)
