"""What the slopes of a fitted dead zone may do to a command: equal unless they clearly differ, and within bounds."""

from __future__ import annotations

import math
from dataclasses import replace

from lostmotion.compensate.rules import MARGIN, centre_of
from lostmotion.identify import FitFacts
from lostmotion.models import DeadZone, Nonlinearity


def compensated_valve(facts: FitFacts, level: float = 0.95) -> Nonlinearity:
    """The actuator of a fit as it is compensated.

    Where the interval of the slope ratio holds 1 both slopes of a dead zone are the same: 1 where the gain of the
    process is not known (it stays in the loop), else their geometric mean.

    Parameters
    ----------
    facts : FitFacts
    level : float
        Confidence of that interval.
    """
    valve = facts.nonlinearity
    if not isinstance(valve, DeadZone) or "slope_ratio" not in facts.parameters:
        return valve
    low, high = facts.interval("slope_ratio", level)
    if not low <= 1.0 <= high:
        return valve
    slope = 1.0 if facts.known_gain is None else math.sqrt(valve.left_slope * valve.right_slope)
    return replace(valve, left_slope=slope, right_slope=slope)


def slope_bound(facts: FitFacts, valve: Nonlinearity, factor: float, centre: float | None) -> dict[str, float]:
    """Cap of the offset where slopes other than 1 take part in it, as a setting of the block; else nothing.

    Slopes that are known (with the gain of the process) are undone as far as OP has been in the record, exactly.
    A mere ratio is a property of the process as much as of the valve: there the offset stays at the distance to the
    break points, so that it cannot grow with OP.

    Parameters
    ----------
    facts : FitFacts
    valve : Nonlinearity
        As it is compensated.
    factor : float
        Share of the lost motion that is compensated.
    centre : float, optional
        OP at which the dead zone shall rest.
    """
    if not isinstance(valve, DeadZone) or valve.left_slope == valve.right_slope == 1.0:
        return {}
    middle = centre_of(valve, centre)
    offsets = [factor * (edge - middle) for edge in (valve.left, valve.right)]
    if facts.known_gain is not None:
        low, high = facts.op_range
        offsets += [_offset(low, middle, offsets[0], valve.left_slope)] if low < middle + offsets[0] else []
        offsets += [_offset(high, middle, offsets[1], valve.right_slope)] if high > middle + offsets[1] else []
    return {"cap": MARGIN * max(map(abs, offsets))}


def _offset(command: float, middle: float, step: float, slope: float) -> float:
    """What the inverse adds to the controller output that gives this command."""
    way = command - middle
    return way - (way - step) * slope
