"""Does a record tell its delay? How far the best model with another delay stays away from the truth."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.errors import ParameterError
from lostmotion.identify.actuators.dead_zone import DeadZoneFamily
from lostmotion.identify.likelihood.problem import Problem, Structure
from lostmotion.identify.likelihood.refinement import refine
from lostmotion.models import DeadZone, Hammerstein, NoiseModel

INSIDE = 1e-5  # an integrator starts this far inside the unit circle: an output-error predictor needs a stable A
MOST_STEPS = 200  # twice those of a fit: with a wrong delay it starts further away


def delay_margin(model: Hammerstein, u: FloatArray, noise: NoiseModel, clean: FloatArray) -> float:
    """Twice the expected gain in log-likelihood of the true delay over the next ones, at the true orders.

    The output without noise is fitted by models of the same orders with one sample of delay less and more, noise
    filter known. A likelihood ratio test of the two delays errs in a share Phi(-sqrt(margin) / 2) of records: 16 %
    at 4, 2 % at 16, 0.6 % at 25. Whatever the estimator, a smaller margin leaves the delay to chance, unless more
    is known about B than its order.

    Parameters
    ----------
    model, noise : Hammerstein, NoiseModel
        Truth; the noise with a positive variance.
    u, clean : ndarray, shape (n,)
        Command and output without noise.

    Examples
    --------
    >>> from lostmotion.models import LinearModel
    >>> model = Hammerstein(DeadZone(-1, 1), LinearModel([-0.8], [0.2], delay=3))
    >>> u = np.random.default_rng(0).uniform(-3, 3, 400)
    >>> delay_margin(model, u, NoiseModel((), 0.01), model.simulate(u)) > 1000
    True
    """
    zone, linear, noise = model.nonlinearity, model.linear, noise.autoregression()
    if not isinstance(zone, DeadZone):
        raise ParameterError.expected("a DeadZone actuator", type(zone).__name__, "other kinds have no margin yet")
    middle, level = float(np.mean(u)), float(np.mean(clean))  # deviations keep the numbers well scaled
    shifted = DeadZone(zone.left - middle, zone.right - middle, zone.left_slope, zone.right_slope)
    margins = []
    for delay in (linear.delay - 1, linear.delay + 1):
        if delay < 0:
            continue
        p, na, nb = noise.order, len(linear.a), len(linear.b) - 1
        structure = Structure(na, nb, delay, p, linear.delay + 1 + p)
        family = DeadZoneFamily(float(np.min(u)) - middle, float(np.max(u)) - middle)
        problem = Problem(u - middle, clean - level, np.array([[0, u.size]]), family, structure)
        start = _start(problem, Hammerstein(shifted, linear, model.offset - level), noise)
        free = np.delete(np.eye(start.size), np.arange(problem.noise_at, problem.initial_at), axis=1)
        margins.append(refine(problem, start, free, most_steps=MOST_STEPS).cost / noise.variance)
    return min(margins)


def _start(problem: Problem, model: Hammerstein, noise: NoiseModel) -> FloatArray:
    """The true parameters."""
    zone, linear = model.nonlinearity, model.linear
    assert isinstance(zone, DeadZone)  # noqa: S101  for the type checker
    a = np.array(linear.a)
    if np.abs(linear.poles).max(initial=0.0) > 1.0 - INSIDE:
        a = a * (1.0 - INSIDE) ** np.arange(1, a.size + 1)
    eta = np.array([zone.left, zone.right, np.log(zone.left_slope / zone.right_slope)])
    return problem.pack(a, zone.right_slope * np.array(linear.b), eta, np.array(noise.d), model.offset)
