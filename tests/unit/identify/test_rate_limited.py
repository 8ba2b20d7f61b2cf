"""A valve that is slow meets no stop."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

import lostmotion as lm
from lostmotion.identify.actuators.rate_limited import RateLimitedFamily

FAMILY = RateLimitedFamily(1e-6)
PROCESS = lm.LinearModel((-0.8,), (0.2,), 1)
COMMANDS = hnp.arrays(float, st.integers(1, 60), elements=st.floats(-10.0, 10.0))


def position(u, up, down):
    x, dx = np.empty(u.size), np.empty((2, u.size))
    FAMILY.act(np.array([up, down]), u, x, dx)
    return x, dx


@given(COMMANDS, st.floats(0.01, 5.0), st.floats(0.01, 5.0))
def test_no_faster_than_its_rates_and_never_past_its_command(u, up, down):
    x = position(u, up, down)[0]
    expected = [u[0]]
    for v in u[1:]:
        expected.append(expected[-1] + float(np.clip(v - expected[-1], -down, up)))
    np.testing.assert_allclose(x, expected, atol=1e-9)
    moves = np.diff(x)
    assert (moves <= up + 1e-9).all()
    assert (moves >= -down - 1e-9).all()


def test_derivatives():
    u, step = np.random.default_rng(1).normal(scale=3.0, size=200), 1e-7
    dx = position(u, 0.7, 1.1)[1]
    for row, moved in enumerate(((step, 0.0), (0.0, step))):
        ahead, behind = (position(u, 0.7 + sign * moved[0], 1.1 + sign * moved[1])[0] for sign in (1.0, -1.0))
        np.testing.assert_allclose(dx[row], (ahead - behind) / (2 * step), atol=1e-6)


def slow_loop(stops=None):
    """OP of steps before a valve that is slow, or has stops, and PV behind the process."""
    u = np.repeat(np.random.default_rng(3).uniform(-5.0, 5.0, 75), 40)
    x = position(u, 0.4, 0.4)[0] if stops is None else np.clip(u, *stops)
    y = lm.Hammerstein(lm.Identity(), PROCESS).simulate(x)
    return u, y + np.random.default_rng(4).normal(scale=0.1, size=y.size)


@pytest.mark.statistics
def test_a_slow_valve_is_no_saturation():
    fit = lm.identify(*slow_loop(), 1.0)
    assert fit.kind.name != "saturation"
    assert fit.kinds.firm.get("saturation", 0.0) < 3.0
    explicit = lm.identify(*slow_loop(), 1.0, nonlinearity="saturation")
    assert not explicit.status.ok


@pytest.mark.statistics
def test_stops_are_found():
    fit = lm.identify(*slow_loop((-3.0, 3.5)), 1.0)
    assert fit.kind.name == "saturation"
    assert abs(fit.parameters["high"] - 3.5) < 0.1


@pytest.mark.statistics
def test_a_slow_valve_is_no_dead_zone_either():
    """The dead zone that fits best is weighed against the valve that is slow."""
    fit = lm.identify(*slow_loop(), 1.0, nonlinearity="dead zone")
    assert not fit.status.ok
    assert fit.evidence.gain_over_healthy is not None
    assert fit.evidence.gain_over_healthy < 0.0
