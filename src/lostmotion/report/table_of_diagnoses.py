"""Diagnoses of several loops: a line for each, and a table with the worst first."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence

from lostmotion.diagnose import Diagnosis
from lostmotion.diagnose.diagnosis import verdicts
from lostmotion.diagnose.evidence_words import probability
from lostmotion.diagnose.op_span import op_span
from lostmotion.report.diagnosis_text import size_text
from lostmotion.text_table import text_table

NAME = 20
WORST = ("severe", "high", "moderate", "unknown", "low", "none")
HEAD = ("loop", "verdict", "severity", "from", "% of span", "sure", "period, s", "class")
WIDTHS = (NAME, 18, 9, 12, 10, 10, 10, 11)


def diagnosis_line(name: str, found: Diagnosis | None, error: str | None = None) -> str:
    """Verdict, size and confidence of one loop, or why there is none."""
    if found is None:
        return f"{name:{NAME}} error: {error}"
    said = [found.verdict, size_text(found)]
    if found.verdict != "cannot tell":
        said.append(f"confidence {probability(found.confidence)}")
    return f"{name:{NAME}} {', '.join(part for part in said if part)}"


def diagnosis_table(rows: Sequence[tuple[str, Diagnosis | None]]) -> str:
    """Table of several loops, worst first, and how often each verdict came.

    Parameters
    ----------
    rows : sequence of (name, Diagnosis or None)
        None where there is no result.
    """
    done = [(name, found) for name, found in rows if found is not None]
    counts = Counter(found.verdict for _, found in done)
    said = [f"{counts[verdict]} {verdict}" for verdict in verdicts() if counts[verdict]]
    if len(done) < len(rows):
        said.append(f"{len(rows) - len(done)} without a result")
    lines = text_table(HEAD, WIDTHS, [_cells(name, found) for name, found in sorted(done, key=_rank)])
    return "\n".join([*lines, f"{len(rows)} loops: {', '.join(said)}."])


def _rank(row: tuple[str, Diagnosis]) -> tuple[int, int, float]:
    """Actuators by severity and size first, then what cannot be told, other oscillations, and the sound ones."""
    found = row[1]
    order = {"none": 3, "other oscillation": 2, "cannot tell": 1}.get(found.verdict, 0)
    size = found.size_percent if math.isfinite(found.size_percent) else 0.0
    return order, WORST.index(found.severity), -size


def _cells(name: str, found: Diagnosis) -> tuple[str, ...]:
    period = found.measured.period * found.fit.data.dt
    return (
        name,
        found.verdict,
        found.severity,
        found.kind,
        f"{found.size_percent:.2g}" if math.isfinite(found.size_percent) and op_span(found.record).known else "-",
        probability(found.confidence) if found.verdict != "cannot tell" else "-",
        f"{period:.3g}" if math.isfinite(period) else "-",
        found.performance.audit_class,
    )
