"""Is the output offset zero? Records in deviations carry none, and knowing it sharpens the break points."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.parameters import information_inverse
from lostmotion.identify.likelihood.refinement import refine
from lostmotion.identify.scaled import Scaling

CENTRED = 1e-6  # a mean this small beside the deviation was subtracted: zero is then no physical zero


def without_column(size: int, column: int) -> FloatArray:
    """Basis of everything but one parameter."""
    return np.delete(np.eye(size), column, axis=1)


def settle_offset(fitted: Fitted, scaling: Scaling, choice: str) -> Fitted:
    """Fit with offset 0 where asked, or where the information criterion prefers it.

    With choice "auto" the offset is dropped if its t-ratio is below sqrt(log n) (BIC), OP = 0 lies inside the dead
    zone, and the record was not centred by subtracting its mean. "free" keeps it.
    """
    if choice == "free" or fitted.problem.structure.integrating:
        return fitted
    column = fitted.problem.offset_at
    zero = -scaling.y_centre / scaling.y_scale
    if choice == "auto":
        inverse, empty = information_inverse(fitted.fit.hessian)
        variance = fitted.variance * inverse[column, column]
        centred = abs(scaling.y_centre) < CENTRED * scaling.y_scale
        distance = (fitted.fit.theta[column] - zero) ** 2
        left, right = scaling.u_centre + scaling.u_scale * fitted.actuator[:2]
        if empty.size or centred or not left <= 0.0 <= right:
            return fitted
        if not distance < np.log(fitted.problem.errors) * variance:
            return fitted
        if fitted.fit.cost <= 1e-20 * float(fitted.problem.y @ fitted.problem.y):
            return fitted  # noise-free: nothing to gain
    basis = without_column(fitted.fit.theta.size, column)
    theta = fitted.fit.theta.copy()
    theta[column] = zero
    return Fitted(fitted.problem, refine(fitted.problem, theta, basis), basis, fitted.rivals)
