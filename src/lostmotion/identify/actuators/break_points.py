"""Intervals of break points from the profile likelihood, where its curvature at the top does not tell.

Curvature is the likelihood's shape at one point. Where OP has few levels inside the dead zone, or the interval reaches
as far as the zone is wide, the likelihood has bends within the interval: it is walked to where it has fallen by 1.92
(Wilks), everything else refined at every place.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.distributions import chi2_quantile, normal_quantile
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.parameters import information_inverse
from lostmotion.identify.likelihood.refinement import refine
from lostmotion.identify.scaled import Scaling

LEVEL = 0.95  # of the intervals
FEW_LEVELS = 4  # of OP inside the dead zone: fewer leave the likelihood with bends
FAR = 0.25  # interval over width, from which on it reaches over those levels
GROWTH, MOST_GROWTHS = 2.0, 5  # of the walk outwards
BISECTIONS = 5  # of its last step
STEPS = 12  # of the rest of the model at each place


def break_point_intervals(fitted: Fitted, scaling: Scaling) -> dict[str, tuple[float, float]]:
    """95 % intervals of break points and width in units of OP; none where curvature suffices, or nothing is seen.

    An end is at least as far as curvature says.
    """
    left, right = fitted.actuator[:2]
    if not right > left:
        return {}
    inverse, empty = information_inverse(fitted.fit.hessian, fitted.basis)
    moves = _moves(fitted)
    variances = [fitted.variance * float(move @ inverse @ move / (move @ move) ** 2) for move, _ in moves.values()]
    reaches = normal_quantile(0.5 + LEVEL / 2) * np.sqrt(variances)
    unseen = bool(empty[fitted.problem.eta_at : fitted.problem.eta_at + 2].any())
    if unseen or not np.all(reaches > 0.0) or _told_by_curvature(fitted, left, right, float(reaches[:2].max())):
        return {}
    values = {"left": left, "right": right, "width": right - left}
    centres = {"left": scaling.u_centre, "right": scaling.u_centre, "width": 0.0}
    found = {}
    for (name, (move, held)), reach in zip(moves.items(), reaches.tolist(), strict=True):
        low, high = (values[name] + sign * _reach(fitted, sign * move, held, reach) for sign in (-1.0, 1.0))
        low = max(low, 0.0) if name == "width" else low
        at, size = centres[name], scaling.u_scale
        found[name] = (float(at + size * low), float(at + size * high))
    return found


def _moves(fitted: Fitted) -> dict[str, tuple[FloatArray, FloatArray]]:
    """For each of left, right and width the move that changes it by 1, and the directions that leave it."""
    left, right = fitted.problem.eta_at, fitted.problem.eta_at + 1
    basis = fitted.basis if fitted.basis is not None else fitted.problem.basis
    free = np.eye(fitted.fit.theta.size) if basis is None else basis
    one = np.eye(fitted.fit.theta.size)
    together = free[:, free[right] == 0.0].copy()
    together[right] = together[left]
    found = {name: (one[row], free[:, free[row] == 0.0]) for name, row in (("left", left), ("right", right))}
    return found | {"width": (0.5 * (one[right] - one[left]), together)}


def about_levels(fitted: Fitted) -> Fitted:
    """The dead zone about the next level of OP on either side, where it holds few of them and that is likelier.

    Between two levels it slides unseen, so the search may end with a zone that holds none beside the level it holds.
    """
    u = fitted.problem.u
    left, right = fitted.actuator[:2]
    if not right > left or _inside(u, left, right) >= FEW_LEVELS:
        return fitted
    trials = [fitted]
    for level in (np.max(u, initial=-np.inf, where=u < left), np.min(u, initial=np.inf, where=u > right)):
        theta = fitted.fit.theta.copy()
        theta[fitted.problem.eta_at : fitted.problem.eta_at + 2] += level - 0.5 * (left + right)
        if np.isfinite(level):
            trials.append(replace(fitted, fit=refine(fitted.problem, theta, fitted.basis)))
    return min(trials, key=lambda one: one.fit.cost)


def _inside(u: FloatArray, left: float, right: float) -> int:
    """Levels of OP inside the dead zone."""
    return int(np.unique(u[(u > left) & (u < right)]).size)


def _told_by_curvature(fitted: Fitted, left: float, right: float, reach: float) -> bool:
    return _inside(fitted.problem.u, left, right) >= FEW_LEVELS and 2.0 * reach < FAR * (right - left)


def _reach(fitted: Fitted, move: FloatArray, held: FloatArray, reach: float) -> float:
    """How far the profile likelihood lets a parameter go along its move; at most the range of OP."""
    limit = fitted.fit.cost + chi2_quantile(LEVEL, 1) * fitted.variance
    inside, span = fitted.fit.theta, float(np.ptp(fitted.problem.u))
    left, right = fitted.problem.eta_at, fitted.problem.eta_at + 1
    best, place = fitted.fit.theta, np.abs(move) > 0.0

    def at(distance: float, start: FloatArray) -> FloatArray | None:
        """Best parameters there; None where they are rejected, or the break points have changed places."""
        theta = start.copy()
        if place[left] and place[right]:  # the middle may have moved since
            width = best[right] - best[left] + 2.0 * distance * move[right]
            middle = 0.5 * (start[left] + start[right])
            theta[left], theta[right] = middle - 0.5 * width, middle + 0.5 * width
        else:
            theta[place] = (best + distance * move)[place]
        if theta[left] > theta[right]:
            return None
        trial = refine(fitted.problem, theta, held, most_steps=STEPS, tied=True)
        return trial.theta if trial.cost <= limit else None

    near, far = reach, reach
    for _ in range(MOST_GROWTHS):
        trial = at(far, inside)
        if trial is None:
            break
        inside, near, far = trial, far, GROWTH * far
        if far > span:
            return span
    else:
        return near
    for _ in range(BISECTIONS if far > near else 0):
        middle = 0.5 * (near + far)
        trial = at(middle, inside)
        if trial is None:
            far = middle
        else:
            inside, near = trial, middle
    return far
