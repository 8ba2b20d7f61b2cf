import numpy as np
import pytest
import scipy.signal
from hypothesis import given, settings
from hypothesis import strategies as st

from lostmotion.diagnose.bicoherence import bicoherence_indices
from lostmotion.errors import DataError
from tests.support.refusals import refusal

WHITE, SLOW, RESONANT = [1.0], [1.0, -0.9], [1.0, -1.8, 0.97]


def noise(a, seed, n=2000):
    return scipy.signal.lfilter([1.0], a, np.random.default_rng(seed).normal(size=n + 500))[500:]


def naive(x, k, m, size=64):
    """Squared bicoherence at one bifrequency, straight from the definition."""
    window = [0.5 - 0.5 * np.cos(2 * np.pi * (j + 0.5) / size) for j in range(size)]
    spectra = []
    for start in range(0, x.size - size + 1, size // 2):
        part = x[start : start + size]
        spectra.append(np.fft.fft((part - part.mean()) * window))
    top = np.mean([s[k] * s[m] * np.conj(s[k + m]) for s in spectra])
    below = np.mean([abs(s[k] * s[m]) ** 2 for s in spectra]) * np.mean([abs(s[k + m]) ** 2 for s in spectra])
    return abs(top) ** 2 / below


@pytest.mark.statistics
@pytest.mark.parametrize("a", [WHITE, SLOW, RESONANT])
@pytest.mark.parametrize("n", [500, 2000])
def test_linear_gaussian_noise_is_gaussian(a, n):
    """5 % of false alarms are asked for; 300 records leave a standard error of 1.3 %."""
    passed = [bicoherence_indices(noise(a, seed, n)).ngi <= 0 for seed in range(300)]
    assert np.mean(passed) > 0.95 - 2 * 0.013


def test_the_largest_is_the_definition():
    x = noise(WHITE, 3) ** 2
    found = bicoherence_indices(x)
    k, m = round(64 * found.f1), round(64 * found.f2)
    largest = naive(x, k, m)
    others = [naive(x, i, j) for i, j in [(5, 3), (10, 10), (20, 4), (2, 2)]]
    assert max(others) <= largest + 1e-6
    assert 0 < found.nli < largest <= 1
    assert found.segments == 61


def test_a_squared_sine_couples_phases():
    """A sine of random phase with its own square: bifrequency (f, f), and none once the second phase is free."""
    rng = np.random.default_rng(0)
    t, f = np.arange(256), 8 / 64
    phases = rng.uniform(0, 2 * np.pi, (60, 2))
    coupled = np.concatenate(
        [np.cos(2 * np.pi * f * t + p) + 0.5 * np.cos(4 * np.pi * f * t + 2 * p) for p, _ in phases]
    )
    free = np.concatenate([np.cos(2 * np.pi * f * t + p) + 0.5 * np.cos(4 * np.pi * f * t + q) for p, q in phases])
    more = 0.1 * rng.normal(size=coupled.size)
    found, none = bicoherence_indices(coupled + more), bicoherence_indices(free + more)
    assert found.ngi > 0.01
    assert found.nli > 0.5
    assert naive(coupled + more, 8, 8) > 0.9
    assert none.ngi < found.ngi / 3
    assert naive(free + more, 8, 8) < 0.3


def test_a_skewed_nonlinearity_is_seen():
    x = noise(SLOW, 1)
    found = bicoherence_indices(np.maximum(x, 0.0))
    assert found.ngi > 0.001
    assert found.nli > 0.01


@settings(max_examples=25, deadline=None)
@given(st.floats(1e-6, 1e6), st.floats(-1e3, 1e3), st.integers(0, 5), st.sampled_from([-1.0, 1.0]))
def test_units_and_sign_do_not_matter(scale, shift, seed, sign):
    x = np.maximum(noise(SLOW, seed), 0.0)
    one, other = bicoherence_indices(x), bicoherence_indices(sign * scale * (x + shift))
    assert other.ngi == pytest.approx(one.ngi, abs=1e-6)
    assert other.nli == pytest.approx(one.nli, abs=1e-6)


def test_a_slow_oscillation_gets_longer_segments():
    x = np.sin(2 * np.pi * np.arange(4000) / 100) + noise(WHITE, 0, 4000)
    assert bicoherence_indices(x, 100.0).segments == 4000 // 200 - 1
    assert bicoherence_indices(x, 10.0).segments == bicoherence_indices(x).segments


def test_refusals():
    refusal(DataError, bicoherence_indices, noise(WHITE, 0, 159))
    refusal(DataError, bicoherence_indices, noise(WHITE, 0, 900), 100.0)
    refusal(DataError, bicoherence_indices, np.ones(1000))
    bicoherence_indices(noise(WHITE, 0, 160))
