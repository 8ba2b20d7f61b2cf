"""What an estimate in service would ask of its block: both break points at the inner ends of their intervals."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from lostmotion.compensate import CompensatorBlock
from lostmotion.compensate.adaptive import QUANTILE
from lostmotion.errors import Status
from lostmotion.identify import RecursiveEstimate
from lostmotion.live.supervision.settings import BlockSettings

MARGIN = 0.01  # of the resolution, inside the limits: REAL rounds
IN_FORCE = {"left": "force_first", "right": "force_second"}
SETTING = {"left": "left_break", "right": "right_break"}
RANGE = {"left": "first_range", "right": "second_range"}


@dataclass(frozen=True)
class Wish:
    """Widths to be asked for, or why there are none.

    Attributes
    ----------
    tried : CompensatorBlock or None
        The block in the PLC with other break points.
    why : str
        Empty where there is nothing to say about it.
    """

    tried: CompensatorBlock | None
    why: str = ""


def wish(settings: BlockSettings, estimate: RecursiveEstimate, seen: Mapping[str, float]) -> Wish:
    """What is worth to be asked for after this estimate.

    Parameters
    ----------
    settings : BlockSettings
        Of a block for a dead zone.
    estimate : RecursiveEstimate
    seen : mapping
        Outputs of the block: what is in force.
    """
    inner = _inner_ends(settings, estimate)
    if inner is None:
        return Wish(None)
    known = settings.block.settings
    armed = bool(seen["force_id"])
    now = {side: seen[IN_FORCE[side]] if armed else known[SETTING[side]] for side in inner}
    moved = {side: _allowed(settings, side, now[side], value) for side, value in inner.items()}
    least = max(settings.least_change, known["resolution"])
    change = max(abs(moved[side] - now[side]) for side in moved)
    if armed and change < least:
        beyond = max(abs(inner[side] - now[side]) for side in inner) >= least
        return Wish(None, "the estimate lies beyond the limits set in the PLC: look at the valve" if beyond else "")
    return Wish(settings.block.block.with_settings(**{SETTING[side]: value for side, value in moved.items()}))


def _inner_ends(settings: BlockSettings, estimate: RecursiveEstimate) -> dict[str, float] | None:
    """Break points that are surely inside the dead zone; None where the estimate is not good enough."""
    if estimate.status is not Status.OK:
        return None
    values, errors = estimate.parameters, estimate.standard_errors
    reach = {side: QUANTILE * errors[side] for side in IN_FORCE}
    width = values["right"] - values["left"]
    if not (math.isfinite(width) and width > 0.0 and max(reach.values()) <= settings.precision * width):
        return None
    centre = settings.block.settings["centre"]
    left, right = values["left"] + reach["left"], values["right"] - reach["right"]
    return {"left": min(left, centre), "right": max(right, centre)} if left < right else None


def _allowed(settings: BlockSettings, side: str, now: float, value: float) -> float:
    """Nearest value within the limits set in the PLC and one step of change, in whole units of the block."""
    known = settings.block.settings
    unit, setting = known["resolution"], known[SETTING[side]]
    step, reach = known["most_change"], known[RANGE[side]]
    low = max(now - step, setting - reach) + MARGIN * unit
    high = min(now + step, setting + reach) - MARGIN * unit
    number = round(min(max(value, low), high) / unit)
    if number * unit > high:
        number = math.floor(high / unit)
    elif number * unit < low:
        number = math.ceil(low / unit)
    return number * unit
