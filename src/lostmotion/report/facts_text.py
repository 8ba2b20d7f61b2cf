"""A known fit in a few lines."""

from __future__ import annotations

from lostmotion.identify import FitFacts
from lostmotion.report.digits import digits, error_of, plain, span
from lostmotion.report.fit_text import fill


def facts_summary(facts: FitFacts) -> str:
    """Finding, data and what a block would use, as plain text."""
    low, high = facts.op_range
    noise = {None: "not known", 0.0: "none"}.get(facts.op_noise, plain(facts.op_noise or 0.0))
    name = facts.tag or facts.source or "record"
    return "\n".join(
        [
            fill(f"{name}: {found_in(facts)} (status {facts.status.name}). {facts.message}"),
            fill(
                f"From {facts.samples} samples every {facts.dt:g} s in {'closed' if facts.closed_loop else 'open'} "
                f"loop, OP {low:.5g} .. {high:.5g}, noise of OP {noise}; fits {facts.fit_percent:.1f} % of PV."
            ),
            f"Data fingerprint {facts.fingerprint}.",
        ]
    )


def found_in(facts: FitFacts) -> str:
    """Kind with its size."""
    name = facts.shown_size
    if name is None:
        return facts.preferred
    interval = facts.size_interval
    error = error_of(interval, facts.standard_errors[name])
    shown, deviation = digits(facts.parameters[name], error)
    return f"{facts.preferred} of {name} {shown} +/- {deviation}, 95 % {span(*interval, error)}"
