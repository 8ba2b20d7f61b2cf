"""Severity of a lost motion in the terms of the valve industry."""

from __future__ import annotations

import numpy as np

SEVERITIES = ((1.0, "low"), (2.0, "moderate"), (4.0, "high"))  # % of span; the paper's introduction


def severity_of(percent: float) -> str:
    """Severity in the valve industry's terms: 1 % of span is recommended, 2 % usual, 4 % bad."""
    if not np.isfinite(percent):
        return "unknown"
    for limit, name in SEVERITIES:
        if percent <= limit:
            return name
    return "severe"
