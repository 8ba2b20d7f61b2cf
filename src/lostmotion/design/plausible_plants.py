"""Plants that could stand behind a rough model: a design must do well on all of them, not on one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.models import DeadZone, Hammerstein, LinearModel

SPREAD = 0.3  # of a guess: half the width for the break points, a factor for slopes, gain and time constants
FLOOR = 0.05  # of the width: break points are never taken as better known than this, valves wear between two tests
FACTORS = 5  # left, right, slope ratio, gain, time scale
ATTEMPTS = 50  # draws per plant wanted: where nearly none is a process, there are fewer plants
STABLE = 1.0 - 1e-6  # largest modulus of a drawn pole, unless the model itself has a larger one
DERIVED = ("width", "slope_ratio", "gain", "load")  # of the others, or known from where OP rests


def around_guess(model: Hammerstein, count: int, seed: int, spread: float = SPREAD) -> list[Hammerstein]:
    """Models around a guess, evenly spread over every factor with its ends (Latin hypercube).

    Break points move by up to `spread` times the half-width, the slope ratio, the gain and the time constants by a
    factor of up to 1 + `spread` either way.
    """
    random = np.random.default_rng([seed, 1])
    grid = np.linspace(-1.0, 1.0, count)
    return [_moved(model, point, spread) for point in np.column_stack([random.permutation(grid) for _ in range(5)])]


def drawn_around_guess(model: Hammerstein, count: int, seed: int, spread: float = SPREAD) -> list[Hammerstein]:
    """Fresh models, uniform over the same box, to check a design that was made on others."""
    random = np.random.default_rng([seed, 2])
    return [_moved(model, point, spread) for point in random.uniform(-1.0, 1.0, (count, FACTORS))]


def extremes(model: Hammerstein, spread: float = SPREAD) -> list[Hammerstein]:
    """The liveliest and the laziest plant of the box, which go furthest in PV."""
    lively = np.array([1.0, -1.0, 0.0, 1.0, -1.0])
    return [_moved(model, lively, spread), _moved(model, -lively, spread)]


def _moved(model: Hammerstein, point: FloatArray, spread: float) -> Hammerstein:
    zone = model.nonlinearity
    assert isinstance(zone, DeadZone)  # noqa: S101  checked at the door
    reach, factor = 0.5 * spread * zone.width, 1.0 + spread
    left, right = zone.left + reach * point[0], zone.right + reach * point[1]
    moved = DeadZone(left, right, zone.left_slope * factor ** point[2], zone.right_slope)
    return Hammerstein(moved, _other_dynamics(model.linear, factor ** point[3], factor ** point[4]), model.offset)


def _other_dynamics(linear: LinearModel, gain: float, slower: float) -> LinearModel:
    """Gain and time constants multiplied; integrators stay integrators, delays stay."""
    poles = linear.poles
    settling = np.abs(poles - 1.0) > 1e-9
    sampled = settling & ((poles.real > 0) | (poles.imag != 0))  # no sampled process has the others
    moved = poles.copy()
    moved[sampled] = np.exp(np.log(poles[sampled]) / slower)
    before, after = (np.real(np.prod(1.0 - values[settling])) for values in (poles, moved))
    b = np.array(linear.b) * (gain * after / before)
    return LinearModel(tuple(np.real(np.poly(moved))[1:]), tuple(b), linear.delay, linear.dt)


def drawn(
    model: Hammerstein, parameters: dict[str, float], covariance: FloatArray, count: int, seed: int
) -> list[Hammerstein]:
    """Models drawn from the covariance of a fit, in pairs on either side of it; impossible draws are drawn again."""
    names = [name for name in parameters if name not in DERIVED]
    rows = [list(parameters).index(name) for name in names]
    values = np.array([parameters[name] for name in names])
    part = covariance[np.ix_(rows, rows)].copy()
    for name in ("left", "right"):
        at = names.index(name)
        part[at, at] = max(part[at, at], (FLOOR * parameters["width"]) ** 2)
    size, vectors = np.linalg.eigh(part)
    root = vectors * np.sqrt(np.maximum(size, 0.0))
    random = np.random.default_rng([seed, 3])
    models: list[Hammerstein] = []
    for _ in range(ATTEMPTS * count):
        draw = root @ random.standard_normal(values.size)
        for side in (draw, -draw):
            drawn_model = _rebuilt(model, dict(zip(names, (values + side).tolist(), strict=True)))
            if drawn_model is not None:
                models.append(drawn_model)
        if len(models) >= count:
            break
    return models[:count]


def _rebuilt(model: Hammerstein, values: dict[str, float]) -> Hammerstein | None:
    """Model of drawn parameters; None where they are none."""
    linear = model.linear
    if values["left"] > values["right"] or min(values["left_slope"], values["right_slope"]) <= 0:
        return None
    a = tuple(values[f"a{i + 1}"] for i in range(len(linear.a)))
    b = tuple(values[f"b{i}"] for i in range(len(linear.b)))
    process = replace(linear, a=a, b=b)
    if np.abs(process.poles).max(initial=0.0) > max(np.abs(linear.poles).max(initial=0.0), STABLE):
        return None
    zone = DeadZone(values["left"], values["right"], values["left_slope"], values["right_slope"])
    return Hammerstein(zone, process, values.get("offset", model.offset))
