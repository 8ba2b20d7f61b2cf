"""Kinds compared by free simulation: what one-step predictions forgive, a simulation from OP alone does not.

One-step predictions with a rich model of the noise hardly see a process that is wrong over long horizons, and on fast
samples they name whatever that process lacks most: four motors with a dead zone of 12 % were called backlash at 2 and
20 ms. In open loop the output error is consistent whatever the noise is, so it beats a model that is right on held-out
rows by chance only, and finds the same size (Hausman, 1978, Econometrica 46). Where it is clearly better, or finds
another size, it is taken. Its residuals are coloured: intervals count them by blocks (quasi-likelihood).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.identify.actuators.break_away import broken_away
from lostmotion.identify.actuators.choice import (
    FOLDS,
    KindChoice,
    confidence_of,
    pieces_of,
    predicted,
    refitted,
)
from lostmotion.identify.actuators.directional_lag import of_first_order
from lostmotion.identify.actuators.fit_kind import fit_linear
from lostmotion.identify.actuators.in_place import placed
from lostmotion.identify.actuators.kind import NEEDED, NO_FAULT, Kind, faults
from lostmotion.identify.actuators.loads import without_loads
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.parameters import information_inverse
from lostmotion.identify.likelihood.refinement import MOST_STEPS, refine, with_states
from lostmotion.identify.named_estimate import NamedEstimate
from lostmotion.identify.scaled import ScaledData

STARTS, ROUGH_STEPS = 3, 8  # of each kind that are refined, the best of its whole range after a few steps
NEARLY = 0.01  # variances: what ten steps must gain; coloured residuals leave long flat valleys
LEAST_GAIN = 0.04  # of the sum of squared errors: less is not worth another model
LIKELIER = 2.0  # of log-likelihood over a healthy valve: one standard error, beside the CLEAR gain over all predictions
CLEAR = 8.0  # of log-likelihood over the fit by predictions: two standard errors over blocks of held-out rows
SURE = 2.0  # standard errors of a difference of sizes
LEAST_SHARE = 0.25  # of its variance that a difference has, where the estimates nearly have the same
BLOCKS = 20  # of a record, in which errors are added up: each longer than errors are correlated
FEWEST_ROWS = 20  # of a piece, as of any fold
SMALLEST = 1e-9  # of the variance by blocks, which that of single rows is not below but by rounding
HUGE = 1e100  # errors beyond it are no worse
STEP = 1e-5  # of a scaled parameter, for derivatives of the errors


@dataclass(frozen=True)
class Simulated:
    """The kinds by their output error.

    Attributes
    ----------
    fits : dict of Fitted
        Of each kind, "none" among them, with the dispersion of its coloured residuals.
    kinds : KindChoice
        By held-out rows, each simulated from OP alone.
    clear : bool
        Whether the best kind simulates them clearly better than the fit by one-step predictions does.
    """

    fits: dict[str, Fitted]
    kinds: KindChoice
    clear: bool


def simulated(
    data: ScaledData,
    asked: Asked,
    linear: Fitted,
    chosen: Fitted,
    found: dict[str, Fitted],
    doubted: bool,
) -> Simulated | None:
    """The kinds by free simulation, where an output error may be clearly smaller than that of `chosen`.

    Parameters
    ----------
    data : ScaledData
        Of an open loop: in a closed one the output error is not consistent.
    asked : Asked
    linear, chosen : Fitted
        By one-step predictions.
    found : dict of Fitted
        Fits of other kinds by one-step predictions: starts beside those of a search.
    doubted : bool
        Whether the residuals of `chosen` are known to hold more.
    """
    compared = {kind.name: kind for kind in faults() if not kind.family.needles}
    near = [chosen, *(found[name] for name in compared if name in found)]
    mine = without_noise(chosen)
    if not doubted and min(_cost(output_error(one)) for one in near) > (1.0 - LEAST_GAIN) * _cost(mine):
        return None
    white = replace(asked, noise=0, integrating=linear.problem.structure.integrating)
    plain = min(output_error(without_loads(linear)), fit_linear(data, white), key=_cost)
    first, fits = of_first_order(plain), {NO_FAULT: plain}
    for name, kind in compared.items():
        starts = [found[name].actuator] if name in found else []
        simple = [searched(first, kind, data, starts)] if first is not None else []
        both = [searched(plain, kind, data, [*starts, *(one.actuator for one in simple)]), *simple]
        fits[name] = dispersed(broken_away(min(both, key=lambda one: (one.drifts(data.longest), one.fit.cost))))
    longest = max(one.problem.structure.start for one in [mine, *fits.values()])
    pieces = pieces_of(data.segments, longest + FEWEST_ROWS)
    if len(pieces) < FOLDS:
        return None
    held_out = {name: _held_out(pieces, one, refit=True) for name, one in fits.items()}
    best = min(held_out, key=lambda name: float(held_out[name].sum()))
    predicted_best = chosen.problem.family.kind
    if predicted_best in fits and _gain(held_out[predicted_best], held_out[best]) < NEEDED:
        best = predicted_best  # as good: what predicts best decides
    healthy = plain if best == NO_FAULT else compared[best].healthy(fits[best], plain)
    if _gain(_held_out(pieces, healthy, refit=True), held_out[best]) < LIKELIER:
        best = NO_FAULT
    before, after = _held_out(pieces, mine, refit=False), held_out[best]
    clear = bool(before.sum() - after.sum() > LEAST_GAIN * before.sum() and _gain(before, after) > CLEAR)
    return Simulated(fits, _choice(held_out, best), clear)


def another_size(efficient: NamedEstimate, consistent: NamedEstimate, kind: Kind) -> bool:
    """Whether a size by one-step predictions differs from that by free simulation by more than chance does.

    Hausman's test: the variance of the difference is that of the consistent estimate less that of the efficient one.
    """
    if kind.size is None:
        return False
    (a, b), (s, t) = (
        [one.parameters[kind.size] for one in (efficient, consistent)],
        [one.standard_errors[kind.size] for one in (efficient, consistent)],
    )
    spread = np.sqrt(max(t**2 - s**2, LEAST_SHARE * t**2))
    return bool(abs(b - a) > SURE * spread)


def without_noise(fitted: Fitted) -> Fitted:
    """The same parameters without a model of the noise, with the best initial states; not refined."""
    problem = fitted.problem
    s = problem.structure
    plain = replace(problem, structure=replace(s, noise_order=0, zero=0.0, c=(), start=s.first), early=0.0)
    states = plain.size - plain.initial_at
    theta = with_states(plain, np.concatenate([fitted.fit.theta[: problem.noise_at], np.zeros(states)]))
    basis = plain.basis
    if fitted.basis is not None:
        shared = fitted.basis[: problem.noise_at]
        shared = shared[:, np.any(shared != 0.0, axis=0)]
        basis = np.zeros((plain.size, shared.shape[1] + states))
        basis[: problem.noise_at, : shared.shape[1]] = shared
        basis[plain.initial_at :, shared.shape[1] :] = np.eye(states)
    cost, _, hessian = plain.evaluate(theta)
    return Fitted(plain, replace(fitted.fit, theta=theta, cost=cost, hessian=hessian), basis)


def output_error(fitted: Fitted) -> Fitted:
    """The same kind, refined by its output error."""
    return _refined(without_noise(fitted))


def searched(linear: Fitted, kind: Kind, data: ScaledData, also: Iterable[FloatArray]) -> Fitted:
    """A kind by its output error, from places over its whole range, and others, beside a linear model."""
    family = kind.forms(data)[0]
    begun = [placed(linear, form, own) for form, own in kind.glance(data)]
    begun += [placed(linear, family, own) for own in also]
    begun = sorted((_refined(one, ROUGH_STEPS) for one in begun), key=_cost)
    return min((_refined(one) for one in begun[:STARTS]), key=_cost)


def _refined(fitted: Fitted, steps: int = MOST_STEPS) -> Fitted:
    fit = refine(fitted.problem, fitted.fit.theta, fitted.basis, steps, tolerance=NEARLY)
    return replace(fitted, fit=fit)


def _cost(fitted: Fitted) -> float:
    return fitted.fit.cost


def dispersed(fitted: Fitted) -> Fitted:
    """With the variance that blocks of coloured residuals show beside that of single rows (sandwich estimate)."""
    problem, theta = fitted.problem, fitted.fit.theta
    errors = np.concatenate(problem.predict(theta)[1])
    slopes = np.empty((theta.size, errors.size))
    for index in range(theta.size):
        step = np.zeros(theta.size)
        step[index] = STEP
        ahead, behind = (np.concatenate(problem.predict(theta + sign * step)[1]) for sign in (1.0, -1.0))
        slopes[index] = (ahead - behind) / (2.0 * STEP)
    scores = np.array([part.sum(axis=1) for part in np.array_split(slopes * errors, BLOCKS, axis=1)])
    inverse, _ = information_inverse(fitted.fit.hessian, fitted.basis)
    robust, plain = np.diag(inverse @ (scores.T @ scores) @ inverse), np.diag(inverse) * fitted.variance
    own = np.array([*problem.own] or [*range(problem.structure.na)], np.int64)
    own = own[np.isfinite(robust[own]) & (plain[own] > SMALLEST * robust[own]) & (plain[own] > 0.0)]
    return replace(fitted, dispersion=max([1.0, *(robust[own] / plain[own]).tolist()]))


def _held_out(pieces: IntArray, fitted: Fitted, refit: bool) -> FloatArray:
    """Sums of squared simulation errors in BLOCKS of rows, each held out once."""
    structure, found = fitted.problem.structure, list[FloatArray]()
    for fold in range(FOLDS):
        mine = np.arange(len(pieces)) % FOLDS == fold
        theta = refitted(fitted, structure, pieces[~mine])[0] if refit else fitted.fit.theta
        errors = predicted(fitted, structure, pieces[mine], theta[: fitted.problem.initial_at])
        squares = np.clip(np.nan_to_num(errors, nan=HUGE), -HUGE, HUGE) ** 2  # what is unstable elsewhere
        found += [part.sum() for part in np.array_split(squares, BLOCKS // FOLDS)]
    return np.array(found)


def _gain(worse: FloatArray, better: FloatArray) -> float:
    """Gain in log-likelihood that sums of squares in blocks show: a gain g of it has the deviation sqrt(2 g)."""
    gain = worse - better
    error = float(gain.std(ddof=1)) / np.sqrt(gain.size)
    sure = float(gain.mean()) / max(error, 1e-300)
    return float(2.0 * sure * abs(sure))


def _choice(held_out: dict[str, FloatArray], best: str) -> KindChoice:
    """By gains in log-likelihood."""
    ahead = {name: _gain(held_out[NO_FAULT], squares) for name, squares in held_out.items()}
    likelihoods = {name: gain for name, gain in ahead.items() if name == NO_FAULT or gain > 0.0}
    scores = {**likelihoods, NO_FAULT: NEEDED}
    others = sorted((name for name in scores if name != best), key=lambda name: scores[name], reverse=True)
    runner_up = others[0] if others else best
    return KindChoice(best, ahead, likelihoods, likelihoods, confidence_of(scores[best] - scores[runner_up]), runner_up)
