import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lostmotion.diagnose.cross_correlation import cross_correlation_index
from lostmotion.errors import DataError, ParameterError
from tests.support.refusals import refusal

T = np.arange(3000)


@pytest.mark.parametrize("period", [16.0, 60.0, 300.0])
@pytest.mark.parametrize("degrees", [0.0, 30.0, 60.0, 90.0])
def test_the_measures_are_those_of_two_sines(period, degrees):
    """cos(tau + phi) crosses zero at +-90 degrees - phi; the published limits are those of 30 and 60 degrees."""
    phi = np.radians(degrees)
    u, y = np.sin(2 * np.pi * T / period), -np.sin(2 * np.pi * T / period + phi)
    found = cross_correlation_index(u, y, period)
    assert found.delta_tau == pytest.approx(degrees / 90, abs=0.04)
    assert found.delta_rho == pytest.approx((1 - np.cos(phi)) / (1 + np.cos(phi)), abs=0.04)
    assert found.at_zero == pytest.approx(-np.cos(phi), abs=0.03)


def test_the_published_limits():
    limits = [(1 - np.cos(phi)) / (1 + np.cos(phi)) for phi in np.radians([30, 60])]
    assert limits == pytest.approx([0.072, 1 / 3], abs=1e-3)


def test_a_sticking_valve_is_odd_and_a_disturbance_even():
    half = 50
    flow = np.where((T // half) % 2 == 0, 1.0, -1.0)  # what a sticking valve does to a fast process
    output = -np.cumsum(flow) / half  # integral action
    noise = 0.1 * np.random.default_rng(0).normal(size=(2, 3000))
    found = cross_correlation_index(output + noise[0], flow + noise[1], 2 * half)
    assert found.delta_tau > 2 / 3
    assert found.delta_rho > 1 / 3
    swing = np.sin(2 * np.pi * T / 100)
    found = cross_correlation_index(swing + noise[0] + 0.01 * T, -swing + noise[1], 2 * half)
    assert found.delta_tau < 1 / 3
    assert found.delta_rho < 0.072


@settings(max_examples=25, deadline=None)
@given(st.floats(1e-6, 1e6), st.floats(-1e3, 1e3), st.integers(0, 5), st.sampled_from([-1.0, 1.0]))
def test_units_do_not_matter_and_a_sign_turns_only_the_correlation(scale, shift, seed, sign):
    noise = 0.3 * np.random.default_rng(seed).normal(size=(2, 3000))
    u, y = np.sin(2 * np.pi * T / 44) + noise[0], np.cos(2 * np.pi * T / 44 + 0.7) + noise[1]
    one, other = cross_correlation_index(u, y, 44), cross_correlation_index(scale * (u + shift), sign * scale * y, 44)
    assert other.delta_rho == pytest.approx(one.delta_rho, abs=1e-5)
    assert other.delta_tau == pytest.approx(one.delta_tau, abs=1e-5)
    assert other.at_zero == pytest.approx(sign * one.at_zero, abs=1e-5)


def test_refusals():
    x = np.sin(2 * np.pi * T / 50)
    refusal(DataError, cross_correlation_index, x[:90], x[:90], 50.0)
    refusal(DataError, cross_correlation_index, x, x[:-1], 50.0)
    refusal(DataError, cross_correlation_index, x, np.ones(3000), 50.0)
    refusal(ParameterError, cross_correlation_index, x, x, 2.0)
