"""``diagnose_long``: a long record is diagnosed from its most informative stretches, alone or in an audit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from typing import Any

import numpy as np

from lostmotion.brief import counted
from lostmotion.diagnose.at_limits import judged_by_limits
from lostmotion.diagnose.clean_bill import how_to_tell
from lostmotion.diagnose.control_error.amplitude import error_oscillation
from lostmotion.diagnose.control_error.rows import ScreenRows
from lostmotion.diagnose.diagnosis import Diagnosis
from lostmotion.diagnose.long_record.disagreement import about_looks
from lostmotion.diagnose.long_record.long_diagnosis import LongDiagnosis
from lostmotion.diagnose.long_record.stretches import Look, looks, recording
from lostmotion.diagnose.one_record import diagnose_part
from lostmotion.diagnose.op_span import OpSpan, op_span
from lostmotion.diagnose.verdict import SURE
from lostmotion.errors import DataError
from lostmotion.kernels.threads import one_thread
from lostmotion.records import LoopRecord

MOST = 3  # looks
NAN = float("nan")
REFUSED = "no stretch of the record in which OP and PV move and the controller acts"

Seen = list[tuple[Look, Diagnosis]]


@one_thread
def diagnose_long(record: LoopRecord, say: Callable[[str], None] | None = None, **asked: Any) -> LongDiagnosis:
    """Diagnose the valve of a long record, by its likelihood and shape alone.

    A first look is at the best stretch of each half of the record, joined; a second one, at others, confirms a fault or
    tells what the first could not, and a third where one of them names a fault and the other cannot tell. Sizes of
    looks that name the same fault are added up. How the loop was recorded is told by all of the record.

    Parameters
    ----------
    record : LoopRecord
    say : callable, optional
        Told how far the work is.
    **asked
        As in :func:`lostmotion.diagnose.one_record.diagnose_part`.

    Raises
    ------
    DataError
        No stretch can be used.
    """
    with np.errstate(all="ignore"):
        rows, oscillation = ScreenRows(record), error_oscillation(record)
        seen = _seen(rows, None if oscillation is None else oscillation.period, say, asked)
        return judged_by_limits(_told(record, seen), rows)


def _seen(rows: ScreenRows, period: float | None, say: Callable[[str], None] | None, asked: dict[str, Any]) -> Seen:
    """Looks that were diagnosed."""
    seen: Seen = []
    known, span = recording(rows, period), op_span(rows.record)
    refusal = DataError(REFUSED)
    for number, look in enumerate(looks(rows, period), 1):
        if say is not None:
            say(f"look {number} of at most {MOST}, at {len(look.record)} rows of {len(rows.record)}")
        try:
            seen.append((look, diagnose_part(with_span(look.record, span), known, **asked)))
        except DataError as error:
            refusal = error
            if seen:
                break
            continue
        if not another([found for _, found in seen]):
            break
    if not seen:
        raise refusal
    return seen


def with_span(look: LoopRecord, span: OpSpan) -> LoopRecord:
    """With the span that all of the record tells, where OP of the look alone suggests another."""
    return look if not span.known or op_span(look).ends == span.ends else replace(look, op_span=span.ends)


def alarm(found: Diagnosis) -> bool:
    """A fault of the actuator is named."""
    return found.kind == "actuator"


def another(seen: list[Diagnosis]) -> bool:
    """Whether one more look is worth its time: to confirm a fault, or where nothing is told."""
    silent = [one for one in seen if one.verdict == "cannot tell"]
    if len(seen) == 1:
        return alarm(seen[0]) or bool(silent)
    return len(seen) < MOST and len(silent) == 1 and any(alarm(one) for one in seen)


def believed(seen: list[Diagnosis]) -> Diagnosis:
    """The look that is believed: a fault where two looks name one and none denies it, else the first that names none.

    Where another cannot tell, the fault must be likelier than none by all looks, as it must be in one diagnosis.
    Sizes that it excludes are its own: the smaller of two 95 % limits would be none of 95 %.
    """
    alarms, others = [one for one in seen if alarm(one)], [one for one in seen if not alarm(one)]
    clear = [one for one in others if one.verdict != "cannot tell"]
    if not others or (len(alarms) > 1 and not clear and _probability(seen) > SURE):
        return max(alarms, key=lambda one: one.probabilities["actuator"])
    return (clear or others)[0]


def _probability(seen: list[Diagnosis]) -> float:
    """Probability of a fault of the actuator by all looks."""
    return float(np.mean([one.probabilities["actuator"] for one in seen]))


def _told(record: LoopRecord, seen: Seen) -> LongDiagnosis:
    """What the looks say together."""
    found = tuple(one for _, one in seen)
    best = believed(list(found))
    look = next(look for look, one in seen if one is best)
    first = look.places[0]
    chance = _probability(list(found))
    kept = {field.name: getattr(best, field.name) for field in fields(Diagnosis)}
    kept |= {"probabilities": {"none": 1.0 - chance, "actuator": chance}, "notes": (*best.notes, _note(record, seen))}
    if alarm(best):
        kept |= _pooled(best, found)
    elif any(alarm(one) for one in found):
        kept |= {"verdict": "cannot tell", "kind": "unknown", "severity": "unknown", "why": about_looks(found)}
        kept["advice"] = how_to_tell(max(best.excluded.values(), default=np.inf), best.tolerance)
    return LongDiagnosis(
        **kept,
        looks=found,
        diagnosed_rows=sum(len(one.record) for one, _ in seen),
        of_rows=len(record),
        shown=(first, min(first + look.rows, len(record))),
        origin=record.fingerprint,
    )


def _note(record: LoopRecord, seen: Seen) -> str:
    """Which part of the record was read."""
    rows = sum(len(look.places) * look.rows for look, _ in seen)
    pace = f", at a pace of {seen[0][0].record.dt:g} s" if seen[0][0].record.dt > record.dt else ""
    looked = counted(len(seen), "look")
    return (
        f"Of {len(record)} rows the most informative {rows} were diagnosed in {looked}{pace}. Fit, indices, "
        "performance and figures are of one of them."
    )


def _pooled(best: Diagnosis, found: tuple[Diagnosis, ...]) -> dict[str, Any]:
    """Size with its interval: of the looks that name the same fault, weighted by their precision."""
    same = [one for one in found if one.verdict == best.verdict and np.isfinite(one.size)]
    if len(same) < 2 or not np.isfinite(best.size):
        return {}
    size, low, high = mean_size(same)
    span = op_span(best.record)
    severity = span.severity_of(best.verdict, best.kind, size)
    return {"size": size, "interval": (low, high), "size_percent": size / span.percent, "severity": severity}


def mean_size(found: list[Diagnosis]) -> tuple[float, float, float]:
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
