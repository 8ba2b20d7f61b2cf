"""Which kind of actuator? The gain in likelihood, less what the parameters cost, and how sure that comparison is.

As a second opinion every kind is fitted again without a quarter of the record at a time, from its fit to everything,
and predicts that quarter one step ahead. A small gain must be confirmed there. It does not decide more: a quarter of a
routine record often holds all that one parameter can be learned from, and on loops of known fault the likelihood names
more of them rightly.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.identify.actuators.kind import NEEDED, NO_FAULT, kind_of
from lostmotion.identify.likelihood.criterion import cost_of_parameters, log_densities
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.problem import Problem, Structure
from lostmotion.identify.likelihood.refinement import refine, with_states
from lostmotion.identify.scaled import ScaledData

# quarters: one holds set-point moves to be foretold, the others still tell the process (docs/method.md, "Left out")
FOLDS = 4
STEPS = 6  # of each refit: it starts at the fit to everything
FEWEST = 20  # rows of a fold beside what its start needs
CLEAR = 4.4  # of log-likelihood: a kind so much ahead has the better of 9 in 10
CONFIRMED = 12.0  # a smaller gain counts only where the rows left out are predicted better as well


@dataclass(frozen=True)
class KindChoice:
    """Comparison of the kinds.

    Attributes
    ----------
    best : str
        Kind with the largest likelihood; "none" unless a fault beats the linear model firmly by 3, and by 12 or in what
        was left out.
    gains : dict of float
        What was left out: log predictive density of each kind minus that of the linear model, all rows together.
    likelihoods : dict of float
        Gain in log-likelihood of each kind over the linear model, all rows that both predict, less what its parameters
        cost (information criterion).
    firm : dict of float
        The same, less where it rests on a few rows; of a dead zone over a healthy characteristic that bends, where that
        is likelier than a straight line.
    confidence : float
        Probability that `best` is right rather than the runner-up.
    runner_up : str
    excluded : dict of float
        Where the linear model is best, or a verdict may deny what is: the largest size of every kind that the record
        does not exclude (95 %), in units of OP; inf where a valve that never moves is as likely.
    """

    best: str
    gains: dict[str, float]
    likelihoods: dict[str, float]
    firm: dict[str, float]
    confidence: float
    runner_up: str
    excluded: dict[str, float] = field(default_factory=dict)

    @property
    def as_likely(self) -> list[str]:
        """Other faults that are not clearly less likely than the best, which may be preferred as it is simpler."""
        least = self.likelihoods[self.best] - CLEAR
        others = [kind for kind in self.likelihoods if kind not in (self.best, NO_FAULT)]
        return [kind for kind in others if self.likelihoods[kind] > least and self.firm[kind] > NEEDED]

    def ahead_of(self, name: str) -> tuple[str, float] | None:
        """The best fault and how far it is ahead of another kind; None where that is not firm."""
        ahead = self.likelihoods[self.best] - max(self.likelihoods.get(name, 0.0), 0.0)
        return None if self.best in (name, NO_FAULT) or ahead <= NEEDED else (self.best, ahead)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        return {
            "best": self.best,
            "gains": dict(self.gains),
            "likelihoods": dict(self.likelihoods),
            "firm": dict(self.firm),
            "confidence": self.confidence,
            "runner_up": self.runner_up,
            "excluded": {kind: float(size) if np.isfinite(size) else None for kind, size in self.excluded.items()},
        }


def choose_kind(data: ScaledData, candidates: dict[str, Fitted]) -> KindChoice:
    """Compare fits of several kinds, "none" among them; those that gain nothing drop out.

    Raises
    ------
    KeyError
        No linear model among the candidates.
    """
    linear = candidates[NO_FAULT]
    compared = {kind: likelihood_gain(fitted, linear) for kind, fitted in candidates.items()}
    likelihoods = {kind: gain for kind, (gain, _) in compared.items() if kind == NO_FAULT or gain > 0.0}
    gains = gains_left_out(data, {kind: candidates[kind] for kind in likelihoods})
    firm = {kind: _firm(candidates[kind], linear, compared[kind][1]) for kind in likelihoods}
    scores = {
        kind: gain
        for kind, gain in likelihoods.items()
        if firm[kind] > NEEDED and (gain > CONFIRMED or gains[kind] > 0.0)
    }
    scores[NO_FAULT] = NEEDED
    scores = {kind: kind_of(kind).handicapped(scores, candidates) for kind in scores}
    best, *others = sorted(scores, key=lambda kind: scores[kind], reverse=True)
    runner_up = others[0] if others else best
    return KindChoice(best, gains, likelihoods, firm, confidence_of(scores[best] - scores[runner_up]), runner_up)


def set_aside(choice: KindChoice, candidates: dict[str, Fitted], linear: Fitted) -> list[str]:
    """Faults that are seen beside a straight line, but not beside a healthy valve that bends or is slow."""
    aside = [kind for kind, gain in choice.firm.items() if kind != NO_FAULT and gain <= NEEDED]
    return [kind for kind in aside if likelihood_gain(candidates[kind], linear)[1] > NEEDED]


def _firm(fitted: Fitted, linear: Fitted, gain: float) -> float:
    """The firm gain of a fit; of one that is seen over the healthy characteristic that it may be mistaken for."""
    if gain <= NEEDED:
        return gain
    healthy = kind_of(fitted.problem.family.kind).healthy(fitted, linear)
    return gain if healthy is linear else likelihood_gain(fitted, healthy)[1]


def likelihood_gain(fitted: Fitted, linear: Fitted) -> tuple[float, float]:
    """Gain in log-likelihood over the linear model, less what the parameters cost; and what of it is firm.

    The gains of the rows of a model that is better by g in Gaussian noise have the sum g and the deviation sqrt(2 g).
    Where noise has long tails, or a disturbance struck a few times, theirs is larger, and g counts that much less
    (in the spirit of Vuong, 1989, Econometrica 57; at equal false alarms it names more than g itself, or than the
    square of the sum over its deviation).
    """
    gained = _log_densities(fitted) - _log_densities(linear)
    gained = gained[np.isfinite(gained)]
    cost = 0.5 * (cost_of_parameters(fitted, gained.size) - cost_of_parameters(linear, gained.size))
    total, firm = total_and_firm(gained)
    return total - cost, firm - cost


def total_and_firm(gained: FloatArray) -> tuple[float, float]:
    """Sum of gains in log density (n,), and what of it does not rest on a few rows."""
    total = float(gained.sum())
    if total <= 0.0:
        return total, total
    return total, total * min(1.0, float(np.sqrt(2.0 * total / max(gained.size * gained.var(), 1e-300))))


def _log_densities(fitted: Fitted) -> FloatArray:
    """Of every row, up to a constant; NaN where a segment begins."""
    problem = fitted.problem
    found = np.full(problem.u.size, np.nan)
    parts = problem.predict(fitted.fit.theta)[1]
    for (start, stop), errors in zip(problem.segments.tolist(), parts, strict=True):
        found[start + problem.structure.start : stop] = log_densities(errors, fitted.variance)
    return found


def confidence_of(ahead: float) -> float:
    """Probability of the better of two kinds.

    Two models of equal prior would give 1 / (1 + exp(-ahead)). But the best of many places and structures was taken
    for each; on loops of known fault half of the difference is what it is worth.
    """
    return float(1.0 / (1.0 + np.exp(-0.5 * ahead)))


def gains_left_out(data: ScaledData, candidates: dict[str, Fitted]) -> dict[str, float]:
    """Log predictive density of what is left out, of each kind over the linear model."""
    start = max(one.problem.structure.start for one in candidates.values())
    densities = {kind: _left_out(data, one, start) for kind, one in candidates.items()}
    return {kind: float((values - densities[NO_FAULT]).sum()) for kind, values in densities.items()}


def _left_out(data: ScaledData, fitted: Fitted, start: int) -> FloatArray:
    """Log predictive density of every row that is left out once; a record too short for that says 0."""
    s = fitted.problem.structure
    structure = replace(s, start=max(start, s.delay + s.noise_order))
    pieces = pieces_of(data.segments, structure.start + FEWEST)
    found = []
    for fold in range(FOLDS):
        mine = np.arange(len(pieces)) % FOLDS == fold
        if not mine.any() or mine.all():
            continue
        theta, variance = refitted(fitted, structure, pieces[~mine])
        errors = predicted(fitted, structure, pieces[mine], theta)
        found.append(log_densities(errors, variance))
    if not found:
        return np.zeros(1)
    densities = np.concatenate(found)
    family = fitted.problem.family
    held = len(family.names) - len(family.own) * (not family.kinks)
    paid = kind_of(family.kind).searched + held + family.sought
    return np.asarray(densities - paid / densities.size)


def pieces_of(segments: IntArray, shortest: int) -> IntArray:
    """Segments cut into pieces, FOLDS or more in all."""
    longest = max(int((segments[:, 1] - segments[:, 0]).sum()) // FOLDS, 2 * shortest)
    cuts = []
    for start, stop in segments:
        number = max(round((stop - start) / longest), 1)
        edges = np.linspace(start, stop, number + 1).astype(np.int64)
        cuts += [(a, b) for a, b in pairwise(edges) if b - a >= shortest]
    return np.array(cuts)


def _on(fitted: Fitted, structure: Structure, pieces: IntArray) -> Problem:
    problem = fitted.problem
    return replace(problem, segments=pieces, structure=structure)


def refitted(fitted: Fitted, structure: Structure, pieces: IntArray) -> tuple[FloatArray, float]:
    """Shared parameters without the fold, and the residual variance there."""
    problem = _on(fitted, structure, pieces)
    shared = fitted.fit.theta[: problem.initial_at]
    theta = np.concatenate([shared, np.zeros(problem.size - shared.size)])
    theta = with_states(problem, theta)
    # what is known, an offset of zero or a ratio of slopes of one,
    held = [] if fitted.basis is None else np.flatnonzero(~fitted.basis[: problem.initial_at].any(axis=1)).tolist()
    # and what would be caught between jumps in a few steps, or acts in one fold only: held, and paid for in `_left_out`
    held += range(problem.eta_at + len(problem.family.own) * (not problem.family.kinks), problem.noise_at)
    fit = refine(problem, theta, problem.free_but(held), most_steps=STEPS, tied=True)
    return fit.theta[: problem.initial_at], fit.cost / problem.errors


def predicted(fitted: Fitted, structure: Structure, pieces: IntArray, shared: FloatArray) -> FloatArray:
    """Prediction errors of the fold; only its initial states are fitted, and its level: disturbances drift."""
    problem = _on(fitted, structure, pieces)
    theta = np.concatenate([shared, np.zeros(problem.size - shared.size)])
    level = () if structure.integrating else (problem.offset_at,)
    return np.concatenate(problem.predict(with_states(problem, theta, level))[1])
