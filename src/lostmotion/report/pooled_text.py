"""A diagnosis of many records as text: verdict first, then what each record said."""

from __future__ import annotations

import math

from lostmotion.diagnose import PooledDiagnosis
from lostmotion.diagnose.evidence_words import probability
from lostmotion.diagnose.op_span import op_span
from lostmotion.diagnose.pooled.pooled_diagnosis import SPEAKS, RecordShare
from lostmotion.identify.actuators.kind import NO_FAULT
from lostmotion.report.diagnosis_text import diagnosis_summary, not_excluded, verdict_sentence
from lostmotion.report.digits import bracketed, digits, plain, span
from lostmotion.report.fit_text import WIDTH, fill
from lostmotion.text_table import text_table

HEAD = ("record", "rows", "alone", "said", "gain", "size, units of OP")
WIDTHS = (24, 6, 17, 9, 6, 24)
FINEST = 0.02  # of a size: finer digits are of no use


def pooled_summary(found: PooledDiagnosis) -> str:
    """Report of a diagnosis of many records as plain text."""
    if found.single:
        return diagnosis_summary(found)
    heads = [f"one valve, {_number(found)}", "=" * WIDTH]
    parts = [
        "\n".join(heads),
        fill(verdict_sentence(found)),
        fill(rests_on(found)),
        fill(_size(found)),
        fill(_trend(found)),
        _table(found),
        fill(_kinds(found)),
        not_excluded(found, "these records together do"),
        _last(found),
    ]
    return "\n".join(part for part in parts if part)


def _number(found: PooledDiagnosis) -> str:
    heard = sum(bool(share.rows) for share in found.shares)
    left = len(found.shares) - heard
    return f"{heard} records" + (f", {left} more left out" if left else "")


def rests_on(found: PooledDiagnosis) -> str:
    """How many records spoke, and whether one of them carries the answer."""
    if found.single:
        return f"Of the records only {found.single} can be used: the verdict is that of it alone."
    counts = {said: found.counted(said) for said in ("for", "against", "nothing")}
    kind = _likeliest(found)
    said = (
        f"Of the records {counts['for']} speak for {kind}, {counts['against']} against it, {counts['nothing']} tell "
        "nothing of it."
    )
    if found.kind == "actuator":
        said += f" That it is {kind} rather than another kind: {probability(found.kind_confidence)}."
    if found.carried_by:
        said += f" WITHOUT {found.carried_by} THE VERDICT WOULD BE ANOTHER: look at that one first."
    return said


def _likeliest(found: PooledDiagnosis) -> str:
    return max((name for name in found.totals if name != NO_FAULT), key=lambda name: found.totals[name])


def _size(found: PooledDiagnosis) -> str:
    if not math.isfinite(found.size):
        return ""
    (low, high), unit = found.interval, bracketed(found.record.op_unit)
    error = max((high - low) / 4.0, FINEST * found.size)
    return (
        f"In units of OP{unit}: {digits(found.size, error)[0]} ({span(low, high, error)}); from one of the records to "
        f"another it differs by about {100.0 * found.scatter:.0f} %."
    )


def _trend(found: PooledDiagnosis) -> str:
    trend = found.trend
    if not math.isfinite(trend.slope):
        return "" if not math.isfinite(found.size) else "Trend: fewer than three of the records show a size each."
    (low, high), unit = trend.interval, bracketed(found.record.op_unit)
    error = (high - low) / 4.0
    said = "grows" if trend.slope > 0.0 else "shrinks"
    first = f"Trend: the size {said}" if trend.seen else "Trend: none is seen"
    return (
        f"{first}, {digits(trend.slope, error)[0]} of OP{unit} a {trend.unit} ({span(low, high, error)}), from "
        f"{trend.number} records that show a size each."
    )


def _table(found: PooledDiagnosis) -> str:
    lines = text_table(HEAD, WIDTHS, [share_cells(share) for share in found.shares])
    about = f"gain: log-likelihood over a linear process at the common size; below {SPEAKS:g} it tells nothing"
    return "\n".join(["", *lines, about, ""])


def share_cells(share: RecordShare) -> tuple[str, ...]:
    """What one record added, in the order of HEAD."""
    name = share.name if len(share.name) <= WIDTHS[0] else "~" + share.name[1 - WIDTHS[0] :]
    if not share.rows:
        return name, "0", "", share.said, "", ""
    size = ""
    if math.isfinite(share.size):
        error = max((share.interval[1] - share.interval[0]) / 4.0, FINEST * share.size)
        size = f"{digits(share.size, error)[0]} ({span(*share.interval, error)})"
    return name, str(share.rows), share.alone, share.said, f"{share.gain:+.1f}", size


def _kinds(found: PooledDiagnosis) -> str:
    ranked = sorted(((gain, kind) for kind, gain in found.totals.items() if kind != NO_FAULT), reverse=True)
    said = ", ".join(f"{kind} {gain:+.1f}" for gain, kind in ranked)
    return f"Actuators compared, log-likelihood of all over a linear process: {said}."


def _last(found: PooledDiagnosis) -> str:
    whole = op_span(found.record).note
    lines = ["", "What to do", *(fill(f"- {text}") for text in found.advice), ""]
    lines += [fill(f"Note: {note}") for note in (*found.notes, *([whole] if whole else []))]
    lines.append(f"Tolerance {plain(found.tolerance)} of OP{bracketed(found.record.op_unit)}.")
    lines.append(f"Data fingerprint {found.fingerprint}.")
    return "\n".join(lines)
