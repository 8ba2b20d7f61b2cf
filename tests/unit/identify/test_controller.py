from types import SimpleNamespace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.diagnose.loop_stability import EXACT, LIGHTLY_DAMPED, LoopStability, loop_stability
from lostmotion.identify.data import collect

LAG = lm.LinearModel([-0.8], [0.4], 2)
LEVEL = lm.LinearModel([-1.0], [0.1], 1)


def fitted(linear, u, y, dt=1.0):
    """What loop_stability reads of a fit."""
    return SimpleNamespace(linear=linear, data=collect(u, y, dt))


def simulated(linear, kp, ki, sp, dt=1.0, noise=0.0, **controller):
    loop = lm.simulate_loop(linear, lm.PI(kp, ki, **controller), sp, dt=dt, noise=noise, seed=0, allow_unstable=True)
    return loop.control, loop.measured


@pytest.mark.parametrize(("kp", "ki"), [(0.3, 0.05), (0.8, 0.2), (-0.2, -0.01)])
def test_pi_is_recovered_exactly(kp, ki):
    sp = lm.signals.prs(300, -1, 1, 20, seed=1)
    linear = LAG if kp > 0 else lm.LinearModel([-0.8], [-0.4], 2)
    u, y = simulated(linear, kp, ki, sp, bias=3.0)
    found = loop_stability(fitted(linear, u, y), sp)
    assert (found.kp, found.ki) == pytest.approx((kp, ki), rel=1e-8)
    assert found.unexplained < 1e-12


def test_integral_gain_counts_samples():
    sp = lm.signals.prs(300, -1, 1, 20, seed=1)
    slow = lm.LinearModel([-0.8], [0.4], 2, dt=0.5)
    u, y = simulated(slow, 0.3, 0.1, sp, dt=0.5)
    assert loop_stability(fitted(slow, u, y, 0.5), sp).ki == pytest.approx(0.1 * 0.5, rel=1e-8)


def test_constant_set_point_need_not_be_known():
    rng = np.random.default_rng(2)
    u, y = simulated(LAG, 0.3, 0.05, np.full(500, 5.0), noise=rng.normal(size=500))
    blind, seeing = loop_stability(fitted(LAG, u, y), None), loop_stability(fitted(LAG, u, y), np.full(500, 5.0))
    assert (blind.kp, blind.ki) == pytest.approx((0.3, 0.05), rel=1e-8)
    assert (seeing.kp, seeing.ki) == pytest.approx((blind.kp, blind.ki), rel=1e-8)


def test_pieces_are_not_joined():
    sp = lm.signals.prs(400, -1, 1, 20, seed=1)
    u, y = simulated(LAG, 0.3, 0.05, sp)
    kept = np.r_[0:150, 220:400]
    data = collect([lm.LoopRecord(u[a:b], y[a:b], dt=1.0) for a, b in ((0, 150), (220, 400))], None, None, raw=True)
    found = loop_stability(SimpleNamespace(linear=LAG, data=data), sp[kept])
    assert (found.kp, found.ki) == pytest.approx((0.3, 0.05), rel=1e-8)
    assert found.unexplained < 1e-12


@pytest.mark.parametrize(("kp", "ki"), [(1.0, 0.5), (2.0, 1.0), (6.0, 3.0)])
def test_damping_of_a_level_loop_by_hand(kp, ki):
    """z^2 - (2 - g (kp + ki)) z + 1 - g kp = 0: modulus sqrt(1 - g kp), angle from the middle term."""
    sp = lm.signals.prs(300, -1, 1, 20, seed=1)
    found = loop_stability(fitted(LEVEL, *simulated(LEVEL, kp, ki, sp)), sp)
    g = LEVEL.b[0]
    modulus = np.sqrt(1.0 - g * kp)
    angle = np.arccos((2.0 - g * (kp + ki)) / (2.0 * modulus))
    decay = -np.log(modulus)
    assert found.damping == pytest.approx(decay / np.hypot(decay, angle), rel=1e-6)
    assert found.period == pytest.approx(2 * np.pi / angle, rel=1e-6)


def test_an_unstable_loop_has_negative_damping():
    u, y = simulated(LEVEL, -0.5, 0.8, np.r_[np.zeros(5), np.ones(75)])
    found = loop_stability(fitted(LEVEL, u, y), np.r_[np.zeros(5), np.ones(75)])
    assert found.damping < 0.0


def test_real_roots_do_not_oscillate():
    """kp = 4 ki cancels the pole at 0.8; z^2 - z + 0.125 = 0 is left, with two real roots."""
    lag = lm.LinearModel([-0.8], [0.2], 1)
    sp = lm.signals.prs(300, -1, 1, 20, seed=1)
    found = loop_stability(fitted(lag, *simulated(lag, 0.2, 0.05, sp)), sp)
    assert found.damping == 1.0
    assert found.period == np.inf


def test_a_disturbed_op_is_no_pi():
    sp = lm.signals.prs(500, -1, 1, 20, seed=1)
    u, y = simulated(LAG, 0.3, 0.05, sp)
    pushed = u + np.random.default_rng(0).normal(size=u.size)
    assert loop_stability(fitted(LAG, pushed, y), sp).unexplained > 0.5


@pytest.mark.parametrize(
    ("unexplained", "damping", "period", "own"),
    [
        (0.0, 0.05, 20.0, True),
        (0.0, -0.05, 20.0, True),
        (0.0, 0.05, 31.0, True),
        (0.0, 0.05, 33.0, False),
        (0.0, 0.05, 12.0, False),
        (0.0, LIGHTLY_DAMPED + 0.01, 20.0, False),
        (EXACT + 0.01, 0.05, 20.0, False),
        (0.0, 1.0, np.inf, False),
    ],
)
def test_which_oscillation_is_the_loops_own(unexplained, damping, period, own):
    assert LoopStability(1.0, 0.1, unexplained, damping, period).explains(20.0) is own
