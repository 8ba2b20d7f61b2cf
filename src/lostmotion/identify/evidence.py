"""What speaks for the dead zone, and what the reader must know first."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.errors import Status
from lostmotion.identify.data import IdentificationData
from lostmotion.identify.likelihood.feedback import feedback
from lostmotion.identify.likelihood.noise_order import MOST_NOISE_LAGS, PENALTY, autoregressions
from lostmotion.identify.likelihood.search import Fitted, ScaledData
from lostmotion.identify.rated_estimate import Evidence

SIZE = {"dead zone": "width", "backlash": "width", "stiction": "band"}  # the parameter that says how bad it is
FLOOR = 1e-26  # variance of scaled residuals that is rounding
FEWEST_BEYOND = 20  # samples beyond a break point below which that side is not really visited
LARGEST_RATIO_ERROR = 0.6  # of the slope ratio: above it one side may have no slope at all, so no break point either


def _criterion(fitted: Fitted, floor: float) -> float:
    """Information criterion of the fit; `floor` is the rounding of the data.

    Noise coefficients count as they do where their number is chosen (Akaike), everything else as in BIC.
    """
    n = fitted.problem.errors
    p = fitted.problem.structure.noise_order
    return float(n * np.log(max(fitted.fit.cost / n, floor)) + (fitted.parameters - p) * np.log(n) + PENALTY * p)


def gain_over_linear(fitted: Fitted, linear: Fitted) -> float:
    """BIC of the linear fit minus that of this one, per row, on the common number of rows."""
    if fitted is linear:
        return 0.0
    n = min(fitted.problem.errors, linear.problem.errors)
    return n * (_criterion(linear, FLOOR) / linear.problem.errors - _criterion(fitted, FLOOR) / fitted.problem.errors)


def weigh(
    scaled: ScaledData,
    fitted: Fitted,
    linear: Fitted,
    values: dict[str, float],
    data: IdentificationData,
    noise: int | None,
) -> Evidence:
    """Compare the fit with the linear model and with PV alone, per row, on the common number of rows."""
    floor = FLOOR
    models, variances, rows = autoregressions(
        [scaled.y[start:stop] - scaled.y.mean() for start, stop in scaled.segments],
        MOST_NOISE_LAGS if noise is None else noise,
    )
    alone = min(
        float(np.log(max(value, floor)) + (np.log(rows) + PENALTY * d.size) / rows)
        for d, value in zip(models, variances, strict=True)
    )
    below = int(np.sum(data.u < values["left"])) if "left" in values else 0
    above = int(np.sum(data.u > values["right"])) if "right" in values else 0
    loop = feedback(scaled.u, scaled.y, scaled.segments)
    return Evidence(
        gain_over_linear(fitted, linear),
        min(fitted.problem.errors, linear.problem.errors) * (alone - _criterion(linear, floor) / linear.problem.errors),
        below,
        above,
        tuple(
            (data.u_centre + data.u_scale * float(eta[0]), data.u_centre + data.u_scale * float(eta[1]), behind)
            for eta, behind in (fitted.rivals if fitted.problem.family.kind == "dead zone" else ())
        ),
        loop.closed,
        loop.free,
    )


def _one_sided(evidence: Evidence, ratio: float, names: list[str], covariance: FloatArray) -> bool:
    """Whether one side of a dead zone was hardly visited, or what was seen of it may be nothing."""
    at = names.index("slope_ratio")
    unsure = bool(np.sqrt(covariance[at, at]) > LARGEST_RATIO_ERROR * ratio)
    return unsure or min(evidence.samples_left, evidence.samples_right) < FEWEST_BEYOND


def decide(
    fitted: Fitted,
    evidence: Evidence,
    coloured: bool,
    misfit: bool,
    values: dict[str, float],
    covariance: FloatArray,
) -> Status:
    """First thing that the reader must know."""
    if evidence.gain_over_no_input + max(evidence.gain_over_linear, 0.0) <= 0:
        return Status.CANNOT_TELL
    kind = fitted.problem.family.kind
    if kind == "saturation" and evidence.gain_over_linear <= 0:
        return Status.NOT_SEEN
    if kind in SIZE:
        size, names = values[SIZE[kind]], list(values)
        error = float(np.sqrt(covariance[names.index(SIZE[kind]), names.index(SIZE[kind])]))
        reach = 1.96 * error if np.isfinite(error) else 1e-9 * abs(values.get("right", size))  # collapsed
        if evidence.gain_over_linear <= 0 or size <= reach:
            return Status.NOT_SEEN
        if not np.isfinite(error):
            return Status.CANNOT_TELL
        if not fitted.fit.converged:
            return Status.NOT_CONVERGED
        if kind == "dead zone" and _one_sided(evidence, values["slope_ratio"], names, covariance):
            return Status.ONE_SIDED
    if not fitted.fit.converged:
        return Status.NOT_CONVERGED
    if misfit:
        return Status.MISFIT
    return Status.COLOURED if coloured else Status.OK
