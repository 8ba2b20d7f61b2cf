"""Cramer-Rao bound: what the best unbiased estimator could reach on this input."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import finite_signal, signal
from lostmotion.arrays import FloatArray
from lostmotion.errors import ParameterError
from lostmotion.identify.actuators.dead_zone import DeadZoneFamily
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.offset import without_column
from lostmotion.identify.likelihood.parameters import name_parameters
from lostmotion.identify.likelihood.problem import Problem, Structure
from lostmotion.identify.likelihood.refinement import LocalFit
from lostmotion.identify.scaled import Scaling
from lostmotion.models import DeadZone, Hammerstein, LinearModel, NoiseModel

HAIR = 1e-9  # a pole this near to the unit circle integrates


def cramer_rao(
    model: Hammerstein,
    u: npt.ArrayLike,
    noise: NoiseModel | float,
    *,
    gain: float | None = None,
    offset: str = "free",
    y: npt.ArrayLike | None = None,
    clean: npt.ArrayLike | None = None,
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
    clean : array_like, shape (n,), optional
        Noise-free output, for a record that does not begin at rest. None: the model begins at rest.

    Returns
    -------
    dict of float
        Standard error by the names of ``HammersteinFit.parameters``; initial state and noise model count as
        unknown. Infinite where the record holds no information: the offset of an integrating process, a break point
        beyond which the command has not been.

    Notes
    -----
    The pole of an integrating process counts as unknown like any other. It is taken 1e-9 inside the unit circle, so
    that gain and offset have names; neither can be identified then.

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
    noise = noise.autoregression() if isinstance(noise, NoiseModel) else NoiseModel((), noise)
    u = signal("u", u)
    d = np.array(noise.d)
    linear = _not_quite_integrating(model.linear).scaled(zone.right_slope)
    structure = Structure(len(linear.a), len(linear.b) - 1, linear.delay, noise.order, linear.delay + noise.order)
    output = model.simulate(u) if clean is None else finite_signal("clean", clean, u.size)
    measured = output if y is None else finite_signal("y", y, u.size)
    segments = np.array([[0, u.size]])
    problem = Problem(u, measured, segments, DeadZoneFamily(-np.inf, np.inf), structure)
    eta = np.array([zone.left, zone.right, np.log(zone.left_slope / zone.right_slope)])
    theta = problem.pack(np.array(linear.a), np.array(linear.b), eta, d, model.offset)
    theta[problem.initial_at :] = _initial(problem, theta, output)
    _, _, hessian = problem.evaluate(theta)
    if noise.order and y is None:
        _fill_noise_block(hessian, problem, noise)
    basis = without_column(theta.size, problem.offset_at) if offset == "zero" else np.eye(theta.size)
    exact = noise.variance * max(problem.errors - basis.shape[1], 1)  # name_parameters divides by this
    at_truth = Fitted(problem, LocalFit(theta, exact, hessian, 0, True), basis)
    named = name_parameters(at_truth, Scaling(0, 1, 0, 1), gain)
    errors = dict(zip(named.values, np.sqrt(np.diag(named.covariance)).tolist(), strict=True))
    return errors | dict.fromkeys(_unvisited(zone, u[: u.size - linear.delay]), np.inf)


def _unvisited(zone: DeadZone, u: FloatArray) -> list[str]:
    """Parameters of a side on which the command has not been, and what hangs on them."""
    left, right = bool((u < zone.left).any()), bool((u > zone.right).any())
    names = [] if left and right else ["width", "left_slope", "slope_ratio"]
    return names + ["left"] * (not left) + ["right"] * (not right)


def _not_quite_integrating(linear: LinearModel) -> LinearModel:
    """The same process with its poles pulled inwards by a hair where one lies on the unit circle."""
    if np.abs(linear.poles).max(initial=0.0) < 1.0 - HAIR:
        return linear
    shrunk = [value * (1.0 - HAIR) ** (lag + 1) for lag, value in enumerate(linear.a)]
    return LinearModel(tuple(shrunk), linear.b, linear.delay, linear.dt)


def _initial(problem: Problem, theta: FloatArray, clean: FloatArray) -> FloatArray:
    """Initial terms c of the likelihood kernel: what A z - B x leaves where everything before the record is zero."""
    s = problem.structure
    if not s.initial:
        return np.zeros(0)
    x, _ = problem.internal(theta)
    parts = problem.parts(theta)
    a, b = parts.a, parts.b
    z = clean[s.first : s.first + s.initial] - parts.offset
    x = x[s.first - s.delay :][: s.initial]
    return np.asarray(np.convolve(np.append(1.0, a), z)[: s.initial] - np.convolve(b, x)[: s.initial])


def _fill_noise_block(hessian: FloatArray, problem: Problem, noise: NoiseModel) -> None:
    """In open loop the noise model is independent of the rest, so any positive block gives the same bound."""
    at = slice(problem.noise_at, problem.initial_at)
    hessian[at, :] = 0.0
    hessian[:, at] = 0.0
    hessian[at, at] = np.eye(noise.order) * max(noise.variance, 1e-300) * problem.errors
