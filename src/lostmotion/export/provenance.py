"""What the header says about the fit that the settings come from."""

from __future__ import annotations

import math

from lostmotion.identify import FitFacts

SHOWN = ("left", "right", "width", "slope_ratio", "band", "jump")


def provenance(facts: FitFacts) -> dict[str, str]:
    """Lines "data", "fit" and "interval" from a known fit."""
    numbers = {name: value for name, value in facts.parameters.items() if name in SHOWN and math.isfinite(value)}
    ends = {name: facts.interval(name) for name in numbers}
    bounded = {name: pair for name, pair in ends.items() if all(map(math.isfinite, pair))}
    return {
        "data": f"{facts.source or facts.tag or 'arrays'}, {facts.samples} samples of {facts.dt:g} s, "
        f"fingerprint {facts.fingerprint}",
        "fit": f"{facts.preferred}, status {facts.status.name}: "
        + ", ".join(f"{name} {value:.6g}" for name, value in numbers.items()),
        "interval": "95 %: " + ", ".join(f"{name} {low:.6g} .. {high:.6g}" for name, (low, high) in bounded.items()),
    }
