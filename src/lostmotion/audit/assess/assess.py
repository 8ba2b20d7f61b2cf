"""``assess``: the diagnosis of a window from its most telling stretches, as a row of the store."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from lostmotion.audit.assess.said import finite, said
from lostmotion.audit.assess.stretches import Look, looks, recording
from lostmotion.audit.assess.trace import trace_of
from lostmotion.audit.assess.words import about_looks
from lostmotion.audit.screen.of_loop import of_loop
from lostmotion.audit.screen.screen import failed
from lostmotion.audit.settings import AuditSettings
from lostmotion.diagnose.advice import advise
from lostmotion.diagnose.control_error.rows import ScreenRows
from lostmotion.diagnose.diagnosis import Diagnosis
from lostmotion.diagnose.one_record import diagnose_part
from lostmotion.diagnose.op_span import op_span
from lostmotion.diagnose.verdict import SURE, limits_decide
from lostmotion.errors import DataError
from lostmotion.kernels.threads import one_thread
from lostmotion.plant.loop import PlantLoop
from lostmotion.records import LoopRecord
from lostmotion.store.rows import AssessmentRow, Stage, TraceRow

WORTH_MORE = 0.5  # value from which on an undecided window is looked at once more
HINT = 0.35  # probability of a fault from which on it is too
MOST = 3  # looks
NO_SIZE: dict[str, Any] = dict.fromkeys(("size", "low", "high", "size_percent"))


@dataclass(frozen=True, eq=False)
class Seen:
    """One look, and what was said of it."""

    look: Look
    found: Diagnosis

    @property
    def alarm(self) -> bool:
        """A fault of the actuator is named."""
        return self.found.kind == "actuator"

    @property
    def probability(self) -> float:
        """Of a fault of the actuator."""
        return self.found.probabilities["actuator"]


@one_thread
def assess(
    loop: PlantLoop, record: LoopRecord, row: AssessmentRow, settings: AuditSettings
) -> tuple[AssessmentRow, TraceRow | None]:
    """Diagnose a window that was screened.

    A window that is not long is diagnosed as `diagnose` would. Of a long one
    a first look is at the best stretch of each half of the window, joined; a second one, at others, confirms a fault
    or settles what is worth it, and a third where one of them names a fault and the other cannot tell.
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
        rows = ScreenRows(of_loop(loop, record))
        with np.errstate(all="ignore"):
            seen, why = _seen(rows, row, settings.tolerance)
            row = assessed(row, seen, why)
            if not seen or not seen[0].look.whole:
                row = _limited(row)
            if seen:
                trace = _trace(rows, row, seen)
    except Exception as error:  # noqa: BLE001  one loop in thousands must not end the run
        row, trace = failed(row, error), None
    return replace(row, seconds=row.seconds + time.process_time() - began), trace


def _seen(rows: ScreenRows, row: AssessmentRow, tolerance: float) -> tuple[list[Seen], str]:
    """Looks that were diagnosed, and why the last one was not."""
    seen: list[Seen] = []
    known = recording(rows, row.period)
    refused = "no stretch of the window in which OP and PV move and the controller acts"
    for look in looks(rows, row.period):
        try:
            seen.append(Seen(look, diagnose_part(look.record, known, tolerance=tolerance)))
        except DataError as error:
            refused = str(error)
            if seen:
                break
            continue
        if not _another(seen, row.value):
            break
    return seen, refused


def _another(seen: list[Seen], value: float) -> bool:
    """Whether one more look is worth its time: to confirm a fault, or where nothing is told and it matters."""
    silent = [one for one in seen if one.found.verdict == "cannot tell"]
    if len(seen) == 1:
        return seen[0].alarm or (bool(silent) and (value >= WORTH_MORE or seen[0].probability >= HINT))
    return len(seen) < MOST and len(silent) == 1 and any(one.alarm for one in seen)


def told(seen: list[Seen]) -> Seen:
    """The look that is believed: a fault where two looks name one and none denies it, else the first that names none.

    Where another cannot tell, the fault must be likelier than none by all looks, as it must be in one diagnosis.
    Sizes that it excludes are its own: the smaller of two 95 % limits would be none of 95 %.
    """
    alarms, others = [one for one in seen if one.alarm], [one for one in seen if not one.alarm]
    clear = [one for one in others if one.found.verdict != "cannot tell"]
    if not others or (len(alarms) > 1 and not clear and probability_by_all(seen) > SURE):
        return max(alarms, key=lambda one: one.probability)
    return (clear or others)[0]


def probability_by_all(seen: list[Seen]) -> float:
    """Probability of a fault of the actuator by all looks."""
    return float(np.mean([one.probability for one in seen]))


def assessed(row: AssessmentRow, seen: list[Seen], why: str) -> AssessmentRow:
    """The row with what the looks say."""
    if not seen:
        return replace(row, stage=Stage.ASSESSED, verdict="cannot tell", kind="unknown", why=why)
    best = told(seen)
    fields = said(best.found)
    fields |= _pooled_size(seen, best) if best.alarm else NO_SIZE
    fields |= {
        "probability": finite(probability_by_all(seen)),
        "indices": {**row.indices, **fields["indices"], **_of_looks(seen, best)},
        **_performance(row, best.found),
    }
    if any(one.alarm for one in seen) and not best.alarm:
        fields |= {"verdict": "cannot tell", "kind": "unknown", "severity": "unknown", "why": about_looks(seen)}
        fields["indices"] = fields["indices"] | _shown_once(seen)
    return replace(row, stage=Stage.ASSESSED, **fields)


def _shown_once(seen: list[Seen]) -> dict[str, float]:
    """Largest size in % of the fault that looks name where the others cannot tell; nothing where one denies it."""
    if any(not one.alarm and one.found.verdict != "cannot tell" for one in seen):
        return {}
    sizes = [one.found.size_percent for one in seen if one.alarm and np.isfinite(one.found.size_percent)]
    return {"shown_percent": max(sizes)} if sizes else {}


def _limited(row: AssessmentRow) -> AssessmentRow:
    """As a diagnosis has it where OP is at a limit for long: the looks were at the rest of the window."""
    if row.limited is None or not limits_decide(row.verdict, row.limited):
        return row
    evidence = (("share of time with OP at a limit", row.limited, 0.0), *row.evidence)
    advice = advise("saturation", "actuator", "unknown", False, False)
    return replace(
        row,
        verdict="saturation",
        kind="actuator",
        severity="unknown",
        why="",
        evidence=evidence,
        advice=advice,
        **NO_SIZE,
    )


def _pooled_size(seen: list[Seen], best: Seen) -> dict[str, float | None]:
    """Size with its interval: of the looks that name the same fault, weighted by their precision."""
    found = best.found
    same = [one.found for one in seen if one.found.verdict == found.verdict and np.isfinite(one.found.size)]
    if len(same) < 2 or not np.isfinite(found.size):
        return {}
    size, low, high = _pooled(same)
    percent = size / op_span(found.record).percent
    return {"size": finite(size), "low": finite(low), "high": finite(high), "size_percent": finite(percent)}


def _pooled(found: list[Diagnosis]) -> tuple[float, float, float]:
    """Mean of sizes by precision; the interval is not narrower than what they differ by."""
    sizes = np.array([one.size for one in found])
    ends = np.array([one.interval for one in found])
    if not np.isfinite(ends).all() or not (ends[:, 1] > ends[:, 0]).all():
        one = found[int(np.argmax([item.confidence for item in found]))]
        return one.size, *one.interval
    weights = (ends[:, 1] - ends[:, 0]) ** -2.0
    size = float(weights @ sizes / weights.sum())
    half = max(0.5 / float(np.sqrt(weights.sum())), 0.5 * float(np.ptp(sizes)))
    return size, size - half, size + half


def _of_looks(seen: list[Seen], best: Seen) -> dict[str, float]:
    """Numbers of the looks, and of the one that is believed."""
    rows = sum(len(one.look.record) for one in seen)
    return {"looks": float(len(seen)), "diagnosed_rows": float(rows), "diagnosed_dt": best.look.record.dt}


def _performance(row: AssessmentRow, found: Diagnosis) -> dict[str, Any]:
    """Harris index and class with the identified delay, where the screen found none."""
    index = found.performance.harris[0]
    if row.harris is not None or not np.isfinite(index) or row.performance == "open loop":
        return {}
    return {"harris": float(index), "performance": found.performance.audit_class}


def _trace(rows: ScreenRows, row: AssessmentRow, seen: list[Seen]) -> TraceRow:
    """Picture of the best stretch of the look that is believed."""
    best, record = told(seen), rows.record
    place = best.look.places[0]
    part = record.cut(place, min(place + best.look.rows, len(record)))
    return trace_of(row.tag, row.window_start, place * record.dt, part, best.found)
