"""The interval of a size: that of the likelihood, and what a real valve is beside its model."""

from __future__ import annotations

from lostmotion.identify.actuators.kind import Kind
from lostmotion.identify.evidence import Evidence
from lostmotion.models import Nonlinearity, Stiction

# of the size of a valve that sticks: bodies with friction, lags and limited rates are fitted as a play with a jump. Of
# 68 such valves in an independent simulation, half by physical friction, 25 lay in the interval of the likelihood alone
MODEL_ERROR = 0.05
# of one that slips between the rows in a loop at rest, down and up: where OP goes up and down at one rate, a delay some
# rows too short is as good as a band wider by what OP moves in them. Of 44 such sizes of loops of published papers
# (benchmarks/published.py) 14 lay in the interval before; the true ones are 0.74 to 1.05 of those found (5 to 95 %)
BETWEEN_ROWS = 0.22, 0.08


def with_model_error(
    interval: tuple[float, float], size: float, kind: Kind, slips_between_rows: bool
) -> tuple[float, float]:
    """Interval of a size that counts that a valve which sticks is no play with a jump; no lower end below 0.

    Parameters
    ----------
    interval : (float, float)
        Of the likelihood, units of OP.
    size : float
        Units of OP.
    kind : Kind
    slips_between_rows : bool
        As `slips_at_rest` has it.
    """
    low, high = interval
    if not kind.sticks:
        return max(low, 0.0), high
    less, more = BETWEEN_ROWS if slips_between_rows else (MODEL_ERROR, MODEL_ERROR)
    return max(low - less * size, 0.0), high + more * size


def slips_at_rest(actuator: Nonlinearity, evidence: Evidence) -> bool:
    """Whether a valve was found that slips between the rows, in a loop in which PV predicts all that moves OP."""
    return isinstance(actuator, Stiction) and actuator.model == "he ramp" and evidence.only_fed_back
