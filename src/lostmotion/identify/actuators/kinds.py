"""One fit for each kind of actuator: starts from its profile, likelihood, last steps where it has kinks."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.memory_families import BacklashFamily, SaturationFamily, StictionFamily
from lostmotion.identify.actuators.operator_profile import LaggedRegression, operator_profile
from lostmotion.identify.actuators.polish import polished
from lostmotion.identify.actuators.static_profile import Lags, profile
from lostmotion.identify.likelihood.family import DeadZoneFamily, Family, LinearFamily
from lostmotion.identify.likelihood.refinement import refine
from lostmotion.identify.likelihood.search import AUTO_LAGS, Fitted, ScaledData, best_fit

KINDS = ("none", "dead zone", "backlash", "stiction", "saturation")
STICTION_MODELS = ("kano", "he")
OUTER_SHARE = 0.01  # break points are sought where this share of the samples lies beyond them on either side
MOST_STARTS = 2
JUMPS = (0.25, 0.5, 0.8)  # shares of the band
HOPELESS = 30.0  # of log-likelihood behind the profile of the best kind
WORTHWHILE = 3.0  # of log-likelihood, before a kind is fitted in full


@dataclass(frozen=True)
class Sought:
    """One kind of actuator and where its likelihood is worth climbing.

    Attributes
    ----------
    family : Family
    etas : list of ndarray
        Starts, best first.
    squares : float
        Residual sum of squares of the profile at the best.
    """

    family: Family
    etas: list[FloatArray]
    squares: float


def seek(kind: str, data: ScaledData, orders: tuple[int, int, int] | None) -> Sought:
    """Global search for the actuator of one kind, by its profile."""
    if kind == "dead zone":
        return _dead_zone(data, orders)
    lagged = regression(data, orders)
    profiles = [operator_profile(lagged, family, data.u, MOST_STARTS) for family in families(kind, data)]
    family, starts = min(profiles, key=lambda item: item[1][0].squares)
    return Sought(family, [start.eta for start in starts], starts[0].squares)


def fit_kind(
    sought: Sought | None,
    data: ScaledData,
    orders: tuple[int, int, int] | None,
    noise: int | None,
    levels: bool,
    near: Fitted | None = None,
) -> Fitted:
    """Global maximum of the likelihood of one kind.

    Parameters
    ----------
    sought : Sought or None
        From ``seek``; None: no actuator fault.
    data : ScaledData
    orders, noise
        As in ``best_fit``.
    levels : bool
        Whether the process may integrate.
    near : Fitted or None
        As in ``best_fit``.
    """
    if sought is None:
        return best_fit(data, LinearFamily(), [np.zeros(0)], orders, noise, levels)
    best = best_fit(data, sought.family, sought.etas, orders, noise, levels, near)
    return polished(best) if sought.family.kinks else best


def backlash_of(stiction: Fitted) -> Fitted:
    """Backlash begun at a stiction that was found, with its process, noise and loads.

    Without its jump stiction is backlash, which must not look worse because of its own search.
    """
    problem, family = stiction.problem, stiction.problem.family
    assert isinstance(family, StictionFamily)  # noqa: S101  of this kind only
    simpler = BacklashFamily(family.widest, family.segments, family.rests, load=family.load, loads=family.loads)
    problem = replace(problem, family=simpler)
    band, jump = stiction.fit.theta[problem.eta_at : problem.eta_at + 2]
    found = []
    for width in (band, band - jump):
        theta = np.delete(stiction.fit.theta, problem.eta_at + 1)
        theta[problem.eta_at] = max(width, 0.0)
        found.append(Fitted(problem, refine(problem, theta, problem.basis), problem.basis))
    return polished(min(found, key=lambda one: one.fit.cost))


def stiction_of(backlash: Fitted) -> Fitted:
    """Stiction begun at a backlash that was found, with its process, noise and loads, and jumps of several sizes.

    The likelihood of a jump is a needle, which the profile, with a process of its own at every point, can pass by;
    from the process that a backlash has found the pattern search reaches it.
    """
    problem, family = backlash.problem, backlash.problem.family
    assert isinstance(family, BacklashFamily)  # noqa: S101  of this kind only
    width = float(backlash.fit.theta[problem.eta_at])
    found = []
    for model in STICTION_MODELS:
        sticking = StictionFamily(
            family.widest, family.segments, family.rests, model, load=family.load, loads=family.loads
        )
        richer = replace(problem, family=sticking)
        for share in JUMPS:
            theta = np.insert(backlash.fit.theta, problem.eta_at + 1, share * width)
            found.append(polished(Fitted(richer, refine(richer, theta, richer.basis), richer.basis)))
    return min(found, key=lambda one: one.fit.cost)


def likely_kinds(data: ScaledData, orders: tuple[int, int, int] | None) -> dict[str, Sought]:
    """Kinds whose profile explains more than a linear model and is not hopelessly behind another, likeliest first."""
    lagged = regression(data, orders)
    rows = lagged.samples
    found = {kind: seek(kind, data, orders) for kind in KINDS if kind != "none"}
    behind = {kind: 0.5 * rows * np.log(max(sought.squares, 1e-300)) for kind, sought in found.items()}
    linear = 0.5 * rows * np.log(max(lagged.squares(data.u), 1e-300))
    order = sorted(found, key=lambda kind: behind[kind])
    best = behind[order[0]]
    likely = [kind for kind in order if behind[kind] < best + HOPELESS]
    if "saturation" in likely and "dead zone" not in likely:
        likely.append("dead zone")  # seen from one side they are one shape, and the dead zone has more local maxima
    kept = {kind: found[kind] for kind in likely if kind == "dead zone" or behind[kind] < linear - WORTHWHILE}
    return kept or {order[0]: found[order[0]]}


def families(kind: str, data: ScaledData) -> list[Family]:
    """Forms in which a kind is tried on this record."""
    widest = float(np.ptp(data.u))
    if kind == "backlash":
        return [BacklashFamily(widest, data.segments)]
    if kind == "stiction":
        return [StictionFamily(widest, data.segments, model=model) for model in STICTION_MODELS]
    return [SaturationFamily((float(data.u.min()), float(data.u.max())))]


def regression(data: ScaledData, orders: tuple[int, int, int] | None) -> LaggedRegression:
    """PV without its own past, for profiles."""
    return LaggedRegression.on(data.y, data.segments, _lags(data, orders))


def _lags(data: ScaledData, orders: tuple[int, int, int] | None) -> Lags:
    if orders is None:
        return Lags.for_record(data.shortest, 1, inputs=AUTO_LAGS)
    return Lags.for_record(data.shortest, orders[2])


def _dead_zone(data: ScaledData, orders: tuple[int, int, int] | None) -> Sought:
    low, high = (float(value) for value in np.quantile(data.u, [OUTER_SHARE, 1 - OUTER_SHARE]))
    candidates = profile(data.u, data.y, data.segments, _lags(data, orders), low, high)
    etas = [np.array([c.left, c.right, c.log_ratio]) for c in candidates]
    return Sought(DeadZoneFamily(low, high), etas, candidates[0].rss)
