"""One diagnosis from many records of one loop."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from lostmotion.diagnose.advice import advise
from lostmotion.diagnose.clean_bill import how_to_tell
from lostmotion.diagnose.diagnosis import Diagnosis, Item
from lostmotion.diagnose.objections import sticks
from lostmotion.diagnose.op_span import OpSpan, op_span, span_of_values
from lostmotion.diagnose.pooled.common_place import at_common_places
from lostmotion.diagnose.pooled.evidence import STEP, Evidence, evidence_of
from lostmotion.diagnose.pooled.overlap import without_repeats
from lostmotion.diagnose.pooled.pooled_diagnosis import PooledDiagnosis, RecordShare
from lostmotion.diagnose.pooled.record_profile import RecordProfile, profile_record
from lostmotion.diagnose.pooled.settings import DiagnosisSettings
from lostmotion.diagnose.pooled.trend_of_size import size_trend
from lostmotion.diagnose.pooled.verdict_of_many import PooledVerdict, weigh
from lostmotion.errors import DataError, ParameterError
from lostmotion.records import LoopRecord, Prepared, prepare
from lostmotion.records.record import fingerprint_of

SMALLEST, LARGEST = 0.01, 1.1  # of the largest range of OP: between them the common size is sought
RATIO = 1.3  # of the sizes at which every record is profiled
FINER = (0.6, 0.75, 0.87, 0.94, 1.0, 1.06, 1.14, 1.3, 1.6)  # of the common size of a kind: where it is profiled again
CLOSE = 12.0  # of log-likelihood behind the likeliest kind: not looked at once more
SHOWN = 0.5 * 1.96**2  # of log-likelihood: sizes behind by less are in the interval of a record
WIDEST = 4.0  # ends of an interval of a record further apart than this ratio show no size
DAY = 86400.0  # s

Say = Callable[[str], None]


@dataclass(frozen=True)
class _Heard:
    """A record that can be used, with what it says."""

    number: int
    record: LoopRecord
    profile: RecordProfile
    alone: Diagnosis


def diagnose_together(
    records: Sequence[LoopRecord],
    asked: DiagnosisSettings,
    starts: Sequence[float] | None = None,
    say: Say | None = None,
) -> PooledDiagnosis:
    """Diagnose one valve from many records; see :func:`lostmotion.diagnose`.

    Parameters
    ----------
    records : sequence of LoopRecord
    asked : DiagnosisSettings
    starts : sequence of float, optional
        Start of each record in seconds; None: only their order is known.
    say : callable, optional
        Told how far the work is.

    Raises
    ------
    ParameterError
        Not one time for each record, a tolerance outside (0, 1), or OP in different units.
    DataError
        No record can be used.
    """
    if not 0.0 < asked.tolerance < 1.0:
        raise ParameterError.expected("a tolerance between 0 and 1, a share of the span", asked.tolerance, "e.g. 0.01")
    if starts is not None and len(starts) != len(records):
        raise ParameterError.expected(f"{len(records)} start times", len(starts), "give one for each record")
    asked, span = asked.of(records), _same_span(records)
    limit = 100.0 * asked.tolerance * span.strictest_percent
    shares, heard, reach = _hear(records, asked, starts, say)
    origin = fingerprint_of([record.fingerprint for record in records])
    if len(heard) == 1:
        return replace(_of_one(heard[0], shares), origin=origin)
    heard, evidence = _finer(heard, SMALLEST * reach, LARGEST * reach)
    verdict = weigh(evidence, limit, span, _swing(heard))
    shares = _with_gains(shares, heard, evidence, verdict.likeliest)
    gains = evidence.gains(verdict.likeliest)
    told = heard[int(np.argmax(gains))]
    base = told.alone
    found = _packed(base, tuple(shares), heard, evidence, verdict, span, limit, starts is not None)
    return replace(found, origin=origin)


def _hear(
    records: Sequence[LoopRecord],
    asked: DiagnosisSettings,
    starts: Sequence[float] | None,
    say: Say | None,
) -> tuple[list[RecordShare], list[_Heard], float]:
    """Profile of every record that can be used, and the largest range of OP."""
    shares, usable = _usable(records, starts)
    reach = max(float(np.ptp(np.concatenate([piece.op for piece in one.stretches]))) for one in usable.values())
    steps = int(np.ceil(-np.log(SMALLEST) / np.log(RATIO)))
    sizes = np.geomspace(SMALLEST * reach, reach, steps + 1)
    heard = []
    for number, prepared in usable.items():
        if say is not None:
            say(f"{number + 1} of {len(records)}: {shares[number].name}")
        try:
            profile = profile_record(prepared, sizes, asked.integrates)
            alone = asked.diagnosis(prepared.record)
        except DataError as error:  # OP or PV does not move
            shares[number] = replace(shares[number], note=str(error))
            continue
        heard.append(_Heard(number, prepared.record, profile, alone))
    if not heard:
        raise _none_of(shares)
    placed = at_common_places([one.profile for one in heard])
    return shares, [replace(one, profile=profile) for one, profile in zip(heard, placed, strict=True)], reach


def _usable(
    records: Sequence[LoopRecord], starts: Sequence[float] | None
) -> tuple[list[RecordShare], dict[int, Prepared]]:
    """All records by name and place, and what of those that can be used is not in an earlier one as well."""
    unique, lost = without_repeats(records)
    shares, usable = [], {}
    for number, (record, rest, gone) in enumerate(zip(records, unique, lost, strict=True)):
        place = float(number + 1) if starts is None else starts[number] / DAY
        note = f"{gone} rows are in an earlier record as well" if gone else ""
        prepared = None if rest is None else prepare(rest)
        if prepared is not None and prepared.usable:
            usable[number] = prepared
        elif prepared is not None:
            note = str(prepared.refusal)
        shares.append(RecordShare(record.tag or f"record {number + 1}", place, 0, note=note))
    if not usable:
        raise _none_of(shares)
    return shares, usable


def _none_of(shares: list[RecordShare]) -> DataError:
    return DataError.expected("a record that can be used", f"none of {len(shares)}", shares[0].note)


def _finer(heard: list[_Heard], low: float, high: float) -> tuple[list[_Heard], Evidence]:
    """The evidence, profiled once more about the common sizes of the likely kinds: held sizes are far apart."""
    evidence = evidence_of([one.profile for one in heard], low, high)
    totals = evidence.totals()
    for name in evidence.sized:
        if totals[name] > max(totals.values()) - CLOSE and totals[name] > 0.0:
            sizes = evidence.sized[name].size() * np.array(FINER)
            loudest = heard[int(np.argmax(evidence.gains(name)))]
            like = loudest.profile.structure(name)
            heard = [
                replace(
                    one, profile=one.profile.finer(name, sizes, like if one.record.dt == loudest.record.dt else None)
                )
                for one in heard
            ]
    return heard, evidence_of([one.profile for one in heard], low, high)


def _same_span(records: Sequence[LoopRecord]) -> OpSpan:
    """Span of OP, the same in all records.

    Raises
    ------
    ParameterError
        They differ, or there are no records.
    """
    if not records:
        raise ParameterError.expected("records", "none", "give at least one")
    spans = [op_span(record) for record in records]
    if not any(span.known for span in spans):  # what one leaves open another may tell
        low, high = (float(found([found(record.op) for record in records])) for found in (np.nanmin, np.nanmax))
        return span_of_values(records[0].op_unit, low, high)
    known = {span.ends for span in spans if span.known}
    if len(known) > 1:
        told = " and ".join(f"{low:g} .. {high:g}" for low, high in sorted(known)[:2])
        raise ParameterError.expected(
            "records with OP in the same units", told, "give op_span=(low, high), or convert them"
        )
    return next(span for span in spans if span.known)


def _swing(heard: list[_Heard]) -> str:
    """Where the swing of most records comes from; "" where most do not swing."""
    alone = [one.alone for one in heard]
    swinging = [one for one in alone if one.measured.swings]
    if 2 * len(swinging) <= len(alone):
        return ""
    kinds = Counter(one.kind for one in swinging if one.verdict == "other oscillation")
    return kinds.most_common(1)[0][0] if kinds else "unknown"


def _with_gains(shares: list[RecordShare], heard: list[_Heard], evidence: Evidence, kind: str) -> list[RecordShare]:
    """With what each record adds for a kind, and the size that it shows by itself."""
    found = list(shares)
    for one, gain in zip(heard, evidence.gains(kind).tolist(), strict=True):
        size, interval = _own_size(one.profile, evidence, kind)
        alone = one.alone.verdict
        found[one.number] = replace(
            found[one.number], rows=one.profile.rows, alone=alone, gain=gain, size=size, interval=interval
        )
    return found


def _own_size(profile: RecordProfile, evidence: Evidence, kind: str) -> tuple[float, tuple[float, float]]:
    """Most likely size of a record, and those that are not much less likely; NaN where it shows none."""
    nothing = float("nan"), (float("nan"), float("nan"))
    if kind not in evidence.sized:
        return nothing
    sizes = evidence.sized[kind].sizes
    values = profile.curves[kind].on(sizes, STEP)
    best = int(np.argmax(values))
    near = np.flatnonzero(values > values[best] - SHOWN)
    low, high = float(sizes[near[0]]), float(sizes[near[-1]])
    if values[best] < profile.curves[kind].cost or high > WIDEST * low or near[-1] == len(sizes) - 1:
        return nothing
    return float(sizes[best]), (low, high)


def _of_one(one: _Heard, shares: list[RecordShare]) -> PooledDiagnosis:
    """The diagnosis of the only record that can be used: its own, with why the others were left out."""
    base = one.alone
    gain = 0.0 if base.fit.kinds is None else base.fit.kinds.likelihoods.get(base.verdict, 0.0)
    mine = replace(
        shares[one.number],
        rows=one.profile.rows,
        alone=base.verdict,
        gain=gain,
        size=base.size,
        interval=base.interval,
    )
    told = tuple(mine if number == one.number else share for number, share in enumerate(shares))
    kept = {field.name: getattr(base, field.name) for field in fields(Diagnosis)}
    kept["notes"] = (*base.notes, *_left_out(told))
    return PooledDiagnosis(**kept, shares=told, diagnoses=(base,))


def _left_out(shares: tuple[RecordShare, ...]) -> tuple[str, ...]:
    return tuple(f"{share.name}: {share.note}." for share in shares if share.note)


def _packed(
    base: Diagnosis,
    shares: tuple[RecordShare, ...],
    heard: list[_Heard],
    evidence: Evidence,
    verdict: PooledVerdict,
    span: OpSpan,
    limit: float,
    timed: bool,
) -> PooledDiagnosis:
    """The diagnosis of the record that tells most, with what all say in the place of its own."""
    hidden = evidence.hidden if sticks(verdict.verdict) else ""
    one = None if hidden else evidence.sized.get(verdict.verdict)
    size = float("nan") if one is None else one.size()
    actuator = verdict.kind == "actuator"
    severity = span.severity_of(verdict.verdict, verdict.kind, size)
    request = span.request(size) if actuator else ""
    sized = [share for share in shares if not hidden and share.said == "for" and np.isfinite(share.size)]
    trend = size_trend(
        [share.place for share in sized], [share.size for share in sized], [share.interval for share in sized],
        "day" if timed else "record",
    )  # fmt: skip
    wanting = span.known and not op_span(base.record).known
    mine: dict[str, Any] = {
        "verdict": verdict.verdict,
        "kind": verdict.kind,
        "severity": severity,
        "size": size,
        "interval": (float("nan"), float("nan")) if one is None else one.interval(),
        "size_percent": size / span.percent,
        "confidence": verdict.confidence,
        "probabilities": verdict.probabilities,
        "evidence": _items(shares),
        "advice": (*([request] if request else ()), *_advice(base, verdict, severity, limit)),
        "notes": _notes(base, shares, hidden),
        "excluded": verdict.excluded,
        "tolerance": limit,
        "why": verdict.why,
        "record": replace(base.record, op_span=span.ends) if wanting else base.record,
    }
    kept = {field.name: getattr(base, field.name) for field in fields(Diagnosis) if field.name not in mine}
    return PooledDiagnosis(
        **kept,
        **mine,
        shares=shares,
        totals=evidence.totals(),
        kind_confidence=verdict.kind_confidence if actuator else float("nan"),
        scatter=float("nan") if one is None else one.scatter,
        trend=trend,
        carried_by="" if verdict.carried_by is None else shares[heard[verdict.carried_by].number].name,
        diagnoses=tuple(one.alone for one in heard),
    )


def _items(shares: tuple[RecordShare, ...]) -> tuple[Item, ...]:
    """One for each record that was heard."""
    items = [Item(share.name, share.size, share.gain, "log-likelihood over a linear process") for share in shares]
    return tuple(sorted(items, key=lambda item: -abs(item.weight)))


def _advice(base: Diagnosis, verdict: PooledVerdict, severity: str, limit: float) -> tuple[str, ...]:
    if verdict.verdict == "cannot tell" and verdict.excluded:
        return how_to_tell(max(verdict.excluded.values()), limit)
    return advise(verdict.verdict, verdict.kind, severity, base.measured.integrating, base.measured.swings)


def _notes(base: Diagnosis, shares: tuple[RecordShare, ...], hidden: str) -> tuple[str, ...]:
    """What was left out, whose fit and indices are shown, and why no size is."""
    about = f"Fit, indices and performance are of {base.record.tag or 'the record'}, which tells most."
    size = (f"How large it is the records do not tell: {hidden}.",) if hidden else ()
    return (about, *_left_out(shares), *size)
