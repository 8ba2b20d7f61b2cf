"""What the caller asked for, checked at the door and turned into samples."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from lostmotion.arguments import finite, positive
from lostmotion.design.design_criterion import CONTRASTS
from lostmotion.design.operating_limits import EVERYTHING, Limits, Range
from lostmotion.design.prior import Known
from lostmotion.design.simulated_plant import Plant
from lostmotion.design.task import dominant
from lostmotion.errors import ParameterError
from lostmotion.models import LinearModel
from lostmotion.simulate import PI

FEWEST_SAMPLES, FEWEST_HOLDS = 60, 12  # below this identify has nothing to work on
MOST_SAMPLES = 100_000  # a day at one a second: longer than any test that an operator allows
LONGEST_TEST = 10_000_000  # samples that may be asked for
TARGETS = {"width": ("width",), "break points": ("left", "right")}
DEFAULT_HOLD = 1.0 / 3.0  # of delay and dominant time constant
LONGEST_CONSTANTS, LONGEST_HOLDS = 5.0, 3  # a hold ends when the process has settled: drifts are not waited for


@dataclass(frozen=True)
class Asked:
    """Checked request.

    Attributes
    ----------
    plant : Plant
        The model as given, at rest, in the loop where there is one.
    limits : Limits
    samples : int or None
        Length; None: the shortest that reaches `wanted`.
    fewest, most : int
        Between which the shortest is sought.
    wanted : dict of float or None
    target : str
        Of TARGETS.
    assumed : tuple of str
        What was not given.
    """

    plant: Plant
    limits: Limits
    samples: int | None
    fewest: int
    most: int
    wanted: dict[str, float] | None
    target: str
    assumed: tuple[str, ...]


def check(
    known: Known,
    *,
    loop: str,
    controller: PI | None,
    op_limits: Range | None,
    sp_limits: Range | None,
    pv_limits: Range | None,
    op_now: float | None,
    pv_now: float | None,
    rate_limit: float | None,
    shortest_hold: float | None,
    duration: float | None,
    wanted: Mapping[str, float] | None,
    target: str,
    seed: int,
) -> Asked:
    """Check everything that ``design`` was asked; see there.

    Raises
    ------
    ParameterError
        A limit or a combination that makes no sense.
    """
    _check_loop(loop, controller, op_limits, sp_limits, known)
    op = _range("op_limits", op_limits) or EVERYTHING
    start, assumed = _op_now(known, op_now, op, controller)
    plant = Plant(known.model, known.noise, start, controller, seed)
    plant = plant if pv_now is None else plant.anchored(finite("pv_now", pv_now))
    levels = op if controller is None else _range("sp_limits", sp_limits)
    assert levels is not None  # noqa: S101  checked above
    now = start if controller is None else plant.pv_now
    if not levels[0] <= now <= levels[1]:
        name = "op_limits" if controller is None else "sp_limits"
        raise ParameterError.expected(f"{name} that hold the present {now:.5g}", levels, "widen them or move op_now")
    pv = _pv_range(plant, pv_limits)
    _check_room(plant, pv)
    dt = known.model.linear.dt
    hold, said = _hold(shortest_hold, plant, dt)
    assumed += said
    rate = np.inf if rate_limit is None else positive("rate_limit", rate_limit) * dt
    samples, fewest, most = _length(duration, wanted, hold, dt)
    longest = _longest(plant, hold, samples or most)
    limits = Limits(levels, EVERYTHING if controller is None else op, pv, hold, longest, rate, now)
    if target not in TARGETS:
        raise ParameterError.expected(f"target as one of {list(TARGETS)}", repr(target), "choose one of them")
    return Asked(plant, limits, samples, fewest, most, _wanted(wanted), target, assumed)


def _check_loop(
    loop: str, controller: PI | None, op_limits: Range | None, sp_limits: Range | None, known: Known
) -> None:
    if loop not in ("open", "closed"):
        raise ParameterError.expected('loop as "open" or "closed"', repr(loop), "choose one of them")
    if loop == "open" and op_limits is None:
        raise ParameterError.expected("op_limits=(low, high)", None, "say how far OP may be moved")
    if loop == "closed" and (controller is None or sp_limits is None):
        raise ParameterError.expected(
            "a controller and sp_limits for a closed loop", f"{controller} and {sp_limits}", "give both"
        )
    if loop == "open" and (controller is not None or sp_limits is not None):
        raise ParameterError.expected("no controller and no sp_limits", "one of them", 'add loop="closed"')
    if loop == "closed" and known.model.linear.delay < 1:
        raise ParameterError.expected("delay >= 1 in a loop", known.model.linear.delay, "a held input acts later")


def _range(name: str, limits: Range | None) -> Range | None:
    if limits is None:
        return None
    try:
        low, high = (float(value) for value in limits)
        good = low < high and not np.isnan(low + high)
    except (TypeError, ValueError):
        good = False
    if not good:
        raise ParameterError.expected(f"{name} as (low, high) with low < high", limits, "give two numbers")
    if name != "pv_limits" and np.isinf([low, high]).any():
        raise ParameterError.expected(f"finite {name}", limits, "give two numbers")
    return low, high


def _pv_range(plant: Plant, limits: Range | None) -> Range:
    """Limits of PV; a level drifts with every move of OP, so nobody may leave them out there."""
    if limits is None and plant.integrating:
        remedy = "say what PV must not leave: pv_limits=(low, high)"
        raise ParameterError.expected("limits of PV for a process that integrates", "none", remedy)
    return _range("pv_limits", limits) or EVERYTHING


def _op_now(known: Known, op_now: float | None, op: Range, controller: PI | None) -> tuple[float, tuple[str, ...]]:
    if op_now is not None:
        op_now = finite("op_now", op_now)
        if not op[0] <= op_now <= op[1]:
            raise ParameterError.expected("op_now inside op_limits", op_now, "give OP before the test")
        return op_now, ()
    plant = Plant(known.model, known.noise, 0.0)
    zone = plant.zone
    if controller is not None and controller.bias:
        return controller.bias, (f"OP rests at {controller.bias:.5g} before the test, the bias of the controller",)
    if known.load is not None:
        middle, why = float(zone.inverse()(-known.load)), "where it balances the load of the fit"
    elif controller is None and not plant.integrating:
        middle, why = 0.5 * (op[0] + op[1]), "the middle of its limits"
    else:
        middle, why = 0.5 * (zone.left + zone.right), "the middle of the dead zone"
    return middle, (f"OP rests at {middle:.5g} before the test, {why}",)


def _check_room(plant: Plant, pv: Range) -> None:
    room = 3.0 * plant.noise_deviation
    if not pv[0] + room <= plant.pv_now <= pv[1] - room:
        raise ParameterError.expected(
            f"pv_limits that hold PV at rest and its noise, {plant.pv_now:.5g} +/- {room:.3g}",
            pv,
            "widen them, or check op_now and the offset of the model",
        )


def shortest_duration(linear: LinearModel) -> float:
    """Seconds that a test of this process lasts at least, with the holds that it has where none are given."""
    return _fewest(_default_hold(linear)) * linear.dt


def _fewest(hold: int) -> int:
    return max(FEWEST_SAMPLES, FEWEST_HOLDS * hold)


def _default_hold(linear: LinearModel) -> int:
    return max(round(DEFAULT_HOLD * (linear.delay + dominant(linear))), 1)


def _hold(shortest_hold: float | None, plant: Plant, dt: float) -> tuple[int, tuple[str, ...]]:
    if shortest_hold is not None:
        return max(int(np.ceil(positive("shortest_hold", shortest_hold) / dt - 1e-9)), 1), ()
    hold = _default_hold(plant.model.linear)
    return hold, (f"no level is held less than {hold * dt:.3g} s, a third of delay and dominant time constant",)


def _length(
    duration: float | None, wanted: Mapping[str, float] | None, hold: int, dt: float
) -> tuple[int | None, int, int]:
    """Samples (None: sought), fewest, most."""
    if duration is None and wanted is None:
        raise ParameterError.expected('duration=seconds or wanted={"width": 0.2}', "neither", "give one or both")
    fewest = _fewest(hold)
    most = MOST_SAMPLES if duration is None else round(positive("duration", duration) / dt)
    if most < fewest:
        raise ParameterError.expected(
            f"a duration of at least {fewest * dt:g} s ({fewest} samples, {FEWEST_HOLDS} of the shortest holds)",
            f"{most * dt:g} s",
            "give more time or allow shorter holds",
        )
    if most > LONGEST_TEST:
        raise ParameterError.expected(f"a duration of at most {LONGEST_TEST * dt:g} s", f"{most * dt:g} s", "give less")
    return (most if wanted is None else None), fewest, most


def _wanted(wanted: Mapping[str, float] | None) -> dict[str, float] | None:
    if wanted is None:
        return None
    if not isinstance(wanted, Mapping) or not wanted or not set(wanted) <= set(CONTRASTS):
        remedy = 'e.g. wanted={"width": 0.2}, half of the 95 % interval in units of OP'
        raise ParameterError.expected(f"wanted with names of {list(CONTRASTS)}", wanted, remedy)
    return {name: positive(f"wanted {name}", value) for name, value in wanted.items()}


def _longest(plant: Plant, hold: int, samples: int) -> int:
    settled = plant.model.linear.delay + LONGEST_CONSTANTS * dominant(plant.model.linear)
    return int(max(min(max(settled, LONGEST_HOLDS * hold), samples / FEWEST_HOLDS), 2 * hold))
