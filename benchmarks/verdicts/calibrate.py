"""Weights of evidence: multinomial logistic regression with a ridge, on simulated loops only."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize

from lostmotion.diagnose.weights import CLASSES
from verdicts.cases import Row

Array = npt.NDArray[np.float64]
RIDGE = 1.0  # on weights of standardised features; the constants are free
CLASS_OF = {
    "none": "none",
    "tuning": "none",
    "disturbance": "none",
    "dead zone": "dead zone",
    "backlash": "sticking",
    "stiction": "sticking",
    "saturation": "saturation",
}


def calibrated(rows: list[Row], left_out: tuple[int, ...] = ()) -> Array:
    """Weights, shape (classes, 1 + features); features in `left_out` get none. Faults that cannot be seen are left out.

    The first class has no weights of its own: only differences count.
    """
    used = [row for row in rows if row.features and (CLASS_OF[row.truth] == "none" or row.visible)]
    features = np.array([row.features for row in used])
    features[:, list(left_out)] = 0.0
    scale = np.where(features.std(axis=0) > 0, features.std(axis=0), 1.0)
    design = np.column_stack([np.ones(len(used)), features / scale])
    target = np.array([CLASSES.index(CLASS_OF[row.truth]) for row in used])
    shape = (len(CLASSES) - 1, design.shape[1])

    def loss(flat: Array) -> tuple[float, Array]:
        weights = np.vstack([np.zeros(shape[1]), flat.reshape(shape)])
        scores = design @ weights.T
        scores -= scores.max(axis=1, keepdims=True)
        chances = np.exp(scores)
        chances /= chances.sum(axis=1, keepdims=True)
        miss = chances.copy()
        miss[np.arange(target.size), target] -= 1.0
        penalty = RIDGE * weights[1:, 1:]
        gradient = miss.T @ design
        gradient[1:, 1:] += penalty
        value = -np.log(np.maximum(chances[np.arange(target.size), target], 1e-300)).sum()
        return float(value + 0.5 * (penalty * weights[1:, 1:]).sum()), gradient[1:].ravel()

    found = minimize(loss, np.zeros(shape[0] * shape[1]), jac=True, method="L-BFGS-B", options={"maxiter": 2000})
    weights = np.vstack([np.zeros(shape[1]), found.x.reshape(shape)])
    weights[:, 1:] /= scale
    return weights


def as_code(weights: Array) -> str:
    """The table of ``diagnose/weights.py``."""
    lines = ",\n".join("        [" + ", ".join(f"{value:.3f}" for value in row) + "]" for row in weights)
    return f"WEIGHTS = np.array(\n    [\n{lines},\n    ]\n)"
