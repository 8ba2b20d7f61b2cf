"""Last steps on a likelihood with jumps, and intervals from its profile.

Where a change of width moves a break-away by one sample, the likelihood jumps: gradients end nearby, not at, the
maximum, and the curvature says too little about the interval. A pattern search finishes, and the interval is where
the profile likelihood falls by 1.92 (Wilks), over a mesh of a tenth of it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.distributions import chi2_quantile
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.refinement import LocalFit, refine

FIRST_STEP = 0.08  # of the largest actuator parameter
HALVINGS = 6  # of FIRST_STEP: to a thousandth of the size (0.08 / 64)
MOST_MOVES = 8  # with one step length
STEPS = 4  # of the rest of the model at each trial
LEVEL = 0.95  # of the profile intervals: the likelihood falls by 1.92 (docs/method.md, "Intervals")
GROWTH = 1.5  # of each step outwards: a needle of the likelihood is not stepped over at once
MISSES = 3  # rejections in a row that end the walk
BISECTIONS = 5  # of the last step: the end to a thirtieth of it
MOST_SEGMENTS = 10  # whose rests are sought: with more, each tells little and costs as much
COARSE_RESTS = (1.0, 0.5, 0.25, 0.12)  # steps of the rest, in halves of the band
# steps of the rest in halves of the band, as COARSE_RESTS, finer and finer once the actuator itself is placed
FINE_RESTS = (0.25, 0.12, 0.06, 0.03, 0.015, 0.008, 0.004, 0.002, 0.001)
FIRST_REACH = 0.003  # of the range of OP: the first move away from the optimum


def polished(fitted: Fitted) -> Fitted:
    """Pattern search over the actuator, everything else refined with it."""
    names = _own(fitted)
    if not names:
        return fitted
    fitted = rested(fitted)
    best = fitted.fit
    step = FIRST_STEP * max(float(np.abs(_eta(fitted, best)[: len(names)]).max()), 1e-3)
    directions = [np.eye(len(names))[i] * sign for i in range(len(names)) for sign in (1.0, -1.0)]
    if len(names) == 2:
        directions += [np.array(move) for move in ((1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0))]
    for _ in range(HALVINGS):
        for _ in range(MOST_MOVES):
            trials = [_moved(fitted, best, step * direction) for direction in directions]
            winner = min(trials, key=lambda trial: trial.cost)
            if not winner.cost < best.cost:
                break
            best = winner
        step *= 0.5
    return rested(replace(fitted, fit=replace(best, converged=True)), FINE_RESTS)


def rested(fitted: Fitted, reaches: tuple[float, ...] = COARSE_RESTS) -> Fitted:
    """The rest of the valve at the beginning of each segment, by the likelihood; the actuator itself is held."""
    family = fitted.problem.family
    if not 0 < family.resting <= MOST_SEGMENTS:
        return fitted
    held = _without(fitted, list(range(len(_own(fitted)))))
    rests = [*family.rests, *[0.0] * (family.resting - len(family.rests))]
    for index in range(len(rests)):
        for reach in reaches:
            for moved in (rests[index] + reach, rests[index] - reach):
                if abs(moved) > 1.0:
                    continue
                other = family.with_rests([*rests[:index], moved, *rests[index + 1 :]])
                problem = replace(fitted.problem, family=other)
                trial = refine(problem, fitted.fit.theta, held, most_steps=STEPS, tied=True)
                if trial.cost < fitted.fit.cost:
                    fitted = replace(fitted, problem=problem, fit=replace(trial, converged=fitted.fit.converged))
                    rests[index] = moved
                    break
    return fitted


def profile_intervals(fitted: Fitted) -> dict[str, tuple[float, float]]:
    """95 % intervals of the actuator parameters (scaled units); an end that is never rejected is infinite."""
    rise = chi2_quantile(LEVEL, 1) * fitted.variance
    return {
        name: (profile_end(fitted, index, -1.0, rise, _held), profile_end(fitted, index, 1.0, rise, _held))
        for index, name in enumerate(_own(fitted))
    }


Held = Callable[[Fitted, LocalFit, int, float], LocalFit | None]


def profile_end(fitted: Fitted, index: int, sign: float, rise: float, held: Held) -> float:
    """Where the profile has risen for good, on one side.

    Parameters
    ----------
    fitted : Fitted
    index : int
        Of the actuator's parameter.
    sign : float
        -1 or 1: which side.
    rise : float
        Of the sum of squares.
    held : callable
        Best fit with this parameter at a value, begun at a fit near it; None outside the valid set.
    """
    best, limit = fitted.fit, fitted.fit.cost + rise
    here = float(_eta(fitted, best)[index])
    span = float(np.ptp(fitted.problem.u))
    inside, outside, reach, misses = 0.0, 0.0, FIRST_REACH * span, 0
    last = start = best
    while misses < MISSES:  # with jumps the first rejection need not be the last
        trial = held(fitted, last, index, here + sign * reach)
        if trial is None or reach > span:
            if misses == 0:
                return 0.0 if sign < 0 else float(np.inf)
            break
        if trial.cost > limit:
            outside = reach if misses == 0 else outside
            misses += 1
        else:
            inside, last, start, misses = reach, trial, trial, 0
        reach *= GROWTH
    last = start
    for _ in range(BISECTIONS):
        middle = 0.5 * (inside + outside)
        trial = held(fitted, last, index, here + sign * middle)
        if trial is None or trial.cost > limit:
            outside = middle
        else:
            inside = middle
    return here + sign * outside if fitted.problem.family.places else max(here + sign * outside, 0.0)


def _held(fitted: Fitted, start: LocalFit, index: int, value: float) -> LocalFit | None:
    """Best fit with one actuator parameter at a value; None outside the valid set."""
    eta = _eta(fitted, start).copy()
    eta[index] = value
    if abs(fitted.problem.family.project(eta)[index] - value) > 1e-9 * (1.0 + abs(value)):
        return None
    theta = start.theta.copy()
    theta[fitted.problem.eta_at : fitted.problem.noise_at] = eta
    names = _own(fitted)
    best = refine(fitted.problem, theta, _without(fitted, [index]), most_steps=2 * STEPS, tied=True)
    if len(names) < 2:
        return best
    own = range(len(names))
    step = FIRST_STEP * max(float(np.abs(eta[: len(names)]).max()), 1e-3)
    for _ in range(2):
        for other, sign in ((other, sign) for other in own if other != index for sign in (1.0, -1.0)):
            moved = best.theta.copy()
            moved[fitted.problem.eta_at + other] += sign * step
            if not _valid(fitted, moved):
                continue
            trial = refine(fitted.problem, moved, _without(fitted, [*own]), most_steps=STEPS, tied=True)
            best = trial if trial.cost < best.cost else best
        step *= 0.5
    return best


def _moved(fitted: Fitted, start: LocalFit, move: FloatArray) -> LocalFit:
    """The actuator moved, the rest refined."""
    theta = start.theta.copy()
    at = fitted.problem.eta_at
    theta[at : at + move.size] += move
    theta = fitted.problem.project(theta)
    return refine(fitted.problem, theta, _without(fitted, list(range(move.size))), most_steps=STEPS, tied=True)


def _without(fitted: Fitted, held: list[int]) -> FloatArray:
    """Free directions but for some actuator parameters."""
    return fitted.problem.free_but([fitted.problem.eta_at + index for index in held], fitted.basis)


def _valid(fitted: Fitted, theta: FloatArray) -> bool:
    return bool(np.allclose(fitted.problem.project(theta), theta, rtol=0.0, atol=1e-12))


def _own(fitted: Fitted) -> list[str]:
    """Names of the actuator's parameters."""
    return list(fitted.problem.family.own)


def _eta(fitted: Fitted, fit: LocalFit) -> FloatArray:
    return fit.theta[fitted.problem.eta_at : fitted.problem.noise_at]
