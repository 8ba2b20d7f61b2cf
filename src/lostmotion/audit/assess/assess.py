"""``assess``: the diagnosis of a window as a row of the store."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

import numpy as np

from lostmotion.audit.assess.said import said
from lostmotion.audit.assess.trace import trace_of
from lostmotion.audit.screen.of_loop import of_loop
from lostmotion.audit.screen.screen import failed
from lostmotion.audit.settings import AuditSettings
from lostmotion.diagnose.diagnosis import Diagnosis
from lostmotion.diagnose.long_record.any_length import diagnose_valve
from lostmotion.diagnose.long_record.long_diagnosis import LongDiagnosis
from lostmotion.errors import DataError
from lostmotion.kernels.threads import one_thread
from lostmotion.plant.loop import PlantLoop
from lostmotion.records import LoopRecord
from lostmotion.store.rows import AssessmentRow, Stage, TraceRow


@one_thread
def assess(
    loop: PlantLoop, record: LoopRecord, row: AssessmentRow, settings: AuditSettings
) -> tuple[AssessmentRow, TraceRow | None]:
    """Diagnose the valve of a window that was screened, as `diagnose` would.

    Nothing is raised: what goes wrong makes a row of stage "failed" with its error.

    Parameters
    ----------
    loop : PlantLoop
    record : LoopRecord
        Of the window.
    row : AssessmentRow
        As it was screened.
    settings : AuditSettings
    """
    began = time.process_time()
    trace: TraceRow | None = None
    try:
        own = of_loop(loop, record)
        with np.errstate(all="ignore"):
            found = diagnose_valve(own, tolerance=settings.tolerance)
        row, trace = assessed(row, found), _trace(row, own, found)
    except DataError as error:
        row = replace(
            row, stage=Stage.ASSESSED, verdict="cannot tell", kind="unknown", why=" ".join(str(error).split())
        )
    except Exception as error:  # noqa: BLE001  one loop in thousands must not end the run
        row, trace = failed(row, error), None
    return replace(row, seconds=row.seconds + time.process_time() - began), trace


def assessed(row: AssessmentRow, found: Diagnosis) -> AssessmentRow:
    """The row with what the diagnosis says."""
    fields = said(found)
    fields["indices"] = {**row.indices, **fields["indices"], "diagnosed_dt": found.record.dt, **_of_looks(found)}
    return replace(row, stage=Stage.ASSESSED, **fields, **_performance(row, found))


def _of_looks(found: Diagnosis) -> dict[str, float]:
    """Numbers of the looks at a long window."""
    if not isinstance(found, LongDiagnosis):
        return {"diagnosed_rows": float(len(found.record))}
    return {"looks": float(len(found.looks)), "diagnosed_rows": float(found.diagnosed_rows), **shown_once(found)}


def shown_once(found: LongDiagnosis) -> dict[str, float]:
    """Largest size in % of the fault that looks name where the others cannot tell; nothing where one denies it."""
    told = [one for one in found.looks if one.verdict != "cannot tell"]
    sizes = [one.size_percent for one in told if np.isfinite(one.size_percent)]
    untold = found.verdict == "cannot tell" and all(one.kind == "actuator" for one in told)
    return {"shown_percent": max(sizes)} if sizes and untold else {}


def _performance(row: AssessmentRow, found: Diagnosis) -> dict[str, Any]:
    """Harris index and class with the identified delay, where the screen found none."""
    index = found.performance.harris[0]
    if row.harris is not None or not np.isfinite(index) or row.performance == "open loop":
        return {}
    return {"harris": float(index), "performance": found.performance.audit_class}


def _trace(row: AssessmentRow, record: LoopRecord, found: Diagnosis) -> TraceRow:
    """Picture of the window, of the best stretch of a long one."""
    first, last = found.shown if isinstance(found, LongDiagnosis) else (0, len(record))
    return trace_of(row.tag, row.window_start, first * record.dt, record.cut(first, last), found)
