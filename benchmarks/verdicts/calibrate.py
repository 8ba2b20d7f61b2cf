"""Weights of evidence: simulated loops as the prior, labelled real loops as the data.

A logistic regression on simulated loops says what each piece of evidence is worth where the model is right. Real loops
then move these weights as far as they can tell otherwise: a second logistic regression whose ridge pulls towards the
first. Every physical loop counts once, however many runs of it there are. No label of a real loop names a dead zone or
counts the healthy ones among those that saturate, so the weights of these two remain those of simulated loops.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize

from lostmotion.diagnose.weights import NAMES
from verdicts.cases import Row

Array = npt.NDArray[np.float64]
RIDGE = 0.1  # on weights of standardised features; the constant is free
PULL = 4.0  # of the prior on standardised weights; from 3 to 15 neither real loops left out nor simulated ones differ
FROM_SIMULATION = ("dead_zone", "saturation")
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
NOT_NEGATIVE = ("dead_zone", "memory", "saturation", "shape")  # more of it never speaks for a sound actuator
LEARNT = np.array([name not in FROM_SIMULATION for name in NAMES])


@dataclass(frozen=True)
class Weights:
    """Log-odds of a fault: constant + sum of weight times feature."""

    constant: float
    each: Array

    def chance(self, features: Array) -> Array:
        """Probability of a fault, for rows of features."""
        return np.asarray(1.0 / (1.0 + np.exp(-(self.constant + features @ self.each))))

    def as_code(self) -> str:
        """The lines of ``diagnose/weights.py``."""
        return f"CONSTANT = {self.constant:.2f}\nWEIGHTS = ({', '.join(f'{value:.2f}' for value in self.each)})"


def of_simulated(rows: list[Row]) -> Weights:
    """By simulated loops alone. Faults that the record cannot show are left out."""
    used = [row for row in rows if row.features and (row.truth in SOUND or row.visible)]
    counts = Counter(row.truth for row in used)
    weight = np.array([PREVALENCE[row.truth] / counts[row.truth] for row in used]) * len(used)
    fault = np.array([row.truth not in SOUND for row in used], dtype=np.float64)
    return logistic(features_of(used), fault, weight, RIDGE, np.zeros(len(NAMES)))


def with_real(prior: Weights, rows: list[Row]) -> Weights:
    """The prior moved by real loops."""
    features = features_of(rows)[:, LEARNT]
    moved = logistic(features, sticks(rows), shares(rows), PULL, prior.each[LEARNT], LEARNT)
    each = prior.each.copy()
    each[LEARNT] = moved.each
    return Weights(moved.constant, each)


def without_simulated_part(features: Array) -> Array:
    """Features of real loops of which only labels of sticking speak."""
    return np.where(LEARNT, features, 0.0)


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


def logistic(
    features: Array,
    fault: Array,
    weight: Array,
    ridge: float,
    towards: Array,
    named: npt.NDArray[np.bool_] | None = None,
) -> Weights:
    """Logistic regression of `fault` (0 or 1), loops weighted, with a ridge towards given weights."""
    scale = np.where(features.std(axis=0) > 0, features.std(axis=0), 1.0)
    design = np.column_stack([np.ones(len(fault)), features / scale])
    centre = np.append(0.0, towards * scale)
    names = np.array(NAMES)[slice(None) if named is None else named]

    def loss(theta: Array) -> tuple[float, Array]:
        odds = design @ theta
        off = np.append(0.0, theta[1:] - centre[1:])
        value = float((weight * np.logaddexp(0.0, np.where(fault == 1.0, -odds, odds))).sum())
        gradient = design.T @ (weight * (1.0 / (1.0 + np.exp(-odds)) - fault)) + ridge * off
        return value + 0.5 * ridge * float(off @ off), gradient

    bounds = [(None, None), *((0.0, None) if name in NOT_NEGATIVE else (None, None) for name in names)]
    found = minimize(loss, centre, jac=True, method="L-BFGS-B", bounds=bounds).x
    return Weights(float(found[0]), np.asarray(found[1:] / scale))
