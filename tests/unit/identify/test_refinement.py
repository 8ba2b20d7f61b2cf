"""Refinement in compiled steps: the same as plain steps of Levenberg-Marquardt, and no other optimiser ends lower."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.backlash import BacklashFamily
from lostmotion.identify.likelihood.problem import Problem, Structure
from lostmotion.identify.likelihood.refinement import MOST_STEPS, is_hopeless, refine, settled
from lostmotion.kernels.products import damped_step
from lostmotion.kernels.refinement import STALL, STALL_GAIN, STEP_GAIN, projected

SEGMENTS = np.array([[0, 200], [200, 400]])


def begun(structure: Structure) -> tuple[Problem, FloatArray]:
    """A problem with a backlash, and a start from which all are found."""
    rng = np.random.default_rng(5)
    u = np.repeat(rng.normal(size=80), 5)
    played = np.empty_like(u)
    at = 0.0
    for k, value in enumerate(u):
        at = min(max(at, value - 0.3), value + 0.3)
        played[k] = at
    y = np.convolve(played, 0.4 * 0.7 ** np.arange(40))[: u.size] + 0.05 * rng.normal(size=u.size)
    problem = Problem(u, y, SEGMENTS, BacklashFamily(float(np.ptp(u)), SEGMENTS), structure)
    theta = np.zeros(problem.size)
    theta[0], theta[structure.na] = -0.6, 0.5
    theta[problem.eta_at] = 0.5
    return problem, theta


def plain(problem: Problem, theta: FloatArray, basis: FloatArray) -> tuple[FloatArray, float, int]:
    """The same steps without shortcuts: every trial with its gradient, nothing kept."""
    theta = problem.project(theta)
    cost, gradient, hessian = problem.evaluate(theta)
    errors, damping, history = max(problem.errors - basis.shape[1], 1), 1e-4, [cost]
    for _ in range(MOST_STEPS):
        step, promised = damped_step(basis.T @ hessian @ basis, basis.T @ gradient, damping)
        variance = cost / errors
        if promised <= STEP_GAIN * variance:
            return theta, cost, len(history)
        trial = problem.project(theta + basis @ step)
        new = problem.evaluate(trial) if problem.admissible(trial) else (np.inf, gradient, hessian)
        if new[0] < cost:
            gained, done = cost - new[0], cost - new[0] <= STEP_GAIN * variance and damping < 1e-2
            theta, (cost, gradient, hessian) = trial, new
            damping = max(damping * (0.1 if gained > 0.5 * promised else 0.5), 1e-12)
        else:
            damping *= 8.0
            done = damping > 1e10
        history.append(cost)
        if done or (len(history) > STALL + 1 and history[-1 - STALL] - cost <= STALL_GAIN * variance):
            return theta, cost, len(history) - 1
    return theta, cost, MOST_STEPS


@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize("structure", [Structure(1, 0, 1, 0, 2), Structure(1, 1, 1, 2, 4), Structure(2, 0, 1, 1, 3)])
def test_steps_are_those_of_the_plain_loop(structure: Structure, held: bool) -> None:
    problem, theta = begun(structure)
    basis = problem.free_but(problem.own) if held else np.eye(problem.size)
    expected, cost, steps = plain(problem, theta, basis)
    found = refine(problem, theta, basis)
    assert found.steps == steps
    assert found.cost == pytest.approx(cost, rel=1e-9)
    np.testing.assert_allclose(found.theta, expected, rtol=1e-6, atol=1e-8)


def test_no_other_optimiser_ends_lower() -> None:
    problem, theta = begun(Structure(1, 0, 1, 0, 2))
    found = refine(problem, theta)

    def root(other: FloatArray) -> FloatArray:
        return np.atleast_1d(np.sqrt(problem.evaluate(problem.project(other))[0]))

    lower = least_squares(root, found.theta, x_scale=np.maximum(np.abs(found.theta), 0.01), max_nfev=50)
    assert float(lower.fun[0] ** 2) >= found.cost * (1.0 - 1e-4)


def test_normal_equations_of_directions() -> None:
    rng = np.random.default_rng(1)
    root, gradient, basis = rng.normal(size=(9, 6)), rng.normal(size=6), np.eye(6)[:, [0, 2, 3]]
    basis[5, 1] = -0.5
    hessian = root.T @ root
    model = projected(np.vstack([hessian, gradient]), basis)
    np.testing.assert_allclose(model[:-1], basis.T @ hessian @ basis, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(model[-1], basis.T @ gradient, rtol=1e-12, atol=1e-12)
    every = projected(np.vstack([hessian, gradient]), np.empty((6, 0)))
    np.testing.assert_array_equal(every, np.vstack([hessian, gradient]))


def test_hopeless_is_what_ends_far_above_its_bound() -> None:
    problem, theta = begun(Structure(1, 1, 1, 1, 2))
    end = refine(problem, settled(problem, theta))
    near = problem.evaluate(end.theta)
    assert not is_hopeless(problem, theta, None, 1.01 * end.cost)
    assert is_hopeless(problem, end.theta, None, 0.5 * near[0])
    assert not is_hopeless(problem, end.theta, None, np.inf)


def test_a_target_that_is_reached_ends_it() -> None:
    problem, theta = begun(Structure(1, 1, 1, 2, 4))
    whole = refine(problem, theta)
    begin = problem.evaluate(problem.project(theta))[0]
    target = 0.5 * (begin + whole.cost)
    found = refine(problem, theta, target=target)
    assert whole.cost < found.cost <= target
    assert found.steps < whole.steps
    assert not found.converged
    assert refine(problem, theta, target=0.5 * whole.cost).cost == whole.cost


def test_a_tolerance_is_all_that_is_missing_where_the_actuator_is_held() -> None:
    """Where it moves there are kinks, at which a step promises less than is to be had."""
    problem, theta = begun(Structure(1, 1, 1, 2, 4))
    basis = problem.free_but(problem.own)
    whole, found = refine(problem, theta, basis), refine(problem, theta, basis, tolerance=0.5)
    assert found.steps < whole.steps
    assert found.converged
    assert 0.0 <= found.cost - whole.cost < 0.5 * whole.cost / problem.errors
