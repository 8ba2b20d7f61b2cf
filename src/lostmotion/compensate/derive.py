"""Settings of a block from a model of the fault, or from a fit and its uncertainty."""

from __future__ import annotations

from typing import Any

import numpy as np

from lostmotion import _verbs
from lostmotion.arguments import finite, not_negative, positive
from lostmotion.compensate.block import CompensatorBlock
from lostmotion.compensate.gate import Said, pass_gate
from lostmotion.compensate.rules import Plan, rule
from lostmotion.compensate.slopes import compensated_valve, slope_bound
from lostmotion.errors import ParameterError
from lostmotion.identify import FitFacts, RatedEstimate
from lostmotion.models import Nonlinearity
from lostmotion.records.span import PERCENT

MOST_SCANS = 1e8  # that a process takes; three times as many are counted
RAMP_SCANS = (10.0, 600.0)  # for the whole lost motion


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
    accepted: str = "",
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
    notes, accepted : tuple of str and str
        As in :class:`CompensatorBlock`.
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
    scans = None if process_time is None else _process_scans(process_time, scan_time)
    plan = Plan(not_negative("factor", factor), noise, (low, high), centre, scans, method)
    derived = rule(valve, plan)
    if noise is None and derived.kind != "stiction knocker":
        notes = (*notes, "noise of OP not given: a tenth of the width taken; give op_noise")
    if ramp is not None:
        per_scan = positive("ramp", ramp) * scan_time
    else:
        per_scan = derived.size / min(max(100.0 if scans is None else scans, RAMP_SCANS[0]), RAMP_SCANS[1])
    cap = settings.get("cap", derived.settings["cap"])
    common = {"factor": plan.factor, "low": low, "high": high, "safe": low, "ramp_step": per_scan, "rate": 2.0 * cap}
    return CompensatorBlock.of(derived.kind, scan_time, {**common, **derived.settings, **settings}, notes, accepted)


def block_from_fit(
    fit: RatedEstimate,
    *,
    scan_time: float | None = None,
    span: tuple[float, float] | None = None,
    factor: float | None = None,
    level: float = 0.95,
    op_noise: float | None = None,
    ramp: float | None = None,
    diagnosis: Said | None = None,
    accept: str | None = None,
    **options: Any,
) -> CompensatorBlock:
    """Block from a fit and its uncertainty; ``fit.block()`` is this.

    Parameters
    ----------
    fit : HammersteinFit or FitFacts
        Must show its kind of lost motion and its size (:mod:`lostmotion.compensate.gate`).
    scan_time : float, optional
        Seconds between two scans. None: the sampling time of the record.
    span : (float, float), optional
        Smallest and largest OP: the clamps. It must hold every OP of the record. None: the span of OP that the record
        had, else 0 .. 100.
    factor : float, optional
        Share of the estimated lost motion that is compensated. None: the lower end of the interval of the width,
        over the width.
    level : float
        Confidence of that interval.
    op_noise, ramp
        As in :func:`block_from_model`. None: the noise from the record where it is of a closed loop; the process time
        is that of the fitted process.
    diagnosis : Diagnosis, its dictionary or its verdict, optional
        Of the same loop: it must name the kind that was fitted.
    accept : str, optional
        Reason for which a fit that shows no such thing is built on all the same; the block keeps it.
    **options
        As in :func:`block_from_model`.

    Raises
    ------
    GateError
        A fit whose status does not carry a compensation, or a diagnosis that says something else, and no reason.
    ParameterError
        A kind without a block, a width that may be nothing, a span that OP leaves, a reason without a word.

    Notes
    -----
    Why the lower end: what is left uncompensated is a smaller fault of the same kind, and the loop gets better in
    proportion. What is compensated too much is a new one: the command jumps further than the valve's gap, the loop
    has a relay in it and may cycle for ever, at any gain. So the error is put on the harmless side. With a good
    record it costs little: a width known to 1 % (standard error) is compensated to 98 %.
    """
    facts = fit.facts
    span = span or facts.op_span or PERCENT
    accepted, name = pass_gate(facts, diagnosis, accept), _size_of(facts)
    notes = [f"from a fit of {facts.samples} samples, status {facts.status.name}"]
    if factor is None:
        factor = _safe_share(facts, name, level)
        said = f"lower end of the {level:.0%} interval of the {name} {facts.parameters[name]:.4g}"
        notes.append(f"factor {factor:.3f}: {said}")
    if options.get("method") == "two moves" and facts.chosen.integrating:
        raise ParameterError.expected("a self-regulating process", "an integrating one", "take method='knocker'")
    if options.get("method") == "two moves" and getattr(facts.nonlinearity, "model", "") == "he ramp":
        known = "one that the gain of the process undoes, as the valve slips between the rows"
        raise ParameterError.expected("a slip jump that the record shows", known, "take method='knocker'")
    _require_span(facts, span)
    if op_noise is None and facts.closed_loop and facts.op_noise:
        op_noise = facts.op_noise
        notes.append(f"noise of OP {op_noise:.3g}, from the record")
    valve = compensated_valve(facts, level)
    if valve != facts.nonlinearity:
        notes.append(f"slopes equal: the {level:.0%} interval of their ratio holds 1")
    scan = facts.dt if scan_time is None else positive("scan_time", scan_time)
    found = {"factor": factor, "op_noise": op_noise, "ramp": ramp, "process_time": facts.linear.process_time}
    bound = slope_bound(facts, valve, not_negative("factor", factor), options.get("centre"))
    if bound and facts.known_gain is None:
        notes.append("slopes differ, the gain is not known: offset kept within the distance to the break points")
    return block_from_model(
        valve, scan, span=span, notes=tuple(notes), accepted=accepted, **{**found, **bound, **options}
    )


def compensator_from_fit(
    fit: RatedEstimate, *, diagnosis: Said | None = None, accept: str | None = None, **options: Any
) -> Any:
    """Ideal inverse of what a fit shows; ``fit.compensator()`` is this.

    Raises
    ------
    GateError
        As in :func:`block_from_fit`.
    ParameterError
        A kind without an inverse.
    """
    pass_gate(fit.facts, diagnosis, accept)
    return _verbs.compensator(fit.nonlinearity, **options)


def _size_of(facts: FitFacts) -> str:
    """Parameter that says how much is lost."""
    if facts.kind.size is None:
        remedy = "other faults have no block: mend the actuator"
        raise ParameterError.expected("a dead zone, backlash or stiction", facts.kind.name, remedy)
    return facts.kind.size


def _safe_share(facts: FitFacts, name: str, level: float) -> float:
    """Lower end of the interval of the size over the size."""
    lowest, size = facts.interval(name, level)[0], facts.parameters[name]
    if not (lowest > 0.0 and size > 0.0):
        remedy = "record more moves of OP, or give factor"
        raise ParameterError.expected(f"a {name} that is surely above 0", f"{size:.3g} from {lowest:.3g}", remedy)
    return min(lowest / size, 1.0)


def _require_span(facts: FitFacts, span: tuple[float, float]) -> None:
    least, most = facts.op_range
    if least < span[0] or most > span[1]:
        got = f"{span}, OP {least:.4g} to {most:.4g}"
        low, high = span_seen(facts)
        remedy = f"give span=(low, high), the limits of OP; {low:g} to {high:g} is what it did, with room for the block"
        error = ParameterError.expected("a span that holds the OP of the record", got, remedy)
        raise error.leads_on({"span": (low, high)})


def span_seen(facts: FitFacts) -> tuple[float, float]:
    """What OP did in the record, and half of the lost motion to either side, which is what the block adds.

    Rounded outwards to a hundredth of its width: the narrowest clamps between which the block does what it is for.
    """
    least, most = facts.op_range
    room = 0.5 * facts.parameters[facts.kind.size] if facts.kind.size else 0.0
    grain = 10.0 ** np.floor(np.log10(max(most - least, 1e-300)) - 1.0)
    low, high = np.floor((least - room) / grain), np.ceil((most + room) / grain)
    return float(f"{low * grain:.6g}"), float(f"{high * grain:.6g}")


def _process_scans(process_time: float, scan_time: float) -> float:
    """Time of the process in scans; the block counts them in whole numbers of 32 bits."""
    scans = positive("process_time", process_time) / positive("scan_time", scan_time)
    if not scans <= MOST_SCANS:
        raise ParameterError.expected(f"a process_time up to {MOST_SCANS:g} scans", f"{scans:g}", "check both times")
    return scans
