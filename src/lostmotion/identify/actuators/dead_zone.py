"""Dead zone: between two break points nothing moves."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray
from lostmotion.errors import ParameterError
from lostmotion.identify.actuators.break_points import about_levels, break_point_intervals
from lostmotion.identify.actuators.kind import NEEDED, Kind, Words, register
from lostmotion.identify.actuators.operator_profile import lags_of
from lostmotion.identify.actuators.rate_limited import slow_at_a_glance
from lostmotion.identify.actuators.slopes import with_equal_slopes
from lostmotion.identify.actuators.sought import Sought
from lostmotion.identify.actuators.static_profile import profile
from lostmotion.identify.actuators.width_bound import width_bound
from lostmotion.identify.actuators.without_gap import without_gap
from lostmotion.identify.evidence import Evidence
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.criterion import gain_over_linear
from lostmotion.identify.likelihood.family import Family
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.offset import settle_offset
from lostmotion.identify.likelihood.problem import Problem
from lostmotion.identify.likelihood.remembered import remembered
from lostmotion.identify.scaled import ScaledData, Scaling
from lostmotion.kernels import dead_zone as kernel
from lostmotion.models import DeadZone, Nonlinearity

LARGEST_SLOPE_RATIO = 50.0  # beyond this one side carries no signal: it is a one-sided actuator
LARGEST_LOG_RATIO = float(np.log(LARGEST_SLOPE_RATIO))
FARTHEST = 100.0  # of its logarithm: numbers stay finite
OUTER_SHARE = 0.01  # break points are sought where this share of the samples lies beyond them on either side
FEWEST_BEYOND = 20  # samples beyond a break point below which that side is not really visited
LARGEST_RATIO_ERROR = 0.6  # of the slope ratio: above it one side may have no slope at all, so no break point either
LEAST_BEYOND = 0.02  # of the rows: a dead zone that is never left on one side is a limit
BOTH_SIDES = 0.05  # of the rows beyond either end of a dead zone of a given size: with fewer it is a limit, or a seat
PLACES = (4, 16)  # at which a dead zone of a given size is tried, fewest and most
GLANCED = 6  # levels of OP between which it is looked for first
UNMOVED = 1e-9  # of a direction: a part of it below this is rounding


@dataclass(frozen=True)
class DeadZoneFamily(Family):
    """Dead zone; own parameters = left, right, log(left_slope / right_slope).

    `low` and `high` keep both break points where at least a few samples lie beyond them: outside, the
    likelihood is flat. With `still` it moves beyond these two only, on the lines that reach zero at left and right.
    """

    low: float
    high: float
    still: tuple[float, float] | None = None
    kind: ClassVar[str] = "dead zone"
    own: ClassVar[tuple[str, ...]] = ("left", "right", "log_ratio")
    relative: ClassVar[bool] = True

    def act(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """Dead zone with right slope 1 and its derivatives."""
        left, right, log_ratio = eta.tolist()
        log_ratio = min(max(log_ratio, -FARTHEST), FARTHEST)  # a trial step may go anywhere
        kernel.sensitivities(u, left, right, log_ratio, x, dx)
        if self.still is not None:
            inside = (u > self.still[0]) & (u < self.still[1])
            x[inside] = 0.0
            dx[:, inside] = 0.0

    @property
    def sought(self) -> int:
        """Two more where it is left with a jump."""
        return super().sought + (0 if self.still is None else 2)

    def valid(self, eta: FloatArray) -> FloatArray:
        """Order the break points (a negative width becomes zero at its middle) and keep them inside the data."""
        left, right, log_ratio = eta.tolist()
        if left > right:
            left = right = 0.5 * (left + right)
        limit = LARGEST_LOG_RATIO
        return np.array(
            [
                min(max(left, self.low), self.high),
                min(max(right, self.low), self.high),
                min(max(log_ratio, -limit), limit),
            ]
        )

    def edges(self, own: FloatArray) -> list[float]:
        """The real actuator may break away with a jump."""
        return [float(edge) for edge in (self.still or own[:2])]

    def room(self, own: FloatArray, direction: FloatArray, largest: float, u: FloatArray) -> float:
        """How far the break points can move before they meet a sample of OP.

        Where no sample lies inside the dead zone, it can slide in the gap between two levels of OP unseen.
        """
        reach = float(np.abs(direction[:2]).max())
        if reach < UNMOVED * largest:
            return float(np.inf)
        left, right = own[:2]
        low = left - float(np.max(u[u < left], initial=float(u.min())))
        high = float(np.min(u[u > right], initial=float(u.max()))) - right
        return float((low + high) / reach)

    @classmethod
    def named(
        cls, own: npt.NDArray[Any], scaling: Scaling, product: Any, gain: float | None
    ) -> tuple[tuple[str, ...], list[Any], Any]:
        """Break points, slopes, width and their ratio; a known gain separates the slopes from it."""
        left, right, log_ratio = own
        slope = 1.0 + 0.0 * product if gain is None else _right_slope(product, gain)
        left, right = scaling.u_centre + scaling.u_scale * left, scaling.u_centre + scaling.u_scale * right
        ratio = np.exp(log_ratio)
        names = ("left", "right", "left_slope", "right_slope", "width", "slope_ratio")
        return names, [left, right, ratio * slope, slope, right - left, ratio], slope


def _right_slope(product: complex, gain: float) -> complex:
    slope = product / gain
    if slope.real <= 0:
        raise ParameterError.expected(
            f"a gain with the sign of the record (product of gain and slope = {product.real:.4g})",
            gain,
            "turn its sign, or leave gain out",
        )
    return slope


class DeadZoneKind(Kind):
    """A gap in the characteristic, with slopes of its own on either side."""

    model = DeadZone
    family = DeadZoneFamily
    evidence = "dead_zone"
    angular = "level"
    has_slopes = True
    break_points = ("left", "right")
    dead_between = True
    slides = ((1.0, 1.0, 0.0),)
    anywhere = ("left", "right", "slope_ratio", "left_slope")
    always_tried = True
    begins_alone = True
    largest_share = 0.8  # what is left on either side must show two slopes
    words = Words(
        wider="A dead zone wider than",
        plural="dead zones",
        meanings={
            "left": "break point, OP falling",
            "right": "break point, OP rising",
            "left_slope": "slope below left",
            "right_slope": "slope above right",
            "width": "full width",
            "slope_ratio": "left_slope / right_slope",
        },
        advice=(
            "Check the range and the zero of the positioner, and spool or relay overlap.",
            "Compensate: `lostmotion simulate` says whether it is worth it, `lostmotion export` writes the block.",
        ),
    )

    def forms(self, data: ScaledData) -> list[Family]:
        """One, with some samples beyond either end."""
        return [DeadZoneFamily(*_visited(data.u, OUTER_SHARE))]

    def of_size(self, problem: Problem, size: float) -> Iterator[tuple[Family, FloatArray]]:
        """At places a third of the size apart, with equal slopes."""
        low, high = _visited(problem.u, BOTH_SIDES)
        ends = float(problem.u.min()) - size, float(problem.u.max()) + size
        first, last = min(low + 0.5 * size, 0.5 * (low + high)), max(high - 0.5 * size, 0.5 * (low + high))
        number = int(np.clip(3.0 * (last - first) / size, *PLACES)) + 1 if last != first else 1
        for middle in np.linspace(first, last, number):
            yield DeadZoneFamily(*ends), np.array([middle - 0.5 * size, middle + 0.5 * size, 0.0])

    def met_by(self, u: FloatArray, own: FloatArray) -> FloatArray:
        """With both ends where OP goes, or all of that inside."""
        low, high = _visited(u, BOTH_SIDES)
        half, middle = 0.5 * (own[1] - own[0]), 0.5 * (own[0] + own[1])
        inside = min(max(middle, low + half), high - half) if 2.0 * half <= high - low else 0.5 * (low + high)
        return own if abs(inside - middle) <= UNMOVED * half else np.array([inside - half, inside + half, own[2]])

    def sought(self, data: ScaledData, asked: Asked) -> Sought:
        """By the profile over both break points, which share one Gram matrix."""
        (family,) = self.forms(data)
        candidates = profile(data, lags_of(data, asked), *_ends(family))
        etas = [np.array([c.left, c.right, c.log_ratio]) for c in candidates]
        return Sought(family, etas, candidates[0].rss)

    def glance(self, data: ScaledData) -> list[tuple[Family, FloatArray]]:
        """Equal slopes, between levels that are spread over the range of OP."""
        (family,) = self.forms(data)
        levels = np.linspace(*_ends(family), GLANCED)
        return [(family, np.array([a, b, 0.0])) for i, a in enumerate(levels) for b in levels[i + 1 :]]

    def actuator(self, values: Mapping[str, float], family: Family) -> Nonlinearity:
        """Break points in order, to rounding."""
        del family
        left = min(values["left"], values["right"])
        return DeadZone(left, values["right"], values["left_slope"], values["right_slope"])

    def settled(self, fitted: Fitted, scaling: Scaling, offset: str) -> Fitted:
        """About the levels of OP that it holds; with offset 0 where asked, or likelier."""
        return settle_offset(about_levels(fitted), scaling, offset)

    def simplest(self, fitted: Fitted) -> Fitted:
        """With equal slopes, where they explain as much."""
        return with_equal_slopes(fitted)

    def healthy(self, fitted: Fitted, linear: Fitted) -> Fitted:
        """A characteristic without the gap, which may bend, or a valve that is slow."""
        family = fitted.problem.family
        if isinstance(family, DeadZoneFamily) and family.still is not None:
            fitted = replace(fitted, problem=replace(fitted.problem, family=replace(family, still=None)))
        rivals = without_gap(fitted, linear), slow_at_a_glance(fitted, linear)
        return max(rivals, key=lambda one: gain_over_linear(one, linear))

    def handicapped(self, scores: Mapping[str, float], candidates: Mapping[str, Fitted]) -> float:
        """A dead zone that OP hardly leaves on one of its sides is the limit of a saturation."""
        mine = scores[self.name]
        if "saturation" not in scores:
            return mine
        fitted = candidates[self.name]
        (left, right), u = fitted.actuator[:2], fitted.problem.u
        limit = bool(min(np.mean(u < left), np.mean(u > right)) < LEAST_BEYOND)
        return min(mine, scores["saturation"] - NEEDED) if limit else mine

    def intervals(self, fitted: Fitted, scaling: Scaling) -> dict[str, tuple[float, float]]:
        """Where few levels of OP lie inside, or the interval is wide beside it."""
        return break_point_intervals(fitted, scaling)

    def widest(self, fitted: Fitted, profiled: Mapping[str, tuple[float, float]], scaling: Scaling) -> float:
        """By the profile likelihood of the width, location and all else free."""
        del profiled
        return width_bound(fitted) * scaling.u_scale

    def one_sided(self, evidence: Evidence, values: Mapping[str, float], covariance: FloatArray) -> bool:
        """Whether one side was hardly visited, or what was seen of it may be nothing."""
        at = list(values).index("slope_ratio")
        unsure = bool(np.sqrt(covariance[at, at]) > LARGEST_RATIO_ERROR * values["slope_ratio"])
        return unsure or min(evidence.samples_left, evidence.samples_right) < FEWEST_BEYOND

    def unvisited(self, evidence: Evidence) -> tuple[str, ...]:
        """Of the side that was visited less."""
        if evidence.samples_left < evidence.samples_right:
            return ("left", "left_slope", "slope_ratio", "width")
        return ("right", "slope_ratio", "width")


@remembered
def _visited(u: FloatArray, beyond: float) -> tuple[float, float]:
    """Range of OP with this share of the samples beyond either end."""
    low, high = (float(value) for value in np.quantile(u, [beyond, 1.0 - beyond]))
    return low, high


def _ends(family: Family) -> tuple[float, float]:
    if not isinstance(family, DeadZoneFamily):
        raise TypeError(f"expected a family of dead zones, got one of {family.kind}; ask its own kind")
    return family.low, family.high


DEAD_ZONE = register(DeadZoneKind())
