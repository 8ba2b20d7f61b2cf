"""A diagnosis as text: verdict first, then why, how the loop works, and what to do."""

from __future__ import annotations

import math

from lostmotion.diagnose import Diagnosis, LongDiagnosis
from lostmotion.diagnose.diagnosis import Item
from lostmotion.diagnose.drawn_rows import drawn_share
from lostmotion.diagnose.evidence_words import KIND, LABEL, balance, cause, probability
from lostmotion.diagnose.loop_stability import EXACT, LIGHTLY_DAMPED
from lostmotion.diagnose.objections import sticks
from lostmotion.diagnose.op_span import op_span
from lostmotion.diagnose.oscillation import Oscillation
from lostmotion.diagnose.verdict import SURE
from lostmotion.identify.actuators.kind import NEEDED, NO_FAULT, kind_of
from lostmotion.records.movement import TOLERANCE
from lostmotion.report.digits import FINEST, bracketed, digits, plain, signed, span
from lostmotion.report.fit_text import fill, head
from lostmotion.report.seen_in_position import seen_in_position

MARK = 0.5  # log-odds of one mark of a bar
MOST_MARKS = 12
LIKELY = (
    0.8  # probability of a fault of the actuator, from which on it is named as the place even where the fault is not
)


def diagnosis_summary(diagnosis: Diagnosis) -> str:
    """Report of a diagnosis as plain text."""
    parts = [
        _head(diagnosis),
        fill(verdict_sentence(diagnosis)),
        fill(where_from(diagnosis)),
        fill(_position(diagnosis)),
        _evidence(diagnosis),
        _oscillation(diagnosis),
        _kinds(diagnosis),
        not_excluded(diagnosis),
        _stability(diagnosis),
        _performance(diagnosis),
        _last(diagnosis),
    ]
    return "\n".join(part for part in parts if part)


def _head(diagnosis: Diagnosis) -> str:
    """Name and size of the record; of a long one how much of it is shown."""
    of = f", of {diagnosis.of_rows} of the record" if isinstance(diagnosis, LongDiagnosis) else ""
    return head(diagnosis.fit, of)


def verdict_sentence(diagnosis: Diagnosis) -> str:
    """What is wrong, how much, how bad, how sure: one sentence."""
    verdict, sure = diagnosis.verdict, probability(diagnosis.confidence)
    if verdict == NO_FAULT:
        return f"NOTHING WRONG with the actuator: no lost motion over {_cleared(diagnosis)}, confidence {sure}."
    if verdict == "other oscillation":
        said = f"OTHER OSCILLATION: the loop swings, but not because of the actuator, confidence {sure}."
        return said + _open(diagnosis)
    if verdict == "cannot tell":
        if diagnosis.why:
            whom = " of the valve" if diagnosis.source else ""
            return f"CANNOT TELL{whom}: {diagnosis.why}."
        if diagnosis.confidence >= SURE:
            return "CANNOT TELL: the record does not show how OP moves PV."
        return f"CANNOT TELL: no cause reaches a probability of {100 * SURE:.0f} %."
    return f"{verdict.upper()}{_size(diagnosis)}, severity {_severity(diagnosis)}, confidence {sure}."


def _position(diagnosis: Diagnosis) -> str:
    """What the measured position shows, and what PV adds; "" where there is none."""
    named = diagnosis.verdict if diagnosis.kind == "actuator" else NO_FAULT
    return "" if diagnosis.actuator is None else seen_in_position(diagnosis.actuator, named)


def _severity(diagnosis: Diagnosis) -> str:
    """The severity, those of the ends of the interval where they differ, and why the span of OP may be needed."""
    whole, said = op_span(diagnosis.record), diagnosis.severity
    if said == "unknown":
        return f"{said} (give op_span=(low, high))" if whole.request(diagnosis.size) else said
    least, most = (whole.severity(end) for end in diagnosis.interval)
    if "unknown" in (least, most) or least == most:
        return said
    return f"{said} ({least} to {most} over the interval)"


def _open(diagnosis: Diagnosis) -> str:
    """What stays open of an actuator that does not make the swing."""
    if diagnosis.cleared or not diagnosis.excluded:
        return ""
    largest = max(diagnosis.excluded.values())
    size = f"up to {_cleared(diagnosis)}" if math.isfinite(largest) else "of any size"
    return f" Lost motion {size} is not excluded."


def _cleared(diagnosis: Diagnosis) -> str:
    """Largest size that is not excluded, in % of span."""
    largest = max(diagnosis.excluded.values(), default=math.nan)
    return f"{_percent(diagnosis, largest):.2g} % {op_span(diagnosis.record).words}"


def _percent(diagnosis: Diagnosis, size: float) -> float:
    """Of the span."""
    return size / op_span(diagnosis.record).percent


def not_excluded(diagnosis: Diagnosis, who: str = "this record does") -> str:
    """What the record leaves open, kind by kind."""
    if not diagnosis.excluded:
        return ""
    unit = bracketed(diagnosis.record.op_unit)
    rows = [
        f"  {kind:12} {plain(size):>8} of OP{unit}, {_percent(diagnosis, size):.2g} % {op_span(diagnosis.record).words}"
        if math.isfinite(size)
        else f"  {kind:12} of any size"
        for kind, size in diagnosis.excluded.items()
    ]
    return "\n".join(["", f"Largest lost motion that {who} not exclude (95 %)", *rows])


def where_from(diagnosis: Diagnosis) -> str:
    """Where it comes from, and the probability of every cause."""
    ranked = sorted(diagnosis.probabilities.items(), key=lambda pair: -pair[1])
    causes = ", ".join(f"{cause(name)} {probability(value)}" for name, value in ranked)
    said, aside, fault = KIND[diagnosis.kind], "", diagnosis.probabilities.get("actuator", 0.0)
    if diagnosis.kind == "actuator" and fault < SURE:
        said, aside = "OP stands at its limit, where the process does not answer.", " of anything else"
    elif diagnosis.kind == "unknown" and fault > LIKELY and not drawn_share(diagnosis.fit.data):
        said = "It looks like the actuator; the record does not say which fault of it."
    if diagnosis.source:
        swing = None if diagnosis.kind == "sensor" else diagnosis.error_oscillation
        said = (
            diagnosis.source if swing is None else f"The loop swings every {plain(swing.period)} s. {diagnosis.source}"
        )
    return f"{said}{_in_units(diagnosis)} Probabilities{aside}: {causes}.".strip()


def size_text(diagnosis: Diagnosis) -> str:
    """Size in % of span with its 95 % interval, or as apparent where there is none; "" where there is no size."""
    if not math.isfinite(diagnosis.size_percent):
        return ""
    whole = op_span(diagnosis.record).words
    percent = diagnosis.size_percent / diagnosis.size if diagnosis.size else 0.0
    low, high = (percent * end for end in diagnosis.interval)
    if not (math.isfinite(low) and math.isfinite(high)):
        return f"about {diagnosis.size_percent:.2g} % {whole} (apparent, no interval)"
    value, between = _between(diagnosis.size_percent, low, high)
    return f"{value} % {whole} (95 % interval {between})"


def _between(value: float, low: float, high: float) -> tuple[str, str]:
    """Value and interval with the digits that matter: finer than 2 % of the value is of no use to anyone."""
    error = max((high - low) / 4.0, FINEST * abs(value), 1e-300)
    return digits(value, error)[0], span(low, high, error)


def _size(diagnosis: Diagnosis) -> str:
    """Size in % of span, limits where it is a saturation."""
    parameters, kind = diagnosis.fit.parameters, kind_of(diagnosis.verdict)
    if kind.size is None:
        if not {*kind.model.own} <= {*parameters}:
            return ""
        ends = " and ".join(plain(parameters[name]) for name in kind.model.own)
        return f" at OP {ends}{bracketed(diagnosis.record.op_unit)}"
    said = size_text(diagnosis)
    return f" of {said}" if said else " of unknown size"


def _in_units(diagnosis: Diagnosis) -> str:
    """The size once more, in units of OP, and what of the fault it measures."""
    if not math.isfinite(diagnosis.size):
        return ""
    kind = diagnosis.fit.kind
    what = kind.words.measure
    if kind.name != diagnosis.verdict and kind.size is not None:
        what += f" of the {kind.name} that was fitted"
    unit = bracketed(diagnosis.record.op_unit)
    if not all(math.isfinite(end) for end in diagnosis.interval):
        return f" In units of OP{unit}: about {diagnosis.size:.2g}."
    value, between = _between(diagnosis.size, *diagnosis.interval)
    return f" In units of OP{unit}: {what} {value} ({between})."


def _evidence(diagnosis: Diagnosis) -> str:
    found = balance(diagnosis.probabilities, (item.weight for item in diagnosis.evidence))
    lines = [
        "",
        f"Evidence: log-odds of {found.fault} against no actuator fault (+3: 20 to 1)",
        f"  {'':18} {'value':>7} {'log-odds':>8}",
        *(_row(item) for item in diagnosis.evidence),
        _sum("before evidence", found.before),
        _sum("together", found.total),
    ]
    return "\n".join(lines)


def _sum(name: str, odds: float) -> str:
    return f"  {name:18} {'':7} {signed(odds):>8}  {bar(odds)}".rstrip()


def _row(item: Item) -> str:
    name, meaning = LABEL.get(item.name, (item.name, item.meaning))
    return (
        f"  {name:18} {item.value:7.2f} {signed(item.weight):>8}  {bar(item.weight):{MOST_MARKS}}  {meaning}".rstrip()
    )


def bar(value: float) -> str:
    """Marks of + or -, one for half a unit of log-odds, at most twelve."""
    return ("+" if value > 0 else "-") * min(round(abs(value) / MARK), MOST_MARKS)


def _oscillation(diagnosis: Diagnosis) -> str:
    dt = diagnosis.fit.data.dt
    pairs = (("OP", diagnosis.measured.op), ("PV", diagnosis.measured.pv))
    return "\n".join(["", "Oscillation", *(f"  {name} {_swing(one, dt)}" for name, one in pairs)])


def _swing(one: Oscillation, dt: float) -> str:
    if not math.isfinite(one.period):
        return "does not move, or the record is too short to tell"
    period, share = plain(one.period * dt), f"{100 * one.share:.0f} %"
    if not one.regular:
        below = math.floor(10.0 * one.regularity) / 10.0  # 0.96 is no 1.0
        return (
            f"does not swing regularly: regularity {below:.1f} (1 is needed); "
            f"strongest near {period} s, {share} of its variance"
        )
    return (
        f"swings regularly: period {period} s, {one.cycles:.0f} periods, {share} of its variance, "
        f"regularity {one.regularity:.1f} (1 is needed)"
    )


def _kinds(diagnosis: Diagnosis) -> str:
    kinds = diagnosis.fit.kinds
    if kinds is None:
        return ""
    ranked = sorted(((gain, kind) for kind, gain in kinds.likelihoods.items() if kind != NO_FAULT), reverse=True)
    said = ", ".join(f"{kind} {gain:+.1f} / {kinds.gains[kind]:+.1f}" for gain, kind in ranked)
    return "\n" + fill(
        f"Actuators compared: log-likelihood less what the parameters cost ({NEEDED:g} is needed) / of rows left out, "
        f"over that of a linear process: {said or 'none was worth a fit'}.{_against(diagnosis.verdict, ranked)}"
    )


def _against(verdict: str, ranked: list[tuple[float, str]]) -> str:
    """That the comparison is not what names the fault, where another kind is ahead that does not stick."""
    if not ranked or not sticks(verdict) or sticks(ranked[0][1]):
        return ""
    return " The evidence of the trend, not this comparison, names a valve that sticks."


def _stability(diagnosis: Diagnosis) -> str:
    found = diagnosis.stability
    if found is None:
        return fill("Controller: no feedback from PV to OP is visible, so the tuning cannot be judged.")
    dt = diagnosis.fit.data.dt
    if found.unexplained >= EXACT:
        left = f"{100 * min(found.unexplained, 1.0):.0f} %"
        return fill(f"Controller: a PI leaves {left} of the moves of OP unexplained, so the tuning cannot be judged.")
    if found.kp * found.ki < 0.0 or abs(found.kp) < abs(found.ki):
        return fill(
            "Controller: the PI that explains OP best has no reset time of a sample or more, so it is not shown."
        )
    reset = f", reset time {plain(found.kp / found.ki * dt)} s" if found.ki else ""
    root = "no root of the loop oscillates"
    if math.isfinite(found.period):
        light = f"lightly damped, the limit is {LIGHTLY_DAMPED:g}" if found.damping < LIGHTLY_DAMPED else "damped"
        root = f"least damped root: ratio {found.damping:.2f} ({light}), period {plain(found.period * dt)} s"
    return fill(f"Controller: PI with gain {plain(found.kp)}{reset}; with the process of the fit, {root}.")


def _performance(diagnosis: Diagnosis) -> str:
    found = diagnosis.performance
    low, high = sorted(found.harris)
    harris = f"{low:.2g} .. {high:.2g}" if math.isfinite(low) and math.isfinite(high) else "unknown"
    whole = op_span(diagnosis.record).words
    about = "SP" if diagnosis.record.sp is not None else "its mean"
    rows = [
        ("class", f"{found.audit_class} ({_whose_limits(diagnosis)})"),
        ("Harris index", f"{harris} (1 is best; for the delay found and for 3 times that)"),
        ("PV about " + about, f"deviation {plain(math.sqrt(found.variance))}{bracketed(diagnosis.record.pv_unit)}"),
        (
            "travel of OP",
            f"{plain(found.travel)} % {whole} an hour, {plain(found.reversals)} reversals an hour",
        ),
        ("not in automatic", f"{100 * found.manual:.0f} % of the time"),
        (
            "OP at a limit",
            f"{100 * found.limited:.0f} % of the time, touches and rows within {100 * TOLERANCE:g} % {whole} included",
        ),
    ]
    return "\n".join(["", "Performance, whatever the reason", *(f"  {name:18} {text}" for name, text in rows)])


def _whose_limits(diagnosis: Diagnosis) -> str:
    """Type of loop whose limits the class uses; one that nobody named is told by the process alone."""
    used, named = diagnosis.performance.loop_type, diagnosis.record.loop_type
    if used == "level" and named != "level":
        return "limits for: level, for it behaves like one"
    return f"limits for: {used}"


def _last(diagnosis: Diagnosis) -> str:
    lines = ["", "What to do", *(fill(f"- {text}") for text in diagnosis.advice), ""]
    lines += [fill(f"Note: {note}") for note in diagnosis.notes]
    lines.append(f"Data fingerprint {diagnosis.fingerprint}.")
    return "\n".join(lines)
