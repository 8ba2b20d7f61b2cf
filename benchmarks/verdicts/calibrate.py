"""Weights of evidence: logistic regression with a ridge, on simulated loops only."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize

from lostmotion.diagnose.weights import NAMES
from verdicts.cases import Row

Array = npt.NDArray[np.float64]
RIDGE = 0.1  # on weights of standardised features; the constant is free
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


def calibrated(rows: list[Row]) -> tuple[float, Array]:
    """Constant and weights of the features. Faults that the record cannot show are left out."""
    used = [row for row in rows if row.features and (row.truth in SOUND or row.visible)]
    features = np.array([row.features for row in used])
    counts = {cause: sum(row.truth == cause for row in used) for cause in PREVALENCE}
    weight = np.array([PREVALENCE[row.truth] / counts[row.truth] for row in used]) * len(used)
    fault = np.array([row.truth not in SOUND for row in used], dtype=np.float64)
    return logistic(features, fault, weight)


def logistic(features: Array, fault: Array, weight: Array) -> tuple[float, Array]:
    """Constant and weights: logistic regression of `fault` (0 or 1) with a ridge, loops weighted."""
    scale = np.where(features.std(axis=0) > 0, features.std(axis=0), 1.0)
    design = np.column_stack([np.ones(len(fault)), features / scale])

    def loss(theta: Array) -> tuple[float, Array]:
        odds = design @ theta
        penalty = RIDGE * np.append(0.0, theta[1:])
        value = float((weight * np.logaddexp(0.0, np.where(fault == 1.0, -odds, odds))).sum())
        gradient = design.T @ (weight * (1.0 / (1.0 + np.exp(-odds)) - fault)) + penalty
        return value + 0.5 * float(penalty @ theta), gradient

    bounds = [(None, None), *((0.0, None) if name in NOT_NEGATIVE else (None, None) for name in NAMES)]
    found = minimize(loss, np.zeros(design.shape[1]), jac=True, method="L-BFGS-B", bounds=bounds).x
    return float(found[0]), np.asarray(found[1:] / scale)


def as_code(constant: float, weights: Array) -> str:
    """The lines of ``diagnose/weights.py``."""
    return f"CONSTANT = {constant:.2f}\nWEIGHTS = ({', '.join(f'{value:.2f}' for value in weights)})"
