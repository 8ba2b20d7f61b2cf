"""What the residuals still hold: correlation in time, or a shape that the model does not have."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.distributions import chi2_tail
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.problem import Problem
from lostmotion.identify.likelihood.refinement import with_states
from lostmotion.identify.likelihood.remembered import remembered
from lostmotion.kernels.normal_equations import normal_equations

WHITENESS_LAGS = 25  # beyond the orders fitted: past the longest AR noise and delay that are sought
SHAPE_KNOTS = 4  # hinges at the quintiles of the levels of OP: few degrees of freedom keep the test sharp
LEVEL = 1e-3  # of both tests: a report is read daily, so a false alarm must be rare
STATIC_SHARE = 0.1  # of the output residual; reported where the residuals are not white, so a test is not valid
SHARE = 0.01  # a misfit that explains less of the residual variance is real but without consequence


@dataclass(frozen=True)
class ResidualTests:
    """What the residuals still hold.

    Attributes
    ----------
    whiteness_p, shape_p : float
        p-values: white residuals; no better static shape of the actuator.
    shape_share : float
        Share of the variance of the prediction errors that a better static shape would explain.
    static_share : float
        The same for the output residual (measured minus simulated), without prewhitening: a size, not a test.
    """

    whiteness_p: float
    shape_p: float
    shape_share: float
    static_share: float

    @property
    def coloured(self) -> bool:
        """Residuals are not white."""
        return self.whiteness_p < LEVEL

    @property
    def misfit(self) -> bool:
        """The actuator has another shape, and it matters."""
        tested = self.shape_p < LEVEL and self.shape_share > SHARE
        return tested or (self.coloured and self.static_share > STATIC_SHARE)


def autocorrelation(errors: list[FloatArray], lags: int) -> FloatArray:
    """Residual autocorrelation at lags 0 .. lags, pooled over segments."""
    sums = np.zeros(lags + 1)
    for part in errors:
        for lag in range(min(lags, part.size - 1) + 1):
            sums[lag] += part[lag:] @ part[: part.size - lag]
    return np.asarray(sums / max(sums[0], 1e-300))


def whiteness(errors: list[FloatArray], fitted_orders: int) -> float:
    """p-value of the Ljung-Box test."""
    n = sum(part.size for part in errors)
    lags = min(WHITENESS_LAGS + fitted_orders, n // 4)
    r = autocorrelation(errors, lags)[1:]
    statistic = n * (n + 2) * float(np.sum(r**2 / (n - np.arange(1, lags + 1))))
    return chi2_tail(statistic, max(lags - fitted_orders, 1))


def shape(fitted: Fitted, knots: list[float], prewhitened: bool = True) -> tuple[float, float]:
    """Score test against other static shapes: p-value, and share of the residual variance explained.

    The alternatives are hinges at `knots` and jumps at the break points, each seen through the fitted dynamics (Rao's
    score test; the model is not fitted again).
    """
    problem, theta = fitted.problem, fitted.fit.theta
    s = problem.structure
    order, first = (s.noise_order, s.first) if prewhitened else (0, s.start)
    if not prewhitened:
        theta = _without_noise(problem, theta)
    eta = theta[problem.eta_at : problem.noise_at]
    jumps = problem.family.edges(fitted.actuator)
    added, first_new = len(knots) + len(jumps), len(problem.family.own) + problem.family.load
    dx, x = np.empty((first_new + added, problem.u.size)), np.empty(problem.u.size)
    problem.family.respond(eta, problem.u, x, dx[:first_new])
    for row, knot in enumerate(knots, first_new):
        np.maximum(problem.u - knot, 0.0, out=dx[row])
    for row, edge in enumerate(jumps, first_new + len(knots)):
        dx[row] = problem.u > edge
    courses, y = problem.family.courses(problem.u.size), problem.y
    if prewhitened:
        x, dx, courses, y = problem.smoothed(x), problem.smoothed(dx), problem.courses, problem.target
    at = problem.eta_at + first_new
    longer = np.concatenate([theta[:at], np.zeros(added), theta[at:]])
    hessian, gradient = np.zeros((longer.size, longer.size)), np.zeros(longer.size)
    cost = normal_equations(
        longer, s.na, s.nb, eta.size + added, order, s.delay, first, problem.segments, x, dx,
        courses, y, hessian, gradient, *((s.zero, problem.early) if prewhitened else (0.0, 0.0)),
    )  # fmt: skip
    index = np.arange(longer.size)
    new = (index >= at) & (index < at + added)
    scale = np.sqrt(np.diag(hessian))
    scale[scale == 0] = 1.0
    hessian, gradient = hessian / np.outer(scale, scale), gradient / scale
    old = hessian[np.ix_(~new, ~new)] + 1e-11 * np.eye(int((~new).sum()))
    cross = hessian[np.ix_(new, ~new)] @ np.linalg.inv(old)
    block = hessian[np.ix_(new, new)] - cross @ hessian[np.ix_(~new, new)]
    score = gradient[new] - cross @ gradient[~new]
    values, vectors = np.linalg.eigh(block)
    seen = values > 1e-8
    explained = float(np.sum((vectors[:, seen].T @ score) ** 2 / values[seen]))
    statistic = explained / max(cost / problem.errors, 1e-300)
    share = explained / max(cost, 1e-300)
    return chi2_tail(statistic, max(int(seen.sum()), 1)), min(share, 1.0)


def _without_noise(problem: Problem, theta: FloatArray) -> FloatArray:
    """The parameters of Output Error; where the noise has a zero, with initial states of their own."""
    s = problem.structure
    if not s.zeros:
        return np.concatenate([theta[: problem.noise_at], theta[problem.initial_at :]])
    plain = replace(problem, structure=replace(s, noise_order=0, zero=0.0, c=()), early=0.0)
    theta = np.concatenate([theta[: problem.noise_at], np.zeros(plain.size - plain.initial_at)])
    return with_states(plain, theta)


@remembered
def _knots(u: FloatArray) -> list[float]:
    """Of the hinges."""
    levels = np.unique(u)  # not the samples: a staircase that rests at zero has its shape elsewhere
    knots = np.unique(np.quantile(levels, np.linspace(0, 1, SHAPE_KNOTS + 2)[1:-1]))
    return [float(knot) for knot in knots]


def residual_tests(fitted: Fitted, errors: list[FloatArray]) -> ResidualTests:
    """Both tests, given the prediction errors of each segment."""
    if fitted.fit.cost <= 1e-20 * float(fitted.problem.y @ fitted.problem.y):
        return ResidualTests(1.0, 1.0, 0.0, 0.0)  # noise-free: nothing is left to test
    s = fitted.problem.structure
    knots = _knots(fitted.problem.u)
    p_shape, share = shape(fitted, knots)
    white = whiteness(errors, s.noise_order + s.zeros)
    return ResidualTests(white, p_shape, share, shape(fitted, knots, prewhitened=False)[1])
