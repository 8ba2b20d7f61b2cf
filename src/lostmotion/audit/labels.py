"""What a row says of a loop in one word: label of NAMUR NE 107, where the cause lies; whether it swings by itself."""

from __future__ import annotations

import math
from dataclasses import dataclass

from lostmotion.audit.measurement import loud, stuck
from lostmotion.audit.row_facts import in_span
from lostmotion.diagnose.control_error.amplitude import ErrorOscillation
from lostmotion.diagnose.ringing import rings_untold
from lostmotion.diagnose.verdict import limits_decide
from lostmotion.store.rows import AssessmentRow, Stage

HAND = 0.9  # share of time in manual from which the loop counts as being worked on
BAD = 4.0  # % of span, as severity_of has it
STUCK = 50.0  # % of span: a valve that hardly answers at all
SPLIT = {
    "actuator": "actuator", "tuning": "tuning", "disturbance": "process", "set point": "process", "sensor": "sensor",
    "none": "none",
}  # fmt: skip


@dataclass(frozen=True)
class Around:
    """What is known about a loop beside its row.

    Attributes
    ----------
    weight : float
        Of the largest.
    source : str
        Likely source of the swing of its group; empty: not known, or no group.
    usual : float, optional
        % of span over which loops of its type scatter.
    steady : bool
        Whether the strongest swing of its group keeps its amplitude: then noise builds up none of them.
    tells : bool
        Whether its error of control does: the span of PV is known, and it is no level, which may wander as a buffer.
    master : bool
        Whether its OP is the set point of another loop: it has no valve of its own.
    """

    weight: float = 1.0
    source: str = ""
    usual: float | None = None
    steady: bool = False
    tells: bool = False
    master: bool = False


ALONE = Around()


def split_of(row: AssessmentRow, around: Around = ALONE) -> str:
    """Sensor, actuator, tuning or process, "none", or "cannot tell"."""
    if stuck(row) or loud(row, around.usual) is not None:
        return "sensor"
    if row.verdict == "saturation":
        return "process"  # the load or the size of the valve: its motion is not at fault
    if makes_it_swing(row, around):
        return "tuning"
    kind = "disturbance" if disturbed(row, around) else row.kind
    return "cannot tell" if row.verdict == "cannot tell" else SPLIT.get(kind, "cannot tell")


def label_of(row: AssessmentRow, around: Around = ALONE) -> str:
    """Category of NAMUR NE 107 for the actuator (the sensor, where that is at fault); empty: cannot tell."""
    if row.manual is not None and row.manual >= HAND:
        return "function check"
    if stuck(row):
        return "failure"
    if loud(row, around.usual) is not None:
        return "maintenance required"
    if row.verdict == "cannot tell":
        return ""
    if row.kind == "sensor":
        return "maintenance required"
    if row.kind != "actuator":
        rings_untold = makes_it_swing(row, around) and not row.cleared
        return "" if rings_untold else "normal"  # it is to be retuned, and says nothing of the valve
    size = row.size_percent if in_span(row) else None
    if size is not None and size >= STUCK:
        return "failure"
    if row.verdict == "saturation" or row.severity == "severe" or (size is not None and size > BAD):
        return "out of specification"
    return "normal" if row.severity == "low" and not swings(row) else "maintenance required"


def swings(row: AssessmentRow) -> bool:
    """Whether the loop swings regularly, as published: regularity above 1."""
    return _oscillation(row).regular


def rings(row: AssessmentRow) -> bool:
    """Whether it swings as a loop that hardly settles: very regularly, with an amplitude that comes and goes."""
    return _oscillation(row).rings


def _oscillation(row: AssessmentRow) -> ErrorOscillation:
    """Of its error of control, as it was screened."""
    spread = row.indices.get("amplitude_spread", math.nan)
    periods = row.rows * row.dt / row.period if row.rows and row.dt and row.period else math.inf
    return ErrorOscillation(row.period or math.nan, row.regularity or 0.0, row.power or 0.0, spread, periods)


def makes_it_swing(row: AssessmentRow, around: Around) -> bool:
    """Whether a loop without a fault of its valve that is known swings by itself."""
    if row.stage is not Stage.ASSESSED and not _controls(row):
        return False
    untold = rings_untold(row.verdict, row.kind) and row.indices.get("closed_loop", 1.0) > 0.0
    return untold and around.source in ("", row.tag) and not around.steady and rings(row)


def _controls(row: AssessmentRow) -> bool:
    """Whether a loop that was not diagnosed was mostly in automatic and off its limits, with data fit for use."""
    manual, limited = row.manual or 0.0, row.limited or 0.0
    return row.stage is Stage.SCREENED and row.fit_for_use and manual < HAND and not limits_decide(row.verdict, limited)


def disturbed(row: AssessmentRow, around: Around) -> bool:
    """Whether its swing comes from elsewhere: noise lets no linear loop keep its amplitude, whatever its tuning."""
    steady = (around.steady and swings(row)) or _oscillation(row).steady
    blamed = row.kind == "tuning" and row.tag != around.source
    return row.kind in ("disturbance", "set point") or (blamed and steady)
