"""Settings of a block from a model of the fault, or from a fit and its uncertainty."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from lostmotion.arguments import finite, not_negative, positive
from lostmotion.arrays import FloatArray
from lostmotion.compensate.block import CompensatorBlock
from lostmotion.errors import ParameterError
from lostmotion.identify import HammersteinFit
from lostmotion.models import Backlash, DeadZone, LinearModel, Nonlinearity, Stiction

HOLD = 2.0  # shape of the dead-zone inverse, chosen by the figures of docs/compensation.md
ZONE_IN_DEVIATIONS = 3.0  # hold: OP noise does not carry OP_IN back across the centre
QUIET_IN_DEVIATIONS = 2.5  # backlash: half of the play that keeps noise from turning the direction
BAND_IN_DEVIATIONS = 6.0  # stiction: from a peak of the noise to a trough of it
LEAST = 0.01  # of the width, for zone and quiet: rounding must not turn anything
ASSUMED_NOISE = 0.1  # of the width, where the noise of OP is not known
MARGIN = 1.1  # of the cap over the largest offset that the settings ask for
RAMP_SCANS = (10.0, 600.0)  # for the whole lost motion
HUNT_TIMES = 3.0  # process times: changes of side closer than that are hunting
HUNT_LIMIT = 4.0
SIZE = {"dead zone": "width", "backlash": "width", "stiction": "band"}


@dataclass(frozen=True)
class _Plan:
    """What a rule gets: the share of the lost motion, the noise of OP, the span."""

    factor: float
    noise: float | None
    span: tuple[float, float]
    centre: float | None
    process_scans: float | None


def block_from_model(
    valve: Nonlinearity,
    scan_time: float,
    *,
    span: tuple[float, float] = (0.0, 100.0),
    factor: float = 1.0,
    op_noise: float | None = None,
    ramp: float | None = None,
    process_time: float | None = None,
    centre: float | None = None,
    method: str = "knocker",
    notes: tuple[str, ...] = (),
    **settings: float,
) -> CompensatorBlock:
    """Block that compensates a known fault.

    Parameters
    ----------
    valve : DeadZone, Backlash or Stiction
        The fault, in units of OP.
    scan_time : float
        Seconds between two scans.
    span : (float, float)
        Smallest and largest command: the clamps.
    factor : float
        Share of the lost motion that is compensated.
    op_noise : float, optional
        Standard deviation of the noise in OP_IN, in its units: for a PI about ``abs(kp)`` times that of PV. Dead
        zone: the side holds until OP_IN is 3 of them past the centre; backlash: a play of +-2.5 of them in front of
        the inverse, so that noise does not turn its direction. None: a tenth of the width is taken instead, and `notes`
        say so.
    ramp : float, optional
        Largest change of the offset in units of OP a second while anything is switched. None: the lost motion in
        `process_time`, but in 10 to 600 scans; in 100 scans where that is not given.
    process_time : float, optional
        Dead time and slowest time constant of the process together, in seconds. Dead zone: changes of side that
        follow each other within three times this are hunting, and the guard gives way. None: no guard.
    centre : float, optional
        Dead zone: OP at which the valve shall rest. None: 0 where the dead zone holds it, else its middle.
    method : {"knocker", "two moves"}
        For stiction. Two moves hold the valve still: only for a self-regulating process under a steady load.
    **settings : float
        Any parameter of the block by name, instead of what the rules give.

    Raises
    ------
    ParameterError
        A fault without a block, an unknown setting, or values that the block refuses.

    Notes
    -----
    Cap: 1.1 times the largest offset within the span. RATE: twice the cap, no limit while compensating. HOLD_ON_DISABLE
    off, SAFE at the lower clamp: set it to the fail-safe position.

    Examples
    --------
    >>> from lostmotion.models import Backlash
    >>> block = block_from_model(Backlash(2.0), scan_time=1.0, op_noise=0.1)
    >>> {name: round(block.settings[name], 3) for name in ("lead_up", "quiet", "ramp_step", "cap")}
    {'lead_up': 1.0, 'quiet': 0.25, 'ramp_step': 0.01, 'cap': 1.375}
    """
    low, high = finite("span", span[0]), finite("span", span[1])
    noise = None if op_noise is None else not_negative("op_noise", op_noise)
    scans = None if process_time is None else positive("process_time", process_time) / positive("scan_time", scan_time)
    plan = _Plan(not_negative("factor", factor), noise, (low, high), centre, scans)
    kind, size, derived = _rule(valve, method)(valve, plan)
    if noise is None and kind != "stiction knocker":
        notes = (*notes, "noise of OP not given: a tenth of the width taken; give op_noise")
    if ramp is not None:
        per_scan = positive("ramp", ramp) * scan_time
    else:
        per_scan = size / min(max(100.0 if scans is None else scans, RAMP_SCANS[0]), RAMP_SCANS[1])
    cap = settings.get("cap", derived["cap"])
    common = {"factor": plan.factor, "low": low, "high": high, "safe": low, "ramp_step": per_scan, "rate": 2.0 * cap}
    return CompensatorBlock.of(kind, scan_time, {**common, **derived, **settings}, notes)


def block_from_fit(
    fit: HammersteinFit,
    *,
    scan_time: float | None = None,
    span: tuple[float, float] = (0.0, 100.0),
    factor: float | None = None,
    level: float = 0.95,
    op_noise: float | None = None,
    ramp: float | None = None,
    **options: Any,
) -> CompensatorBlock:
    """Block from a fit and its uncertainty; ``fit.block()`` is this.

    Parameters
    ----------
    fit : HammersteinFit
        Must show its kind of lost motion (``fit.preferred``).
    scan_time : float, optional
        Seconds between two scans. None: the sampling time of the record.
    span : (float, float)
        Smallest and largest OP: the clamps. It must hold every OP of the record.
    factor : float, optional
        Share of the estimated lost motion that is compensated. None: the lower end of the interval of the width,
        over the width.
    level : float
        Confidence of that interval.
    op_noise, ramp
        As in :func:`block_from_model`. None: the noise from the record where it is of a closed loop; the process time
        is that of the fitted process.
    **options
        As in :func:`block_from_model`.

    Raises
    ------
    ParameterError
        A fit whose status does not carry a compensation, a width that may be nothing, a span that OP leaves.

    Notes
    -----
    Why the lower end: what is left uncompensated is a smaller fault of the same kind, and the loop gets better in
    proportion. What is compensated too much is a new one: the command jumps further than the valve's gap, the loop
    has a relay in it and may cycle for ever, at any gain. So the error is put on the harmless side. With a good
    record it costs little: a width known to 1 % (standard error) is compensated to 98 %.
    """
    kind = fit.nonlinearity.kind
    if fit.preferred != kind or kind not in SIZE:
        got = f"{fit.preferred} (status {fit.status.name})"
        raise ParameterError.expected("a fit that shows a lost motion with a block", got, fit.status.value)
    notes = [f"from a fit of {fit.data.u.size} samples, status {fit.status.name}"]
    if factor is None:
        name = SIZE[kind]
        lowest, size = fit.interval(name, level)[0], fit.parameters[name]
        if not lowest > 0.0:
            remedy = "record more moves of OP, or give factor"
            raise ParameterError.expected(f"a {name} that is surely above 0", f"{size:.3g} from {lowest:.3g}", remedy)
        factor = min(lowest / size, 1.0)
        notes.append(f"factor {factor:.3f}: lower end of the {level:.0%} interval of the {name} {size:.4g}")
    if options.get("method") == "two moves" and fit.settings["chosen"]["integrating"]:
        raise ParameterError.expected("a self-regulating process", "an integrating one", "take method='knocker'")
    least, most = float(fit.data.u.min()), float(fit.data.u.max())
    if least < span[0] or most > span[1]:
        got = f"{span}, OP {least:.4g} to {most:.4g}"
        raise ParameterError.expected("a span that holds the OP of the record", got, "give span=(low, high)")
    if op_noise is None and fit.evidence.closed_loop:
        op_noise = noise_of(fit.data.u) or None
        if op_noise is not None:
            notes.append(f"noise of OP {op_noise:.3g}, from the record")
    scan = fit.linear.dt if scan_time is None else positive("scan_time", scan_time)
    found = {"factor": factor, "op_noise": op_noise, "ramp": ramp, "process_time": _process_time(fit.linear)}
    return block_from_model(fit.nonlinearity, scan, span=span, notes=tuple(notes), **{**found, **options})


def noise_of(op: FloatArray) -> float:
    """Standard deviation of white noise in a record of OP, from its second differences (robust); 0 where OP is held.

    Examples
    --------
    >>> noise_of(np.repeat([1.0, 2.0], 50))
    0.0
    """
    second = np.abs(np.diff(op, 2))
    return float(1.4826 * np.median(second) / math.sqrt(6.0)) if second.size else 0.0


def _process_time(linear: LinearModel) -> float:
    """Dead time and slowest time constant in seconds; an integrator counts as none."""
    sizes = np.abs(linear.poles)
    stable = sizes[(sizes > 0.0) & (sizes < 1.0 - 1e-9)]
    slowest = -1.0 / math.log(float(stable.max())) if stable.size else 0.0
    return float(linear.dt * (max(linear.delay, 1) + slowest))


_Rule = Callable[[Any, _Plan], tuple[str, float, dict[str, float]]]


def _rule(valve: Nonlinearity, method: str) -> _Rule:
    """Rule for a kind of fault."""
    if isinstance(valve, DeadZone):
        return _dead_zone
    if isinstance(valve, Backlash):
        return _backlash
    if isinstance(valve, Stiction):
        if method not in ("knocker", "two moves"):
            raise ParameterError.expected("method 'knocker' or 'two moves'", repr(method), "choose one of them")
        return _knocker if method == "knocker" else _two_moves
    raise ParameterError.expected(
        "a dead zone, backlash or stiction", type(valve).__name__, "other faults have no block: mend the actuator"
    )


def _noise(plan: _Plan, width: float) -> float:
    """Noise of OP, or what is assumed."""
    return ASSUMED_NOISE * width if plan.noise is None else plan.noise


def _dead_zone(valve: DeadZone, plan: _Plan) -> tuple[str, float, dict[str, float]]:
    """Hold variant; the zone scales with the noise of OP."""
    centre = plan.centre
    if centre is None:
        centre = 0.0 if valve.left <= 0.0 <= valve.right else 0.5 * (valve.left + valve.right)
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
    return "dead zone", valve.width or 1.0, derived


def _backlash(valve: Backlash, plan: _Plan) -> tuple[str, float, dict[str, float]]:
    """Half the width either way."""
    lead = 0.5 * valve.width
    deviations = QUIET_IN_DEVIATIONS if plan.noise is not None else 1.0
    quiet = max(deviations * _noise(plan, valve.width), LEAST * valve.width)
    derived = {
        "lead_up": lead, "lead_down": lead, "quiet": quiet, "cap": MARGIN * (lead * max(plan.factor, 1.0) + quiet),
    }  # fmt: skip
    return "backlash", lead or 1.0, derived


def _knocker(valve: Stiction, plan: _Plan) -> tuple[str, float, dict[str, float]]:
    """Pulses of half the band S, one scan in five: what did best in docs/compensation.md."""
    amplitude = 0.5 * valve.band
    cap = MARGIN * amplitude * max(plan.factor, 1.0)
    derived = {"amplitude": amplitude, "pulse_scans": 1.0, "period_scans": 5.0, "cap": cap}
    return "stiction knocker", amplitude or 1.0, derived


def _two_moves(valve: Stiction, plan: _Plan) -> tuple[str, float, dict[str, float]]:
    """First move well out of the band, second to the aim less half of S - J."""
    static = 0.5 * (valve.band + valve.jump)
    derived = {
        "overshoot": 2.0 * static, "stand": 0.5 * (valve.band - valve.jump), "move_scans": 5.0, "share": 0.5,
        "release": 4.0 * valve.band, "band": BAND_IN_DEVIATIONS * _noise(plan, valve.band),
        "cap": 0.25 * (plan.span[1] - plan.span[0]),
    }  # fmt: skip
    return "stiction two moves", static or 1.0, derived
