"""``diagnose``: one call from a record to what is wrong with the loop."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.advice import advise
from lostmotion.diagnose.audit_class import LEAST_INDEX
from lostmotion.diagnose.clean_bill import CleanBill, clean_bill, how_to_tell, untold
from lostmotion.diagnose.diagnosis import Diagnosis, Item
from lostmotion.diagnose.drawn_rows import hidden_size, unless_drawn
from lostmotion.diagnose.evidence_words import LABEL, NOT_COUNTED, OF_THE_WAVE
from lostmotion.diagnose.excitation import follows_sp, moved_freely, only_fed_back
from lostmotion.diagnose.features import Measured, measure
from lostmotion.diagnose.frozen import judged_by_measurement
from lostmotion.diagnose.loop_stability import LoopStability, loop_stability
from lostmotion.diagnose.op_span import SOUND, TOLERANCE, OpSpan, checked_tolerance, op_span
from lostmotion.diagnose.performance import measure_performance
from lostmotion.diagnose.position import judged_by_position
from lostmotion.diagnose.ringing import judged_by_amplitude
from lostmotion.diagnose.verdict import Verdict, decide
from lostmotion.errors import ParameterError
from lostmotion.identify import HammersteinFit
from lostmotion.identify.actuators.kind import faults
from lostmotion.identify.estimate import identify_for_verdict
from lostmotion.identify.left_open import largest_known
from lostmotion.identify.recording import Recording
from lostmotion.identify.size_interval import slips_at_rest
from lostmotion.identify.unseen_moves import FILLED
from lostmotion.kernels.threads import one_thread
from lostmotion.records import LoopRecord, RecordReport, check, prepare
from lostmotion.records.loop_type import usually_integrates
from lostmotion.records.modes import rows_of

COARSE = 0.35  # step of PV over its deviation, from which on the record is mostly rounding
BETWEEN = "{}, which makes the interval of the size so wide. Record every scan of the controller."
AT_REST = "It slips between the rows of a loop at rest: with more delay it would be smaller, which the interval counts."
LAGS = "The actuator lags by about {:.2g} s before it sticks; the size is that behind this lag."


def diagnose(
    record: LoopRecord,
    *,
    integrating: bool | None = None,
    loop_type: str | None = None,
    tolerance: float = TOLERANCE,
) -> Diagnosis:
    """Say what is wrong with a loop, from its routine record.

    Main evidence is how well each kind of actuator predicts what it was not fitted to; the field's indices of shape
    are weighed in by log-odds that were calibrated on simulated and labelled real loops (docs/diagnosis.md).

    Parameters
    ----------
    record : LoopRecord
        OP and PV, with SP where known. It is prepared first (:func:`lostmotion.records.prepare`).
    integrating : bool, optional
        Whether the process integrates (a level); `identify` looks at no other. None: as identified, but for a flow,
        which does not.
    loop_type : {"flow", "pressure", "temperature", "level", "analyser", "concentration", "other"}, optional
        What PV measures: the classes of performance depend on it. None: as the tag of the record says.
    tolerance : float
        Lost motion that does not matter, as a share of the span of OP. The actuator is cleared only where the record
        excludes larger ones.

    Returns
    -------
    Diagnosis

    Raises
    ------
    DataError
        The record is refused, with the reason.
    ParameterError
        Unknown loop type, a tolerance outside (0, 1).

    Examples
    --------
    >>> from lostmotion.evaluate import random_faulty_loop
    >>> from lostmotion.records import LoopRecord
    >>> loop = random_faulty_loop(4, cause="stiction", process="flow")
    >>> found = diagnose(LoopRecord(loop.op, loop.pv, loop.sp, dt=1.0))
    >>> found.verdict
    'stiction'
    """
    found = diagnose_part(record, None, integrating=integrating, loop_type=loop_type, tolerance=tolerance)
    return judged_by_position(judged_by_measurement(judged_by_amplitude(found, record), record), record)


@one_thread
def diagnose_part(
    record: LoopRecord,
    recording: Recording | None,
    *,
    integrating: bool | None = None,
    loop_type: str | None = None,
    tolerance: float = TOLERANCE,
) -> Diagnosis:
    """The same of a part of a longer record, which tells how the loop was recorded; None: the part tells it.

    By its likelihood and shape alone: what the amplitude of the oscillation says is said by the whole record.
    """
    kinds = sorted(LEAST_INDEX)
    if loop_type is None and record.loop_type in kinds:
        loop_type = record.loop_type
    if loop_type is not None and loop_type not in kinds:
        raise ParameterError.expected(f"loop_type as one of {kinds}", repr(loop_type), "or leave it out")
    record = replace(record, loop_type=loop_type or "")  # as said, whatever its tag looks like
    span = op_span(record)
    sound = SOUND * 100.0 * checked_tolerance(tolerance) * span.percent
    fit = identify_for_verdict(prepare(record), integrating, sound, recording)
    if integrating is None:
        integrating = usually_integrates(record.loop_type)
    sp = fit.data.sp
    measured = measure(fit, integrating, sp, sound)
    stability = loop_stability(fit, sp, measured.period) if fit.evidence.closed_loop else None
    quantised = bool(fit.data.y_step > COARSE * max(float(np.std(fit.data.y)), 1e-300))
    free = moved_freely(fit.data, fit.evidence.free_moves)
    fed_back = only_fed_back(fit.evidence.closed_loop, free, sp) and not follows_sp(fit, sp)
    bill = clean_bill(fit, tolerance, span, fed_back)
    report = check(record)
    verdict = decide(fit, measured, stability, quantised, _limited(report), fed_back)
    verdict = unless_drawn(bill.weigh(verdict, measured, float(np.std(fit.data.u))), fit)
    return _package(record, fit, sp, measured, stability, verdict, bill, _notes(fit, report), loop_type)


def _package(
    record: LoopRecord,
    fit: HammersteinFit,
    sp: FloatArray | None,
    measured: Measured,
    stability: LoopStability | None,
    verdict: Verdict,
    bill: CleanBill,
    notes: tuple[str, ...],
    loop_type: str | None,
) -> Diagnosis:
    span = bill.span
    size, interval, about_size = _size(verdict.verdict, fit, measured)
    percent = size / span.percent
    severity = span.severity_of(verdict.verdict, verdict.kind, size)
    pv_stronger = measured.pv.share >= measured.op.share
    performance = measure_performance(
        fit.data, sp, fit.chosen.delay, span.ends, measured.pv if pv_stronger else measured.op,
        _manual(record), loop_type or ("level" if measured.integrating else "other"),
    )  # fmt: skip
    return Diagnosis(
        verdict=verdict.verdict,
        kind=verdict.kind,
        severity=severity,
        size=size,
        interval=interval,
        size_percent=percent,
        confidence=verdict.confidence,
        probabilities=verdict.probabilities,
        evidence=_items(verdict, measured.commanded),
        advice=(*_missing_span(verdict, span, size), *_advice(verdict, severity, measured, bill, sp)),
        notes=(*notes, *([span.note] if span.note else []), *about_size, *_negligible(fit, measured, span)),
        measured=measured,
        stability=stability,
        performance=performance,
        fit=fit,
        record=record,
        excluded={} if verdict.kind == "actuator" else bill.excluded,
        tolerance=bill.tolerance,
        why=verdict.why,
    )


def _missing_span(verdict: Verdict, span: OpSpan, size: float) -> tuple[str, ...]:
    """Sentence that asks for the span of OP where the severity of a fault depends on it."""
    request = span.request(size) if verdict.kind == "actuator" else ""
    return (request,) if request else ()


def _advice(
    verdict: Verdict, severity: str, measured: Measured, bill: CleanBill, sp: FloatArray | None
) -> tuple[str, ...]:
    if verdict.advice:
        return verdict.advice
    if verdict.why:
        return how_to_tell(bill.largest[1], verdict.limit, untold(sp))
    return advise(verdict.verdict, verdict.kind, severity, measured.integrating, measured.swings)


def _limited(report: RecordReport) -> float:
    """Share of the rows in which OP stands at the lower or upper end of its range or span."""
    loop = report.loop
    return 0.0 if loop is None else loop.saturated_low + loop.saturated_high


def _notes(fit: HammersteinFit, report: RecordReport) -> tuple[str, ...]:
    """What was assumed or left out, and what ``check`` warns of."""
    warned = (f"{found.what} {found.why}".strip() for found in report.findings if found.level == "warning")
    return (*fit.data.notes, *warned)


def _size(verdict: str, fit: HammersteinFit, measured: Measured) -> tuple[float, tuple[float, float], tuple[str, ...]]:
    """Lost motion in units of OP: of the fit where it has the kind, else apparent, from the ellipse."""
    unknown = (np.nan, (np.nan, np.nan), ())
    said = next((kind for kind in faults() if kind.name == verdict), None)
    if said is None or said.size is None:
        return unknown
    name = fit.kind.size
    if name is not None and (fit.kind is said or (fit.kind.sticks and said.sticks)):
        hidden = hidden_size(fit)
        if hidden:
            return *unknown[:2], (f"How large it is the record does not tell: {hidden}.",)
        moves = fit.evidence.unseen_moves
        wide = moves > (0.0 if fit.kind.sticks else FILLED * fit.parameters[name])
        about = [BETWEEN.format(fit.data.unseen.words(moves))] if wide else []
        about += [AT_REST] if slips_at_rest(fit.nonlinearity, fit.evidence) else []
        about += [LAGS.format(fit.evidence.actuator_lag)] if fit.evidence.actuator_lag > 0.0 else []
        return fit.parameters[name], fit.size_interval, tuple(about)
    width = measured.indices.get("ellipse_width", np.nan)
    note = f"How large it is the likelihood does not tell; the ellipse of PV over OP is {width:.2g} of OP wide, a hint."
    return *unknown[:2], (note,) if np.isfinite(width) else ()


def _negligible(fit: HammersteinFit, measured: Measured, span: OpSpan) -> tuple[str, ...]:
    if not measured.negligible or fit.kind.size is None:
        return ()
    largest = largest_known(fit) / span.percent
    return (f"A {fit.kind.name} of at most {largest:.2g} % {span.words} fits best: a sound valve has as much.",)


def _items(verdict: Verdict, commanded: bool) -> tuple[Item, ...]:
    means = {name: NOT_COUNTED if commanded and name in OF_THE_WAVE else LABEL[name][1] for name in LABEL}
    items = [Item(name, value, weight, means[name]) for name, (value, weight) in verdict.contributions.items()]
    return tuple(sorted(items, key=lambda item: -abs(item.weight)))


def _manual(record: LoopRecord) -> float:
    """Share of the rows whose mode says that the controller did not act."""
    rows = rows_of("automatic", record.mode)
    return 0.0 if rows is None else float(1.0 - np.mean(rows))
