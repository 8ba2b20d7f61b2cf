"""What is wrong with a measurement, as far as its row says it: facts that need no diagnosis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from statistics import median

from lostmotion.audit import rules
from lostmotion.diagnose.evidence_words import probability
from lostmotion.diagnose.frozen import stood_still
from lostmotion.plant import PlantLoop
from lostmotion.store.rows import AssessmentRow

FROZEN = 0.35  # severity of a measurement that stood still
LOUD = 5.0  # % of span over which a measurement scatters from row to row (six deviations): less is usual
LOUDER, LEAST_LOUD = 8.0, 2.0  # times what is usual in loops of its type, from which on it counts too; % of span
RESTS = 0.5  # share of time without live data, from which on what moves from row to row is a step of the resolution
NEIGHBOURS = 5  # loops of a type that tell what is usual
FAST = 8.0  # rows in a period: a faster swing looks like scatter
NOISY = 0.35  # severity of a measurement that is nothing but scatter


def usual_scatter(rows: Sequence[AssessmentRow], loops: Mapping[str, PlantLoop]) -> dict[str, float]:
    """Median of the scatter in % of span (six deviations) by type of loop, where five loops and more have one."""
    known: dict[str, dict[str, float]] = {}
    for row in rows:
        kind = loops[row.tag].loop_type if row.tag in loops else ""
        if kind and "scatter_percent" in row.indices:
            known.setdefault(kind, {})[row.tag] = 6.0 * row.indices["scatter_percent"]
    return {kind: median(one.values()) for kind, one in known.items() if len(one) >= NEIGHBOURS}


def stuck(row: AssessmentRow) -> str:
    """What is said of a measurement that stood still while OP moved; empty: it did not, or the valve is the finding."""
    share = row.indices.get("stuck", 0.0)
    if not stood_still(share, row.limited or 0.0, row.indices.get("stale", 0.0)) or _valve_is_known(row):
        return ""
    standing = f"{rules.FROZEN.opening} for {probability(share)} of the time while OP moved"
    return f"{standing}: look at the measurement and its recording"


def loud(row: AssessmentRow, usual: float | None = None) -> float | None:
    """% of span over which PV scatters, where that is a finding: no fast swing, and no lost motion that is known."""
    over = 6.0 * row.indices.get("scatter_percent", 0.0)
    apart = usual is not None and over >= max(LOUDER * usual, LEAST_LOUD)
    fast = (row.regularity or 0.0) > 1.0 and (row.period or 0.0) < FAST * (row.dt or 0.0)
    rests = row.indices.get("stale", 0.0) > RESTS
    return None if (over < LOUD and not apart) or fast or rests or _valve_is_known(row) else over


def of_measurement(row: AssessmentRow, usual: float | None) -> tuple[float, str, rules.Rule] | None:
    """Severity of what is wrong with a measurement, its words and its rule; None: nothing is known to be."""
    said, over = stuck(row), loud(row, usual)
    if said:
        return FROZEN, said, rules.FROZEN
    if over is None:
        return None
    more = "" if usual is None or over < 2.0 * usual else f", {over / usual:.0f} times what is usual in its type"
    severity = max(over / (over + LOUD), 0.0 if usual is None else 1.0 - 0.5 * LOUDER * usual / over)
    words = f"{rules.NOISY.opening} {over:.2g} % of span from row to row{more}: look at the measurement and its damping"
    return NOISY * severity, words, rules.NOISY


def _valve_is_known(row: AssessmentRow) -> bool:
    return row.kind == "actuator" and row.size is not None
