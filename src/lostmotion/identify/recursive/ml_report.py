"""What RecursiveML says: estimate, trajectory, and the break points of a period."""

from __future__ import annotations

import math

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.errors import ParameterError, Status
from lostmotion.identify.actuators.dead_zone import DeadZoneFamily
from lostmotion.identify.likelihood.offset import without_column
from lostmotion.identify.likelihood.parameters import information_inverse, named_values
from lostmotion.identify.recursive.ml_recursion import Recursion
from lostmotion.identify.recursive.ml_settings import Settings
from lostmotion.identify.recursive.recursive_estimate import RecursiveEstimate, Trajectory
from lostmotion.identify.recursive.remembered import NONE, Memory
from lostmotion.kernels.recursive_ml import drift, information, watch
from lostmotion.kernels.recursive_ml import state as ml
from lostmotion.models import DeadZone, Hammerstein, Identity, LinearModel, NoiseModel, Nonlinearity

NAMES = ("left", "right", "left_slope", "right_slope")
KNOWN = 0.25  # of the range of u: a break point with a larger standard error is not known
COLOURED = 0.15  # correlation of the errors at a lag; with less the intervals are at most 16 % too narrow (AR(1))
ROUNDING = 1e-12  # variance of the errors of scaled data below which their colour is that of rounding
SURE = 5.0  # standard errors of a correlation: it is looked at at eight lags, again and again
AT_BOUND = 1.0 - 1e-6  # of the logarithm of the slope ratio: the estimate stands at its bound
TOUCHED = 1e-6  # of the largest share in a direction without information: less is rounding


def nothing_yet(settings: Settings, samples: int, integrating: bool = False) -> RecursiveEstimate:
    """Estimate while the first window fills, or where its process is not one to follow."""
    linear = LinearModel((0.0,) * settings.na, (0.0,) * (settings.nb + 1), settings.delay, settings.dt)
    unknown = dict.fromkeys((*NAMES, "width", "slope_ratio", "gain", "offset"), math.nan)
    covariance = np.full((len(unknown),) * 2, np.inf)
    status = Status.INTEGRATING if integrating else Status.CANNOT_TELL
    return RecursiveEstimate(status, Hammerstein(Identity(), linear), unknown, covariance, samples)


def present(recursion: Recursion) -> RecursiveEstimate:
    """Estimate with standard errors and status."""
    memory, settings = recursion.memory, recursion.settings
    shown = memory.parts["shown"]
    pinned = information.pinned(recursion.state, recursion.layout)
    inverse, empty = information_inverse(
        memory.parts["total_h"], without_column(memory.n, memory.eta - 1) if pinned else None
    )
    values, jacobian, wrong = _named(recursion, shown)
    spread = memory.variance * inverse
    for side in range(2):
        place = memory.eta + side
        spread[place, place] += drift.unsettled(recursion.state, recursion.layout, side) + _between_levels(memory)
    covariance = jacobian @ spread @ jacobian.T
    for direction in empty.T:
        move = jacobian @ direction
        lost = np.abs(move) > TOUCHED * np.abs(move).max(initial=NONE)
        covariance[lost, lost] = np.inf
    noise = NoiseModel(tuple(shown[memory.eta + 3 :].tolist()), memory.variance * recursion.scales[1] ** 2)
    status = Status.WRONG_GAIN if wrong else _status(recursion, values, covariance)
    informed = {
        name: int(recursion.layout[entry]) + recursion.before
        for name, entry in (("left", ml.LEFT_AT), ("right", ml.RIGHT_AT))
    }
    model = _model(settings, values)
    return RecursiveEstimate(status, model, values, covariance, recursion.samples, noise, informed)


def _between_levels(memory: Memory) -> float:
    """Variance of a break point that may be anywhere between two levels of a rounded OP."""
    gap = float(memory.parts["watch"][ml.GAP])
    return gap**2 / 12.0 if np.isfinite(gap) else 0.0


def _named(recursion: Recursion, theta: FloatArray) -> tuple[dict[str, float], FloatArray, bool]:
    """Named parameters, their derivatives, and whether the known gain has the wrong sign."""
    settings, scaling = recursion.settings, recursion.scaling
    na, nb = settings.na, settings.nb
    try:
        return (*named_values(theta, DeadZoneFamily, na, nb, scaling, settings.gain), False)
    except ParameterError:
        return (*named_values(theta, DeadZoneFamily, na, nb, scaling, None), True)


def _reach(recursion: Recursion, memory: Memory) -> float:
    """Standard error up to which a break point is known, in units of u."""
    low, high = memory.span
    return KNOWN * (high - low) * recursion.scales[0]


def _status(recursion: Recursion, values: dict[str, float], covariance: FloatArray) -> Status:
    errors = dict(zip(values, np.sqrt(np.maximum(np.diag(covariance), 0.0)), strict=True))
    reach = _reach(recursion, recursion.memory)
    known = [errors[name] < reach for name in ("left", "right")]
    if not any(known):
        return Status.CANNOT_TELL
    if not all(known):
        return Status.ONE_SIDED
    if abs(recursion.memory.parts["shown"][recursion.memory.eta + 2]) > AT_BOUND * recursion.state[ml.RATIO_LIMIT]:
        return Status.NOT_CONVERGED
    # BIC of the one parameter: an estimate is looked at a thousand times, and 1.96 would claim a width by chance
    remembered = min(float(recursion.samples), recursion.settings.remembered)
    if values["width"] ** 2 <= np.log(remembered) * errors["width"] ** 2:
        return Status.NOT_SEEN
    correlation, samples = watch.colour(recursion.state, recursion.layout)
    if recursion.memory.variance < ROUNDING:
        return Status.OK
    return Status.OK if correlation < max(COLOURED, SURE / math.sqrt(max(samples, 1.0))) else Status.COLOURED


def _model(settings: Settings, values: dict[str, float]) -> Hammerstein:
    zone: Nonlinearity = DeadZone(*(values[name] for name in NAMES))
    a = tuple(values[f"a{i + 1}"] for i in range(settings.na))
    b = tuple(values[f"b{i}"] for i in range(settings.nb + 1))
    return Hammerstein(zone, LinearModel(a, b, settings.delay, settings.dt), values["offset"])


def trajectory(
    settings: Settings,
    recursion: Recursion | None,
    samples: IntArray,
    rows: FloatArray,
    errors: FloatArray,
) -> Trajectory:
    """Way through a run whose last rows are `rows` of theta; NaN in those before there was an estimate."""
    na, nb1 = settings.na, settings.nb + 1
    order = settings.noise if isinstance(settings.noise, int) else 0
    theta = np.full((samples.size, na + nb1 + 4 + order if recursion is None else recursion.n), np.nan)
    if len(rows):
        theta[samples.size - len(rows) :] = rows
    scale_u, scale_y = (1.0, 1.0) if recursion is None else recursion.scales
    eta = na + nb1 + 1
    ratio = np.exp(theta[:, eta + 2])
    slope = np.ones(samples.size)
    if settings.gain is not None:
        product = theta[:, na : na + nb1].sum(axis=1) / (1.0 + theta[:, :na].sum(axis=1)) * scale_y / scale_u
        slope = np.where(product / settings.gain > 0, product / settings.gain, 1.0)
    values = {"left": theta[:, eta] * scale_u, "right": theta[:, eta + 1] * scale_u}
    values |= {"left_slope": ratio * slope, "right_slope": slope + 0.0 * ratio, "theta": theta}
    return Trajectory(samples, values, errors)


def end_period(recursion: Recursion) -> tuple[dict[str, float], dict[str, float], int] | None:
    """Break points and width from the samples of the period alone, see ``RecursiveML.period``; begin a new one."""
    memory, layout, scale = recursion.memory, recursion.layout, recursion.scales[0]
    h, r = memory.parts["period_h"], memory.parts["period_r"]
    count = int(layout[ml.COUNT] - layout[ml.PERIOD_FROM])
    information_matrix, score = h.copy(), r - h @ memory.theta
    h[:], r[:] = 0.0, 0.0
    layout[ml.PERIOD_FROM] = layout[ml.COUNT]
    inverse, empty = information_inverse(information_matrix, None)
    zone = slice(memory.eta, memory.eta + 2)
    if not count or (np.abs(empty[zone]) > TOUCHED * np.abs(empty).max(axis=0, initial=NONE)).any():
        return None
    left, right = (memory.theta[zone] + (inverse @ score)[zone]) * scale
    covariance = memory.variance * inverse[zone, zone] * scale**2
    wide = covariance[0, 0] + covariance[1, 1] - 2.0 * covariance[0, 1]
    spread = dict(zip(("left", "right", "width"), np.sqrt([*np.diag(covariance), wide]).tolist(), strict=True))
    if not max(spread["left"], spread["right"]) < _reach(recursion, memory):
        return None
    return {"left": float(left), "right": float(right), "width": float(right - left)}, spread, count
