"""Which kind of actuator? Prediction of what was left out, and how sure that comparison is.

Every kind is fitted again without a quarter of the record at a time, from its fit to everything, and predicts that
quarter one step ahead. The kinds are compared by the logarithm of the Gaussian predictive density; the differences of
blocks of rows give the standard error, so that a choice which rests on a few rows counts as what it is.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import stats

from lostmotion.identify.batch import refine
from lostmotion.identify.evidence import gain_over_linear
from lostmotion.identify.problem import Problem, Structure
from lostmotion.identify.search import Fitted, ScaledData
from lostmotion.models._arguments import FloatArray

FOLDS = 4
STEPS = 6  # of each refit: it starts at the fit to everything
BLOCKS = 32
FEWEST = 20  # rows of a fold beside what its start needs
SMALLEST_SPREAD = 1.0  # of a difference of log densities: of two kinds that predict alike, neither is sure
# of log density, for parameters that are held at the best place found: about the logarithm of the number of places
SEARCHED = {"backlash": 2.5, "stiction": 7.5}
NEEDED_JUMP = 5.0  # by which stiction must beat backlash: its jump was sought as well
NEEDED_NO_JUMP, SMALLEST_JUMP = 15.0, 0.05  # the same where the jump is less than this share of the band
NEEDED_LIMITS = 5.0  # by which a saturation must beat a dead zone: u minus one is the other, and feedback lets u go
NEEDED = 3.0  # of log density, by which a fault must beat the linear model: 20 to 1


@dataclass(frozen=True)
class KindChoice:
    """Held-out comparison of the kinds.

    Attributes
    ----------
    best : str
        Kind with the largest predictive density; "none" unless a fault beats the linear model clearly.
    gains : dict of float
        Log predictive density of each kind minus that of the linear model, all left-out rows together.
    likelihoods : dict of float
        Half the information criterion of the linear model minus that of each kind: gain in log-likelihood with all
        rows, less what its parameters cost.
    confidence : float
        Probability that `best` predicts better than the runner-up, from blocks of rows.
    runner_up : str
    """

    best: str
    gains: dict[str, float]
    likelihoods: dict[str, float]
    confidence: float
    runner_up: str

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        return {
            "best": self.best,
            "gains": dict(self.gains),
            "likelihoods": dict(self.likelihoods),
            "confidence": self.confidence,
            "runner_up": self.runner_up,
        }


def choose_kind(data: ScaledData, candidates: dict[str, Fitted]) -> KindChoice:
    """Compare fits of several kinds, "none" among them, by what they predict of the rows left out.

    Raises
    ------
    KeyError
        No linear model among the candidates.
    """
    rows = min(fitted.problem.errors for fitted in candidates.values())
    start = max(fitted.problem.structure.start for fitted in candidates.values())
    densities = {kind: _left_out(data, fitted, start) for kind, fitted in candidates.items()}
    gains = {kind: float((values - densities["none"]).sum()) for kind, values in densities.items()}
    order = sorted(gains, key=lambda kind: gains[kind], reverse=True)
    best = order[0] if gains[order[0]] > NEEDED else "none"
    needed = NEEDED_NO_JUMP if best == "stiction" and _without_jump(candidates[best]) else NEEDED_JUMP
    if best == "stiction" and gains[best] - gains.get("backlash", -np.inf) < needed:
        best = "backlash"  # stiction without a jump: the simpler one of two that do as well
        order.remove("stiction")
    if best == "saturation" and gains[best] - gains.get("dead zone", -np.inf) < NEEDED_LIMITS:
        best = "dead zone"
        order.remove("saturation")
    runner_up = next((kind for kind in order if kind != best), best)
    likelihoods = {kind: 0.5 * gain_over_linear(fitted, candidates["none"]) for kind, fitted in candidates.items()}
    return KindChoice(best, gains, likelihoods, _confidence(densities[best] - densities[runner_up], rows), runner_up)


def _without_jump(fitted: Fitted) -> bool:
    """Whether stiction was fitted that is backlash to all purposes."""
    band, jump = fitted.fit.theta[fitted.problem.eta_at :][:2]
    return bool(jump < SMALLEST_JUMP * band)


def _confidence(differences: FloatArray, rows: int) -> float:
    """Probability that the sum is positive, from the spread of blocks."""
    parts = np.array([block.sum() for block in np.array_split(differences, min(BLOCKS, max(rows // 10, 2)))])
    spread = np.hypot(float(parts.std(ddof=1)) * np.sqrt(parts.size), SMALLEST_SPREAD)
    return float(stats.norm.cdf(parts.sum() / spread))


def _left_out(data: ScaledData, fitted: Fitted, start: int) -> FloatArray:
    """Log predictive density of every row that is left out once."""
    s = fitted.problem.structure
    structure = Structure(s.na, s.nb, s.delay, s.noise_order, max(start, s.delay + s.noise_order), s.integrating)
    pieces = _pieces(data.segments, structure.start + FEWEST)
    found = []
    for fold in range(FOLDS):
        mine = np.arange(len(pieces)) % FOLDS == fold
        if not mine.any() or mine.all():
            continue
        theta, variance = _refitted(fitted, structure, pieces[~mine])
        errors = _predicted(fitted, structure, pieces[mine], theta)
        found.append(-0.5 * (np.log(variance) + errors**2 / variance))
    densities = np.concatenate(found)
    family = fitted.problem.family
    held = len(family.names) - len(family.own) * (not family.kinks)
    paid = SEARCHED.get(family.kind, 0.0) + held + family.sought
    return np.asarray(densities - paid / densities.size)


def _pieces(segments: npt.NDArray[np.int64], shortest: int) -> npt.NDArray[np.int64]:
    """Segments cut into pieces, FOLDS or more in all."""
    longest = max(int((segments[:, 1] - segments[:, 0]).sum()) // FOLDS, 2 * shortest)
    cuts = []
    for start, stop in segments:
        number = max(round((stop - start) / longest), 1)
        edges = np.linspace(start, stop, number + 1).astype(np.int64)
        cuts += [(a, b) for a, b in pairwise(edges) if b - a >= shortest]
    return np.array(cuts)


def _on(fitted: Fitted, structure: Structure, pieces: npt.NDArray[np.int64]) -> Problem:
    problem = fitted.problem
    return replace(problem, segments=pieces, structure=structure)


def _refitted(fitted: Fitted, structure: Structure, pieces: npt.NDArray[np.int64]) -> tuple[FloatArray, float]:
    """Shared parameters without the fold, and the residual variance there."""
    problem = _on(fitted, structure, pieces)
    shared = fitted.fit.theta[: problem.initial_at]
    theta = np.concatenate([shared, np.zeros(problem.size - shared.size)])
    theta = refine(problem, theta, _initial_only(problem), most_steps=2, tied=True).theta
    basis = np.eye(problem.size) if problem.basis is None else problem.basis
    held = [problem.eta_at - 1] if fitted.basis is not None else []  # an offset that is known to be zero
    # what would be caught between jumps in a few steps, or acts in one fold only, is held, and paid for in `_left_out`
    held += range(problem.eta_at + len(problem.family.own) * (not problem.family.kinks), problem.noise_at)
    basis = basis[:, ~np.any(basis[held] != 0.0, axis=0)]
    fit = refine(problem, theta, basis, most_steps=STEPS, tied=True)
    return fit.theta[: problem.initial_at], fit.cost / problem.errors


def _predicted(fitted: Fitted, structure: Structure, pieces: npt.NDArray[np.int64], shared: FloatArray) -> FloatArray:
    """Prediction errors of the fold; only its initial states are fitted."""
    problem = _on(fitted, structure, pieces)
    theta = np.concatenate([shared, np.zeros(problem.size - shared.size)])
    theta = refine(problem, theta, _initial_only(problem), most_steps=2, tied=True).theta
    return np.concatenate(problem.predict(theta)[1])


def _initial_only(problem: Problem) -> FloatArray:
    return np.eye(problem.size)[:, problem.initial_at :]
