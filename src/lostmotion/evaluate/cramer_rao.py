"""Cramer-Rao bound: what the best unbiased estimator could reach on this input."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from lostmotion.errors import ParameterError
from lostmotion.identify.batch import LocalFit
from lostmotion.identify.families import DeadZoneFamily
from lostmotion.identify.offset import without_column
from lostmotion.identify.parameters import Scaling, name_parameters
from lostmotion.identify.problem import Problem, Structure
from lostmotion.identify.search import Fitted
from lostmotion.models import DeadZone, Hammerstein, NoiseModel
from lostmotion.models._arguments import FloatArray, signal


def cramer_rao(
    model: Hammerstein,
    u: npt.ArrayLike,
    noise: NoiseModel | float,
    *,
    gain: float | None = None,
    offset: str = "free",
    y: npt.ArrayLike | None = None,
) -> dict[str, float]:
    """Smallest standard errors that an unbiased estimator of the whole model can have.

    Parameters
    ----------
    model : Hammerstein
        True system, with a :class:`DeadZone`.
    u : array_like, shape (n,)
        Command.
    noise : NoiseModel or float
        True noise, or the variance of white noise, in units of y squared.
    gain : float, optional
        Static gain that the estimator knows, as in ``identify``.
    offset : {"free", "zero"}
        Whether the estimator must find the output offset or knows that it is zero.
    y : array_like, shape (n,), optional
        A record, for coloured noise in closed loop, where the information of the noise model depends on it. None:
        simulated, which is exact for white noise and in open loop.

    Returns
    -------
    dict of float
        Standard error by the names of ``HammersteinFit.parameters``; initial state and noise model count as
        unknown.

    Examples
    --------
    >>> from lostmotion.simulate import platforms, signals
    >>> tank = platforms.level_tank()
    >>> bound = cramer_rao(tank, signals.prs(2000, -5, 5, 10, seed=0), 0.03, gain=tank.linear.gain)
    >>> 0.002 < bound["right"] < 0.006
    True
    """
    zone = model.nonlinearity
    if not isinstance(zone, DeadZone):
        raise ParameterError.expected("a DeadZone actuator", type(zone).__name__, "other kinds have no bound yet")
    noise = noise if isinstance(noise, NoiseModel) else NoiseModel((), noise)
    u = signal("u", u)
    d = np.array(noise.d)
    linear = model.linear.scaled(zone.right_slope)
    structure = Structure(len(linear.a), len(linear.b) - 1, linear.delay, noise.order, linear.delay + noise.order)
    measured = model.simulate(u) if y is None else signal("y", y)
    segments = np.array([[0, u.size]])
    problem = Problem(u, measured, segments, DeadZoneFamily(-np.inf, np.inf), structure)
    eta = np.array([zone.left, zone.right, np.log(zone.left_slope / zone.right_slope)])
    theta = problem.pack(np.array(linear.a), np.array(linear.b), eta, d, model.offset)
    _, _, hessian = problem.evaluate(theta)
    if noise.order and y is None:
        _fill_noise_block(hessian, problem, noise)
    basis = without_column(theta.size, problem.eta_at - 1) if offset == "zero" else np.eye(theta.size)
    exact = noise.variance * max(problem.errors - basis.shape[1], 1)  # name_parameters divides by this
    at_truth = Fitted(problem, LocalFit(theta, exact, hessian, 0, True), basis)
    named = name_parameters(at_truth, Scaling(0, 1, 0, 1), gain)
    return dict(zip(named.values, np.sqrt(np.diag(named.covariance)).tolist(), strict=True))


def _fill_noise_block(hessian: FloatArray, problem: Problem, noise: NoiseModel) -> None:
    """In open loop the noise model is independent of the rest, so any positive block gives the same bound."""
    at = slice(problem.noise_at, problem.initial_at)
    hessian[at, :] = 0.0
    hessian[:, at] = 0.0
    hessian[at, at] = np.eye(noise.order) * max(noise.variance, 1e-300) * problem.errors
