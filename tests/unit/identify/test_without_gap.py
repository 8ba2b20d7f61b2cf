"""Healthy characteristics that bend are no dead zones."""

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import Status
from lostmotion.identify.actuators.without_gap import STEEPEST, CurvedFamily

FAMILY = CurvedFamily()
PROCESS = lm.LinearModel((-0.8,), (0.2,), 1)
U = lm.signals.prs(3000, -5, 5, hold=12, seed=3)


def curve(c, u):
    x, dx = np.empty(u.size), np.empty((1, u.size))
    FAMILY.act(np.array([c]), u, x, dx)
    return x, dx[0]


def answered(x, seed=0, deviation=0.1):
    """PV behind the process for what the valve makes of OP."""
    y = lm.Hammerstein(lm.Identity(), PROCESS).simulate(x)
    return y + np.random.default_rng(seed).normal(scale=deviation, size=y.size)


@pytest.mark.parametrize("c", [-2.0, -1e-3, 0.0, 1e-7, 1e-5, 0.3, 2.0])
def test_derivative_of_the_curve(c):
    u = np.linspace(-1.5, 1.5, 7)
    step = 1e-6
    ahead, behind = curve(c + step, u)[0], curve(c - step, u)[0]
    np.testing.assert_allclose(curve(c, u)[1], (ahead - behind) / (2 * step), rtol=1e-6, atol=1e-8)


def test_the_curve_is_a_line_at_0_and_has_the_slope_exp_cu():
    u = np.linspace(-1.0, 1.0, 5)
    np.testing.assert_array_equal(curve(0.0, u)[0], u)
    np.testing.assert_allclose(
        np.gradient(curve(0.7, np.linspace(-1, 1, 20001))[0], 1e-4)[5000], np.exp(-0.35), rtol=1e-6
    )


def test_no_steeper_than_valves_are():
    np.testing.assert_array_equal(FAMILY.valid(np.array([9.0])), [STEEPEST])


BENDS = {
    "two slopes": lambda u: np.where(u < 0.4, u, 0.4 + 0.5 * (u - 0.4)),
    "equal percentages": lambda u: np.expm1(0.15 * u) / 0.15,
    "square root": lambda u: np.sqrt(u + 6.0),
}


@pytest.mark.statistics
@pytest.mark.parametrize("bend", BENDS)
def test_a_healthy_valve_that_bends_has_no_dead_zone(bend):
    y = answered(BENDS[bend](U))
    assert lm.identify(U, y, 1.0).kind.name == "none"
    explicit = lm.identify(U, y, 1.0, nonlinearity="dead zone")
    assert explicit.status not in (Status.OK, Status.WIDE)


@pytest.mark.statistics
@pytest.mark.parametrize("ratio", [1.0, 0.5])
def test_a_dead_zone_is_found_beside_its_bend(ratio):
    zone = lm.DeadZone(-0.4, 0.8, ratio, 1.0)
    fit = lm.identify(U, answered(zone(U)), 1.0)
    assert (fit.kind.name, fit.status) == ("dead zone", Status.OK)
    assert abs(fit.parameters["width"] - 1.2) < 4.0 * fit.standard_errors["width"]
    assert fit.kinds.firm["dead zone"] <= fit.kinds.likelihoods["dead zone"] + 1e-9
