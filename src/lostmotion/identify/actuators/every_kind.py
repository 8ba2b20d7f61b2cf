"""Fits of all likely kinds of actuator, and the linear model that a fault must beat."""

from __future__ import annotations

from collections.abc import Callable

from lostmotion.identify.actuators.kinds import Sought, backlash_of, fit_kind, likely_kinds, stiction_of
from lostmotion.identify.actuators.loads import (
    loaded,
    pruned,
    sizes_of_loads,
    swings_of,
    with_loads,
    with_own_loads,
    without_actuator,
    without_loads,
    without_swings,
    without_their_effect,
)
from lostmotion.identify.evidence import gain_over_linear
from lostmotion.identify.likelihood.search import Fitted, ScaledData

SEEN = 6.0  # of BIC, by which backlash must beat the linear model before a jump is sought beside it
FOUND = 60.0  # of BIC: stiction so far ahead of backlash has its jump


def fits_of_all(
    scaled: ScaledData,
    linear: Fitted,
    orders: tuple[int, int, int] | None,
    noise: int | None,
    levels: bool,
    fit: Callable[[ScaledData, str, Sought, Fitted | None], Fitted],
) -> tuple[Fitted, dict[str, Fitted]]:
    """Best linear fit, and fits of the likely kinds, each with the loads that pay beside it.

    Where the linear model finds loads, all are sought once more without their effect, which hides from the profile
    what the actuator does.
    """
    linear = _cleaned(scaled, with_own_loads(linear), orders, noise, levels)
    swings = swings_of(scaled)
    if swings is not None:  # the process may have taken the place of a swing
        other = fit_kind(None, without_swings(scaled, swings), orders, noise, levels)
        other = with_loads(other, scaled, swings)
        linear = other if gain_over_linear(other, linear) > 0 else linear
    found = {kind: with_own_loads(one) for kind, one in _of_likely(scaled, orders, without_loads(linear), fit).items()}
    loads = linear.problem.family.loads
    if loads is not None:
        clean = without_their_effect(linear, scaled)
        for kind, one in _of_likely(clean, orders, without_loads(linear, clean.y), fit).items():
            other = with_own_loads(pruned(loaded(one, scaled.y, loads, sizes_of_loads(linear))))
            if kind not in found or gain_over_linear(other, found[kind]) > 0:
                found[kind] = other
    if "stiction" in found:
        simpler = with_own_loads(backlash_of(found["stiction"]))
        if "backlash" not in found or gain_over_linear(simpler, found["backlash"]) > 0:
            found["backlash"] = simpler
    linear = _best_linear(scaled, orders, noise, levels, linear, found)
    if "backlash" in found and _is_open(found, linear):
        richer = with_own_loads(stiction_of(found["backlash"]))
        if "stiction" not in found or gain_over_linear(richer, found["stiction"]) > 0:
            found["stiction"] = richer
            linear = _best_linear(scaled, orders, noise, levels, linear, found)
    return linear, found


def _best_linear(
    scaled: ScaledData,
    orders: tuple[int, int, int] | None,
    noise: int | None,
    levels: bool,
    linear: Fitted,
    found: dict[str, Fitted],
) -> Fitted:
    """What a fault must beat: the best linear model, also sought from the best fault and in the structure of each."""
    best = max(found.values(), key=lambda one: gain_over_linear(one, linear))
    again = with_own_loads(fit_kind(None, scaled, orders, noise, levels, without_loads(best)))
    again = _cleaned(scaled, again, orders, noise, levels, best)
    rivals = [linear, again, *(without_actuator(one) for one in found.values())]
    return max(rivals, key=lambda one: gain_over_linear(one, linear))


def _is_open(found: dict[str, Fitted], linear: Fitted) -> bool:
    """Whether backlash is seen, and stiction not so much more that its jump was surely found."""
    gain = gain_over_linear(found["backlash"], linear)
    return gain > SEEN and ("stiction" not in found or gain_over_linear(found["stiction"], linear) < gain + FOUND)


def _cleaned(
    scaled: ScaledData,
    linear: Fitted,
    orders: tuple[int, int, int] | None,
    noise: int | None,
    levels: bool,
    near: Fitted | None = None,
) -> Fitted:
    """The linear model sought anew without its loads, and refined with them, where that is better."""
    loads = linear.problem.family.loads
    if loads is None:
        return linear
    clean = without_their_effect(linear, scaled)
    again = fit_kind(None, clean, orders, noise, levels, near)
    again = with_own_loads(pruned(loaded(again, scaled.y, loads, sizes_of_loads(linear))))
    return again if gain_over_linear(again, linear) > 0 else linear


def _of_likely(
    scaled: ScaledData,
    orders: tuple[int, int, int] | None,
    linear: Fitted,
    fit: Callable[[ScaledData, str, Sought, Fitted | None], Fitted],
) -> dict[str, Fitted]:
    """Each kind but the dead zone, which has most local maxima, begins at the best before it."""
    found: dict[str, Fitted] = {}
    for kind, sought in likely_kinds(scaled, orders).items():
        nearest = max([linear, *found.values()], key=lambda other: gain_over_linear(other, linear))
        found[kind] = fit(scaled, kind, sought, None if kind == "dead zone" or not found else nearest)
    return found
