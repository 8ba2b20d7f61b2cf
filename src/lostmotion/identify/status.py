"""What speaks for the actuator, and what the reader must know first."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.errors import Status
from lostmotion.identify.actuators.kind import NO_FAULT, Kind, kind_of
from lostmotion.identify.data import IdentificationData
from lostmotion.identify.evidence import Evidence, crossings
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.criterion import FLOOR, gain_over_linear, per_row
from lostmotion.identify.likelihood.feedback import feedback
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.noise_order import MOST_NOISE_LAGS, PENALTY, autoregressions
from lostmotion.identify.likelihood.remembered import remembered
from lostmotion.identify.scaled import ScaledData, Scaling
from lostmotion.identify.unseen_moves import beyond_unseen, may_be_settled

VAGUE = 0.5  # of the width: an inverse with a break point that is so little known may push more than it takes away


def weigh(
    scaled: ScaledData,
    fitted: Fitted,
    linear: Fitted,
    values: dict[str, float],
    data: IdentificationData,
    asked: Asked,
    predicting: Fitted,
) -> Evidence:
    """Compare the fit with the linear model and with PV alone, per row, on the common number of rows.

    `predicting` is the linear model by its predictions, as that of PV alone is.
    """
    alone = _alone(scaled, MOST_NOISE_LAGS if asked.noise is None else asked.noise)
    kind, n = kind_of(fitted.problem.family.kind), min(fitted.problem.errors, linear.problem.errors)
    beyond, crossed = (0, 0), None
    if kind.dead_between:
        below, above = (values[name] for name in kind.break_points)
        beyond = int(np.sum(data.u < below)), int(np.sum(data.u > above))
        crossed = crossings(data.u, np.asarray(scaled.segments), below, above)
    loop, healthy = feedback(scaled), kind.healthy(fitted, linear)
    gain = -float(loop.direction) or float(fitted.parts.b.sum())
    counts = kind.sticks or (kind.dead_between and loop.closed)
    return Evidence(
        gain_over_linear=gain_over_linear(fitted, linear),
        gain_over_healthy=None if healthy is linear else gain_over_linear(fitted, healthy),
        gain_over_no_input=n * (alone - per_row(predicting)),
        samples_left=beyond[0],
        samples_right=beyond[1],
        rivals=_rivals(fitted, scaled.scaling) if kind.dead_between else (),
        closed_loop=loop.closed,
        free_moves=loop.free,
        crossings=crossed,
        unseen_moves=data.unseen.of_size(kind.sticks, loop.closed) if counts else 0.0,
        answered=data.answered if loop.closed else True,
        foreknown=loop.closed
        and (data.unseen.mostly or may_be_settled(data, fitted.parts.a, fitted.parts.b) or data.foretold.against(gain)),
    )


@remembered
def _alone(scaled: ScaledData, lags: int) -> float:
    """Criterion per row of PV foretold from its own past, by up to so many lags."""
    own = autoregressions([scaled.y[start:stop] - scaled.y.mean() for start, stop in scaled.segments], lags)
    costs = np.log(own.rows) + PENALTY * np.arange(own.most + 1)
    return float(np.min(np.log(np.maximum(own.variances, FLOOR)) + costs / own.rows))


def _rivals(fitted: Fitted, scaling: Scaling) -> tuple[tuple[float, float, float], ...]:
    """Break points of the other maxima in units of OP, and how far each is behind."""
    places = [(scaling.u_centre + scaling.u_scale * eta[:2], behind) for eta, behind in fitted.rivals]
    return tuple((float(at[0]), float(at[1]), behind) for at, behind in places)


def _widest_interval(
    kind: Kind, values: dict[str, float], covariance: FloatArray, profiled: dict[str, tuple[float, float]]
) -> float:
    """Of the break points, 95 %."""
    names, spread = list(values), 2.0 * 1.96 * np.sqrt(np.diag(covariance))
    curved = {name: float(spread[names.index(name)]) for name in kind.break_points}
    return max(profiled[name][1] - profiled[name][0] if name in profiled else curved[name] for name in curved)


def excluded_above(
    fitted: Fitted, evidence: Evidence, profiled: dict[str, tuple[float, float]], scaling: Scaling
) -> float | None:
    """Largest size that the record does not exclude; None where there is none, or a process of any kind would do."""
    kind = kind_of(fitted.problem.family.kind)
    hidden = evidence.only_fed_back or not evidence.can_exclude
    widest = None if hidden else kind.widest(fitted, profiled, scaling)
    return None if widest is None else beyond_unseen(widest, evidence.unseen_moves, kind.sticks)


def excluded_sizes(sizes: dict[str, float], data: IdentificationData, scaling: Scaling) -> dict[str, float]:
    """The same of every kind in units of OP, from scaled ones beside the linear model."""
    found = {name: (scaling.u_scale * size, kind_of(name).sticks) for name, size in sizes.items()}
    return {name: beyond_unseen(size, data.unseen.about(sticks), sticks) for name, (size, sticks) in found.items()}


def decide(
    fitted: Fitted,
    evidence: Evidence,
    coloured: bool,
    misfit: bool,
    values: dict[str, float],
    covariance: FloatArray,
    profiled: dict[str, tuple[float, float]],
) -> Status:
    """First thing that the reader must know."""
    if evidence.gain_over_no_input + max(evidence.gain_over_linear, 0.0) <= 0:
        return Status.CANNOT_TELL
    kind = kind_of(fitted.problem.family.kind)
    if kind.size is not None:
        at = list(values).index(kind.size)
        size, error = values[kind.size], float(np.sqrt(covariance[at, at]))
        reach = 1.96 * error if np.isfinite(error) else 1e-9 * abs(values.get("right", size))  # collapsed
        if evidence.gain <= 0 or size <= reach:
            return Status.NOT_SEEN
        if not np.isfinite(error):
            return Status.CANNOT_TELL
    elif kind.name != NO_FAULT and evidence.gain <= 0:
        return Status.NOT_SEEN
    if not fitted.fit.converged:
        return Status.NOT_CONVERGED
    if kind.one_sided(evidence, values, covariance):
        return Status.ONE_SIDED
    if kind.dead_between and _widest_interval(kind, values, covariance, profiled) > VAGUE * values["width"]:
        return Status.WIDE
    if misfit:
        return Status.MISFIT
    return Status.COLOURED if coloured else Status.OK
