"""Settings of a block by the kind of fault: one rule for each, and a refusal for kinds without one."""

from __future__ import annotations

from dataclasses import dataclass
from functools import singledispatch

from lostmotion.errors import ParameterError
from lostmotion.models import Backlash, DeadZone, Nonlinearity, Stiction

HOLD = 2.0  # shape of the dead-zone inverse, chosen by the figures of docs/compensation.md
ZONE_IN_DEVIATIONS = 3.0  # hold: OP noise does not carry OP_IN back across the centre
QUIET_IN_DEVIATIONS = 2.5  # backlash: half of the play that keeps noise from turning the direction
BAND_IN_DEVIATIONS = 6.0  # stiction: from a peak of the noise to a trough of it
LEAST = 0.01  # of the width, for zone and quiet: rounding must not turn anything
ASSUMED_NOISE = 0.1  # of the width, where the noise of OP is not known
MARGIN = 1.1  # of the cap over the largest offset that the settings ask for
HUNT_TIMES = 3.0  # process times: changes of side closer than that are hunting
HUNT_LIMIT = 4.0  # changes of side in a row, after which the guard gives way (variables.py says so)
METHODS = ("knocker", "two moves")


@dataclass(frozen=True)
class Plan:
    """What a rule gets.

    Attributes
    ----------
    factor : float
        Share of the lost motion that is compensated.
    noise : float or None
        Standard deviation of the noise of OP.
    span : (float, float)
        Smallest and largest command.
    centre : float or None
        OP at which a dead zone shall rest.
    process_scans : float or None
        Dead time and slowest time constant in scans.
    method : str
        For stiction, one of ``METHODS``.
    """

    factor: float
    noise: float | None
    span: tuple[float, float]
    centre: float | None
    process_scans: float | None
    method: str


@dataclass(frozen=True)
class Derived:
    """What a rule gives: kind of block, size of the lost motion that the ramp is measured by, settings by name."""

    kind: str
    size: float
    settings: dict[str, float]


@singledispatch
def rule(valve: Nonlinearity, plan: Plan) -> Derived:  # noqa: ARG001  the registered ones take the plan
    """Block for a kind of fault.

    Raises
    ------
    ParameterError
        A kind without a rule.
    """
    remedy = "other faults have no block: mend the actuator"
    raise ParameterError.expected("a dead zone, backlash or stiction", type(valve).__name__, remedy)


def _noise(plan: Plan, width: float) -> float:
    """Noise of OP, or what is assumed."""
    return ASSUMED_NOISE * width if plan.noise is None else plan.noise


def centre_of(valve: DeadZone, centre: float | None) -> float:
    """OP at which a dead zone shall rest: as asked for, else 0 where it holds that, else its middle."""
    if centre is not None:
        return centre
    return 0.0 if valve.left <= 0.0 <= valve.right else 0.5 * (valve.left + valve.right)


@rule.register
def _dead_zone(valve: DeadZone, plan: Plan) -> Derived:
    """Hold variant; the zone scales with the noise of OP."""
    centre = centre_of(valve, plan.centre)
    ends = [
        abs((end - centre) / slope + plan.factor * (edge - centre) - (end - centre))
        for end in (*plan.span, centre)
        for slope, edge in ((valve.left_slope, valve.left), (valve.right_slope, valve.right))
    ]
    deviations = ZONE_IN_DEVIATIONS if plan.noise is not None else 1.0
    zone = max(deviations * _noise(plan, valve.width), LEAST * valve.width)
    derived = {
        "left_break": valve.left, "right_break": valve.right, "centre": centre, "left_slope": valve.left_slope,
        "right_slope": valve.right_slope, "shape": HOLD, "zone": zone,
        "cap": MARGIN * max(ends), "hunt_limit": HUNT_LIMIT,
        "hunt_scans": 0.0 if plan.process_scans is None else float(round(HUNT_TIMES * plan.process_scans)),
    }  # fmt: skip
    return Derived("dead zone", valve.width or 1.0, derived)


@rule.register
def _backlash(valve: Backlash, plan: Plan) -> Derived:
    """Half the width either way."""
    lead = 0.5 * valve.width
    deviations = QUIET_IN_DEVIATIONS if plan.noise is not None else 1.0
    quiet = max(deviations * _noise(plan, valve.width), LEAST * valve.width)
    derived = {
        "lead_up": lead, "lead_down": lead, "quiet": quiet, "cap": MARGIN * (lead * max(plan.factor, 1.0) + quiet),
    }  # fmt: skip
    return Derived("backlash", lead or 1.0, derived)


@rule.register
def _stiction(valve: Stiction, plan: Plan) -> Derived:
    if plan.method not in METHODS:
        raise ParameterError.expected("method 'knocker' or 'two moves'", repr(plan.method), "choose one of them")
    return _knocker(valve, plan) if plan.method == "knocker" else _two_moves(valve, plan)


def _knocker(valve: Stiction, plan: Plan) -> Derived:
    """Pulses of half the band S, one scan in five: what did best in docs/compensation.md."""
    amplitude = 0.5 * valve.band
    cap = MARGIN * amplitude * max(plan.factor, 1.0)
    derived = {"amplitude": amplitude, "pulse_scans": 1.0, "period_scans": 5.0, "cap": cap}
    return Derived("stiction knocker", amplitude or 1.0, derived)


def _two_moves(valve: Stiction, plan: Plan) -> Derived:
    """First move well out of the band, second to the aim less half of S - J."""
    static = 0.5 * (valve.band + valve.jump)
    derived = {
        "overshoot": 2.0 * static, "stand": 0.5 * (valve.band - valve.jump), "move_scans": 5.0, "share": 0.5,
        "release": 4.0 * valve.band, "band": BAND_IN_DEVIATIONS * _noise(plan, valve.band),
        "cap": 0.25 * (plan.span[1] - plan.span[0]),
    }  # fmt: skip
    return Derived("stiction two moves", static or 1.0, derived)
