"""Weights of evidence: simulated loops say them, labelled real loops what they are worth.

Two logistic regressions on simulated loops, of valves that stick and of the other faults, each against sound loops, say
what each piece of evidence is worth where the model is right. A real loop is worse than its model, and how much less
its evidence is worth is one number, a discount on the log-odds of sticking, learned from labelled real loops; every
physical loop counts once, however many runs of it there are. No label of a real loop names a dead
zone or counts the healthy ones among those that saturate, so the weights of these two remain those of simulated loops.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize, minimize_scalar

from lostmotion.diagnose.weights import NAMES, OF_STICKING
from verdicts.cases import Row

Array = npt.NDArray[np.float64]
RIDGE = 0.1  # on weights of standardised features; the constant is free
STICKING = ("stiction", "backlash")
SOUND = ("none", "tuning", "disturbance")
# Shares of a plant's loops. About a third of the loops that need attention have a bad valve (the paper's introduction).
PREVALENCE = {
    "none": 0.30,
    "tuning": 0.15,
    "disturbance": 0.20,
    "stiction": 0.13,
    "backlash": 0.10,
    "dead zone": 0.07,
    "saturation": 0.05,
}


@dataclass(frozen=True)
class Weights:
    """Log-odds of a valve that sticks, and of another fault: constant + sum of weight times feature, of its own."""

    constants: tuple[float, float]
    each: Array

    def chance(self, features: Array) -> Array:
        """Probability that the valve sticks where there is no other fault, for rows of features."""
        return np.asarray(
            1.0 / (1.0 + np.exp(-(self.constants[0] + features[:, OF_STICKING] @ self.each[OF_STICKING])))
        )

    def as_code(self) -> str:
        """The lines of ``diagnose/weights.py``."""
        return f"CONSTANTS = ({_digits(self.constants)})\nWEIGHTS = ({_digits(self.each)})"


def _digits(numbers: Array | tuple[float, ...]) -> str:
    return ", ".join(f"{value:.2f}" for value in numbers)


def of_simulated(rows: list[Row]) -> Weights:
    """By simulated loops alone. Faults that the record cannot show are left out."""
    used = [row for row in rows if row.features and (row.truth in SOUND or row.visible)]
    counts = Counter(row.truth for row in used)
    weight = np.array([PREVALENCE[row.truth] / counts[row.truth] for row in used]) * len(used)
    sound, stuck = (np.array([row.truth in names for row in used]) for names in (SOUND, STICKING))
    features, each, constants = features_of(used), np.zeros(len(NAMES)), []
    for fault, own in ((stuck, OF_STICKING), (~stuck & ~sound, ~OF_STICKING)):
        here = sound | fault
        constant, each[own] = logistic(features[here][:, own], fault[here].astype(np.float64), weight[here], RIDGE)
        constants.append(constant)
    return Weights((constants[0], constants[1]), each)


def with_real(prior: Weights, rows: list[Row]) -> Weights:
    """The prior with its log-odds of sticking discounted as real loops show.

    Letting real loops move each weight as well, with a ridge of 16, 4 or 1 towards the discounted ones, made the Brier
    score of contributors left out worse: 0.121, 0.125, 0.130 for 0.120. A share of real loops whose evidence says
    nothing (0.09) beside a discount (0.82) named 51 of 60 visible valves that stick instead of 47, and was as good by
    Brier score (0.116), but of the real loops accused 4.1 instead of 1.1 were sound, for 1.1 more that stick.
    """
    odds = features_of(rows)[:, OF_STICKING] @ prior.each[OF_STICKING]
    side, weight = 2.0 * sticks(rows) - 1.0, shares(rows)

    def loss(discount: float) -> float:
        return float(weight @ np.logaddexp(0.0, -side * (prior.constants[0] + discount * odds)))

    discount = minimize_scalar(loss, bounds=(0.0, 1.0), method="bounded").x
    return Weights(prior.constants, np.where(OF_STICKING, prior.each * discount, prior.each))


def sticks(rows: list[Row]) -> Array:
    """1 where the label says so."""
    return np.array([row.truth == "stiction" for row in rows], dtype=np.float64)


def shares(rows: list[Row]) -> Array:
    """One for every physical loop, in equal parts for its runs."""
    counts = Counter((row.source, row.loop) for row in rows)
    return np.array([1.0 / counts[row.source, row.loop] for row in rows])


def features_of(rows: list[Row]) -> Array:
    """One row of features for each loop."""
    return np.array([row.features for row in rows])


def logistic(features: Array, fault: Array, weight: Array, ridge: float) -> tuple[float, Array]:
    """Constant and weights, none negative, of `fault` (0 or 1); loops weighted, a ridge on standardised weights."""
    scale = np.where(features.std(axis=0) > 0, features.std(axis=0), 1.0)
    design = np.column_stack([np.ones(len(fault)), features / scale])

    def loss(theta: Array) -> tuple[float, Array]:
        odds, off = design @ theta, np.append(0.0, theta[1:])
        value = float((weight * np.logaddexp(0.0, np.where(fault == 1.0, -odds, odds))).sum())
        gradient = design.T @ (weight * (1.0 / (1.0 + np.exp(-odds)) - fault)) + ridge * off
        return value + 0.5 * ridge * float(off @ off), gradient

    bounds = [(None, None), *((0.0, None) for _ in scale)]  # more of it never speaks for a sound actuator
    found = minimize(loss, np.zeros(design.shape[1]), jac=True, method="L-BFGS-B", bounds=bounds).x
    return float(found[0]), np.asarray(found[1:] / scale)
