"""A dead zone that is left with a jump: still up to its break points, then on lines that reach zero inside of them.

Motors need more to start than to keep turning. Without the jump the lines that fit best reach zero too far out, and the
rest of the model bends to make up for it. Only which samples lie between the break points matters, so these are held
where the likelihood is largest, and the lines are refined beside them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain, product

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.distributions import chi2_quantile
from lostmotion.identify.actuators.dead_zone import DeadZoneFamily
from lostmotion.identify.actuators.loads import explained_by
from lostmotion.identify.likelihood.beside import Beside
from lostmotion.identify.likelihood.criterion import criterion
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.refinement import refine

PROMISING = 8.0  # of log-likelihood of jumps at six places with all else held: then it is tried
WORTH = 5.0  # of BIC with everything refined
FIRST_AT = (0.1, 0.25, 0.45)  # of the width beyond either line, where the first look has its jumps
LINES = (1.0, 0.9, 0.8, 0.7, 0.6)  # widths between the lines that are tried, over that without a jump
BREAKS = (1.0, 1.08, 1.16, 1.25, 1.35, 1.5, 1.7)  # and between the break points
ASIDE = (0.3, 0.2, 0.1, 0.05)  # of each break point's distance from the middle, by which it is then moved alone
FINER = (1.0, 1.0, 0.2)  # shares of these, by turns with the rest of the model
LEAST_SHARE = 0.4  # of the lines' width in that between the break points: less is one line with jumps, no gap
FARTHEST, PLACES = 2.0, 25  # of a line's distance from the middle, where a break point may be, and places to there
LEVEL = 0.95  # of its interval

Breaks = tuple[float, float]


def broken_away(fitted: Fitted) -> Fitted:
    """The same dead zone with break points beyond its lines, where that pays; one that has them, where they are now."""
    family = fitted.problem.family
    if not isinstance(family, DeadZoneFamily):
        return fitted
    left, right, ratio = fitted.actuator.tolist()
    if not right > left or (family.still is None and _first_look(fitted, left, right) < PROMISING):
        return fitted
    plain = _at(fitted, None, fitted.actuator) if family.still else fitted
    best = _best(fitted, _trials(left, right, ratio)) if family.still is None else fitted
    for share in FINER:
        best = min((best, _best(best, _either_side(best, share))), key=criterion)
    pays = criterion(best) < criterion(plain) - 2.0 * WORTH
    return best if pays and _is_one(best) else plain


def _is_one(fitted: Fitted) -> bool:
    """Whether the lines reach zero apart from each other: else it is no gap that is left with a jump."""
    (low, high), (left, right) = break_points(fitted) or (0.0, 0.0), fitted.actuator[:2]
    return bool(right - left > LEAST_SHARE * (high - low))


def break_points(fitted: Fitted) -> Breaks | None:
    """Between which the valve does not move, scaled; None where that is where its lines reach zero."""
    family = fitted.problem.family
    return family.still if isinstance(family, DeadZoneFamily) else None


def break_point_ranges(fitted: Fitted) -> tuple[Breaks, Breaks] | None:
    """95 % intervals of both break points, process and noise held: between levels of OP, and as far as PV allows."""
    still = break_points(fitted)
    if still is None:
        return None
    own, problem = fitted.actuator, fitted.problem
    beside = Beside(problem, fitted.fit.theta, fitted.basis)
    limit = fitted.fit.cost + chi2_quantile(LEVEL, 1) * fitted.variance
    middle, levels = 0.5 * (own[0] + own[1]), np.unique(problem.u)

    def allowed(side: int, place: float) -> bool:
        ends = (place, still[1]) if side == 0 else (still[0], place)
        return beside.settled(_family(problem.family, ends), own)[1] <= limit

    found = []
    for side, line in enumerate(own[:2].tolist()):
        inner, outer = sorted((line, middle + FARTHEST * (line - middle)))
        places = np.linspace(inner, outer, PLACES)
        step = places[1] - places[0]
        good = [place for place in (still[side], *places.tolist()) if place == still[side] or allowed(side, place)]
        low, high = min(good) - step, max(good) + step
        beyond = levels[levels <= low], levels[levels >= high]
        found.append((float(max(beyond[0], default=low)), float(min(beyond[1], default=high))))
    return found[0], found[1]


def _first_look(fitted: Fitted, left: float, right: float) -> float:
    """What jumps beyond the lines gain in log-likelihood, beside what the lines do if they move."""
    u, width = fitted.problem.u, right - left
    shares = (0.0, *FIRST_AT)
    lines = (np.clip(u - end, low, high) for end, low, high in ((right, 0.0, np.inf), (left, -np.inf, 0.0)))
    above = ((u > right + share * width).astype(float) for share in shares)
    below = ((u < left - share * width).astype(float) for share in shares)
    return explained_by(fitted, chain(lines, above, below))[1]


def _trials(left: float, right: float, ratio: float) -> Iterator[tuple[Breaks, FloatArray]]:
    """Lines and break points about the middle."""
    middle, half = 0.5 * (left + right), 0.5 * (right - left)
    for line, still in product(LINES, BREAKS):
        own = np.array([middle - line * half, middle + line * half, ratio])
        yield (middle - still * half, middle + still * half), own


def _either_side(fitted: Fitted, finer: float) -> Iterator[tuple[Breaks, FloatArray]]:
    """One of the break points elsewhere."""
    low, high = break_points(fitted) or fitted.actuator[:2].tolist()
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    for share in (1.0 + sign * finer * aside for aside in ASIDE for sign in (-1.0, 1.0)):
        yield (low, middle + share * half), fitted.actuator
        yield (middle - share * half, high), fitted.actuator


def _best(fitted: Fitted, trials: Iterator[tuple[Breaks, FloatArray]]) -> Fitted:
    """Of trials with process and noise held, the best refined."""
    problem = fitted.problem
    beside = Beside(problem, fitted.fit.theta, fitted.basis)
    settled = [(beside.settled(_family(problem.family, still), own), still) for still, own in trials]
    (theta, _), still = min(settled, key=lambda one: one[0][1])
    return _refined(fitted, still, theta)


def _at(fitted: Fitted, still: Breaks | None, own: FloatArray) -> Fitted:
    theta = fitted.fit.theta.copy()
    theta[fitted.problem.eta_at : fitted.problem.eta_at + own.size] = own
    return _refined(fitted, still, theta)


def _refined(fitted: Fitted, still: Breaks | None, theta: FloatArray) -> Fitted:
    problem = replace(fitted.problem, family=_family(fitted.problem.family, still))
    return replace(fitted, problem=problem, fit=refine(problem, theta, fitted.basis))


def _family(family: object, still: Breaks | None) -> DeadZoneFamily:
    assert isinstance(family, DeadZoneFamily)  # noqa: S101  asked only of those
    return replace(family, still=still)
