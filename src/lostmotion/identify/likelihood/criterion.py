"""The information criterion by which models are compared, everywhere."""

from __future__ import annotations

import math

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.noise_order import PENALTY
from lostmotion.identify.likelihood.remembered import remembered

FLOOR = 1e-26  # variance of scaled residuals that is rounding
SMALLEST = 1e-300  # keeps the logarithm of a perfect fit finite


def log_densities(errors: FloatArray, variance: float) -> FloatArray:
    """Of scaled errors, up to a constant; finite where a record without noise is fitted exactly."""
    known = max(variance, FLOOR)
    return np.asarray(-0.5 * (np.log(known) + errors**2 / known))


def cost_of_parameters(fitted: Fitted, rows: int) -> float:
    """What the parameters cost: log n each (BIC); coefficients of D(q) as where their number is chosen (Akaike)."""
    s = fitted.problem.structure
    p = s.noise_order
    return float((fitted.parameters - p + s.zeros) * math.log(rows) + PENALTY * p)


def criterion(fitted: Fitted, floor: float = SMALLEST) -> float:
    """Bayesian information criterion of fits to the same rows; `floor` is the smallest variance that is not rounding.

    It counts from a variance of 1 / n, so fits to different numbers of rows are compared by ``per_row``.
    """
    n = fitted.problem.errors
    return float(n * math.log(max(fitted.fit.cost, n * floor))) + cost_of_parameters(fitted, n)


@remembered
def per_row(fitted: Fitted) -> float:
    """Information criterion for each row, counted from a variance of 1."""
    n = fitted.problem.errors
    return criterion(fitted, FLOOR) / n - float(math.log(n))


def cost_of_equal(fitted: Fitted, score: float) -> float:
    """Sum of squared errors with which a fit would have this criterion for each row."""
    n = fitted.problem.errors
    return math.exp(score + math.log(n) - cost_of_parameters(fitted, n) / n)


def gain_over_linear(fitted: Fitted, linear: Fitted) -> float:
    """BIC of the linear fit minus that of this one, per row, on the common number of rows."""
    if fitted is linear:
        return 0.0
    return min(fitted.problem.errors, linear.problem.errors) * (per_row(linear) - per_row(fitted))
