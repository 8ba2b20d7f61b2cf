"""A recursive estimate as text."""

from __future__ import annotations

import textwrap

import numpy as np

from lostmotion.errors import Status
from lostmotion.identify import RecursiveEstimate
from lostmotion.identify.actuators.kind import kind_of
from lostmotion.identify.rated_estimate import HIDDEN
from lostmotion.report.digits import digits, span
from lostmotion.report.fit_text import MEANING, WIDTH


def recursive_summary(estimate: RecursiveEstimate) -> str:
    """Report of a recursive estimate as plain text."""
    lines = [f"After {estimate.samples} samples", "=" * WIDTH, _fill(f"{estimate.status.name}: {words(estimate)}")]
    if estimate.status is not Status.CANNOT_TELL:
        lines += _table(estimate)
    lines += [_fill(sentence) for sentence in since(estimate)]
    return "\n".join(lines)


def since(estimate: RecursiveEstimate) -> list[str]:
    """Since when nothing new is known about a break point."""
    sentences = []
    for name, sample in (estimate.informed or {}).items():
        if estimate.samples - sample > STALE:
            sentences.append(
                f"No information about the {name} break point since sample {sample} "
                f"({estimate.samples - sample} samples ago): OP has hardly crossed it, or was masked."
            )
    return sentences


STALE = 1000  # samples without information that are worth a sentence


def words(estimate: RecursiveEstimate) -> str:
    """What the status means here."""
    if estimate.status is Status.INTEGRATING:
        return str(estimate.status.value)
    if not np.isfinite(estimate.parameters["width"]):
        return "the first window has told nothing yet; no number is given."
    if estimate.status is Status.NOT_SEEN:
        high = max(estimate.interval("width")[1], 0.0)
        return f"no dead zone is seen; one wider than {high:.2g} would have been (95 %)."
    return str(estimate.status.value)


def _table(estimate: RecursiveEstimate) -> list[str]:
    lines = [f"{'':14}{'estimate':>14}{'std. error':>13}   {'95 % interval':<26}", "-" * WIDTH]
    for name, value, deviation, between, meaning in parameter_rows(estimate):
        lines.append(f"{name:14}{value:>14}{deviation:>13}   {between:<26}{meaning}")
    return lines


def parameter_rows(estimate: RecursiveEstimate) -> list[tuple[str, str, str, str, str]]:
    """Name, estimate, standard error, interval and meaning of each parameter; none before anything is known."""
    rows: list[tuple[str, str, str, str, str]] = []
    if estimate.status is Status.CANNOT_TELL:
        return rows
    own = {} if estimate.status in HIDDEN else kind_of(estimate.nonlinearity.kind).words.meanings
    for name, meaning in {**own, **MEANING}.items():
        if name not in estimate.parameters:
            continue
        error = estimate.standard_errors[name]
        value, deviation = digits(estimate.parameters[name], error)
        between = "" if deviation == "given" else span(*estimate.interval(name), error)
        rows.append((name, value, deviation, between, meaning))
    return rows


def _fill(text: str) -> str:
    return textwrap.fill(text, WIDTH, subsequent_indent="  ")
