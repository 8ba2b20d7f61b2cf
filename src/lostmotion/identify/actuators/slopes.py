"""Are both slopes of a dead zone equal? Most are, and a side that is hardly visited cannot tell its own."""

from __future__ import annotations

import numpy as np

from lostmotion.identify.likelihood.criterion import gain_over_linear
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.refinement import refine


def with_equal_slopes(fitted: Fitted) -> Fitted:
    """The dead zone of equal slopes, where that explains as much for a parameter less (information criterion).

    To compare kinds: where a quarter of the record is left out, a free ratio follows whatever is left of one side.
    """
    equal = equal_slopes(fitted)
    return equal if equal is not None and gain_over_linear(equal, fitted) >= 0.0 else fitted


def equal_slopes(fitted: Fitted) -> Fitted | None:
    """The dead zone refined with both slopes equal; None where they already are, or the kind has none."""
    problem = fitted.problem
    if "log_ratio" not in problem.family.own:
        return None
    column = problem.eta_at + problem.family.own.index("log_ratio")
    basis = np.eye(fitted.fit.theta.size) if fitted.basis is None else fitted.basis
    if not basis[column].any():
        return None
    basis = basis[:, basis[column] == 0.0]
    theta = fitted.fit.theta.copy()
    theta[column] = 0.0
    return Fitted(problem, refine(problem, theta, basis), basis, fitted.rivals)
