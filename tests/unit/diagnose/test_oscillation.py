import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lostmotion.diagnose.oscillation import find_oscillation
from lostmotion.errors import DataError
from tests.support.refusals import refusal

T = np.arange(1200)


@pytest.mark.parametrize("period", [7.3, 16.0, 41.7, 130.0, 300.0])
@pytest.mark.parametrize("drift", [0.0, 0.02])
def test_a_sine_on_a_drift_is_found(period, drift):
    found = find_oscillation(np.sin(2 * np.pi * T / period + 1.0) + drift * T)
    assert found.period == pytest.approx(period, rel=0.02)
    assert found.regular
    assert found.share > 0.95
    assert found.cycles == pytest.approx(1200 / period, rel=0.02)


def test_a_slow_wander_larger_than_the_oscillation_does_not_hide_it():
    rng = np.random.default_rng(1)
    x = np.sin(2 * np.pi * T / 50) + 3 * np.sin(2 * np.pi * T / 900) + 0.03 * np.cumsum(rng.normal(size=1200))
    found = find_oscillation(x + 0.2 * rng.normal(size=1200))
    assert found.period == pytest.approx(50, rel=0.03)
    assert found.regular


def test_harmonics_count_as_the_oscillation_and_noise_does_not():
    square = np.sign(np.sin(2 * np.pi * (T + 0.5) / 60))
    noise = np.random.default_rng(0).normal(size=1200)
    five = 8 / np.pi**2 * (1 + 1 / 9 + 1 / 25)  # what a square wave has up to its fifth harmonic
    assert find_oscillation(square).share == pytest.approx(five, abs=0.005)
    half = find_oscillation(np.sin(2 * np.pi * T / 60) + noise * np.sqrt(0.5))
    assert 0.45 < half.share < 0.7  # half of the variance is noise, some of it near the harmonics


@pytest.mark.statistics
def test_white_noise_does_not_oscillate():
    found = [find_oscillation(np.random.default_rng(seed).normal(size=1000)) for seed in range(100)]
    assert sum(one.regular and one.share > 0.6 for one in found) <= 5


@settings(max_examples=25, deadline=None)
@given(st.floats(1e-6, 1e6), st.floats(-1e3, 1e3), st.integers(0, 5), st.sampled_from([-1.0, 1.0]))
def test_units_and_sign_do_not_matter(scale, shift, seed, sign):
    x = np.sin(2 * np.pi * T / 44) + 0.5 * np.random.default_rng(seed).normal(size=1200)
    one, other = find_oscillation(x), find_oscillation(sign * scale * (x + shift))
    assert other.period == pytest.approx(one.period, rel=1e-6)
    assert other.share == pytest.approx(one.share, rel=1e-6)


def test_refusals():
    assert "32" in refusal(DataError, find_oscillation, np.arange(31.0))
    refusal(DataError, find_oscillation, np.full(100, 3.0))
    refusal(DataError, find_oscillation, np.array([np.nan] * 100))
    found = find_oscillation(np.arange(100.0) + 1e-3 * np.random.default_rng(0).normal(size=100))
    assert np.isfinite([found.period, found.regularity, found.share]).all()
    found = find_oscillation(np.arange(100.0))  # nothing but a line
    assert np.isfinite([found.period, found.regularity, found.share]).all()
