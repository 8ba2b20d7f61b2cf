"""Accuracy against the Cramer-Rao bound, few seeds; benchmarks/accuracy.py runs many."""

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.evaluate import cramer_rao

pytestmark = pytest.mark.statistics
TANK = lm.platforms.level_tank()
SEEDS = 24


def noisy(model: lm.Hammerstein, u: np.ndarray, seed: int) -> np.ndarray:
    return model.simulate(u) + np.random.default_rng(seed + 10_000).normal(scale=0.03**0.5, size=u.size)


def test_open_loop_reaches_the_bound():
    ratios, covered = [], []
    for seed in range(SEEDS):
        u = lm.signals.prs(2000, -5, 5, hold=10, seed=seed)
        fit = lm.identify(
            u, noisy(TANK, u, seed), 0.1, orders=(3, 2, 3), gain=TANK.linear.gain, nonlinearity="dead zone"
        )
        assert fit.status.ok
        bound = cramer_rao(TANK, u, 0.03, gain=TANK.linear.gain, offset="zero")
        for name, truth in (("left", -1.0), ("right", 1.0), ("slope_ratio", 1.0)):
            ratios.append((fit.parameters[name] - truth) / bound[name])
            low, high = fit.interval(name)
            covered.append(low <= truth <= high)
    # 24 seeds of three nearly independent ratios: the root mean square of an efficient estimator is 1 +- 0.09
    assert np.sqrt(np.mean(np.square(ratios))) < 1.25
    assert np.mean(covered) > 0.87


def test_routine_closed_loop_with_drift():
    errors, covered = [], []
    for seed in range(10):
        loop = lm.routine_operation(6000, "mild", seed)
        fit = lm.identify(loop.command, loop.measured, 0.1, orders=(3, 2, 3), nonlinearity="dead zone")
        for name, truth in (("left", -1.0), ("right", 1.0)):
            errors.append(abs(fit.parameters[name] - truth))
            low, high = fit.interval(name)
            covered.append(low <= truth <= high)
    assert np.median(errors) < 0.01
    assert np.mean(covered) >= 0.8


def test_asymmetric_zone_off_centre():
    model = lm.Hammerstein(lm.DeadZone(2.0, 4.3, 4.0, 1.0), TANK.linear, offset=12.0)
    for seed in range(6):
        u = lm.signals.prs(2000, -2, 9, hold=10, seed=seed)
        fit = lm.identify(
            u, noisy(model, u, seed), 0.1, orders=(3, 2, 3), gain=TANK.linear.gain, nonlinearity="dead zone"
        )
        for name, truth in (("left", 2.0), ("right", 4.3), ("left_slope", 4.0), ("right_slope", 1.0)):
            assert abs(fit.parameters[name] - truth) < 4.0 * fit.standard_errors[name]


def test_no_dead_zone_is_said():
    model = lm.Hammerstein(lm.Identity(), TANK.linear)
    said = 0
    for seed in range(SEEDS):
        u = lm.signals.prs(2000, -5, 5, hold=10, seed=seed)
        fit = lm.identify(u, noisy(model, u, seed), 0.1, orders=(3, 2, 3), nonlinearity="dead zone")
        said += fit.status is lm.Status.NOT_SEEN and fit.interval("width")[0] == 0.0
        assert fit.interval("width")[1] < 1.0
    assert said >= SEEDS - 2


def test_auto_structure_finds_the_delay():
    found = []
    for seed in range(8):
        u = lm.signals.prs(2000, -5, 5, hold=10, seed=seed)
        fit = lm.identify(u, noisy(TANK, u, seed), 0.1, nonlinearity="dead zone")
        found.append(fit.linear.delay == 3 and abs(fit.parameters["right"] - 1) < 4 * fit.standard_errors["right"])
    assert sum(found) >= 7


def test_bound_against_numerical_information():
    """Slow twin of the bound: Fisher information from differences of the simulated output."""
    u = lm.signals.prs(400, -5, 5, hold=10, seed=3)
    zone, linear = TANK.nonlinearity, TANK.linear
    theta = np.array([*linear.a, *(3.0 * b for b in linear.b), 0.0, zone.left, zone.right, 1.0])

    def output(t: np.ndarray) -> np.ndarray:
        model = lm.Hammerstein(
            lm.DeadZone(t[7], t[8], t[9], 1.0), lm.LinearModel(tuple(t[:3]), tuple(t[3:6]), 3, 0.1), t[6]
        )
        return model.simulate(u)

    step = 1e-6
    jacobian = np.array([(output(theta + h) - output(theta - h)) / (2 * step) for h in step * np.eye(10)]).T
    impulse = np.zeros(400)
    impulse[0] = 1.0
    response = lm.LinearModel(linear.a, (1.0,), 0, 0.1).simulate(impulse)
    states = np.array([np.concatenate([np.zeros(3 + i), response[: 397 - i]]) for i in range(3)]).T
    full = np.hstack([jacobian, states])[3:]
    covariance = 0.03 * np.linalg.inv(full.T @ full)
    bound = cramer_rao(TANK, u, 0.03)
    assert bound["left"] == pytest.approx(np.sqrt(covariance[7, 7]), rel=1e-3)
    assert bound["right"] == pytest.approx(np.sqrt(covariance[8, 8]), rel=1e-3)
    assert bound["slope_ratio"] == pytest.approx(np.sqrt(covariance[9, 9]), rel=1e-3)
