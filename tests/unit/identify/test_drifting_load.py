"""Noise of a level: a load that drifts, and white noise of measurement."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import lfilter

from lostmotion.identify.likelihood.drifting_load import DriftingLoad, LevelFit, LevelLikelihood
from lostmotion.identify.scaled import ScaledData

NOISE = DriftingLoad(np.log(1 / 300), np.log(1e-5))


def level(n: int, gain: float, delay: int, seed: int, noise: float = 0.0, load: float = 0.0):
    """A held OP of steps, and the level behind it, in scaled units."""
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.normal(size=n // 20 + 1), 20)[:n]
    drift = lfilter([1.0], [1.0, -NOISE.pole], rng.normal(scale=load, size=n))
    late = np.concatenate([np.full(delay, u[0]), u])[:n]
    y = np.cumsum(gain * (late + drift))
    return ScaledData(u, y + noise * rng.normal(size=n), np.array([[0, n]]))


@given(st.floats(-10.0, -3.0), st.floats(-25.0, 3.0))
def test_c_has_the_spectrum_of_load_and_noise(log_rate, log_ratio):
    noise = DriftingLoad(log_rate, log_ratio)
    z = np.exp(-1j * np.linspace(0.01, np.pi, 50))
    both = np.exp(log_ratio) + abs((1 - z) * (1 - noise.pole * z)) ** 2
    c = 1.0 + noise.c[0] * z + noise.c[1] * z**2
    shares = both / abs(c) ** 2
    np.testing.assert_allclose(shares, shares.mean(), rtol=1e-6)
    assert max(abs(np.roots([1.0, *noise.c]))) < 1.0


@pytest.mark.parametrize("every", [1, 4])
def test_a_level_without_noise_is_found_exactly(every):
    data = level(2000, 0.03, 5, 1)
    found = LevelLikelihood(data, 12, every).with_best_delay(data.u, LevelFit(NOISE, 1, 0.0, 1.0))
    assert found.delay == 5
    assert found.gain == pytest.approx(0.03, rel=1e-6)
    assert found.cost < 1e-12


def test_what_the_noise_is_made_of_is_found():
    data = level(20_000, 0.03, 5, 2, noise=0.5, load=0.05)
    likelihood = LevelLikelihood(data, 10)
    found = likelihood.with_best_delay(data.u, likelihood.best(data.u, None))
    assert found.gain == pytest.approx(0.03, rel=0.05)
    assert found.noise.log_ratio == pytest.approx(2 * np.log(0.03 * 0.05 / 0.5), abs=0.5)
    assert found.noise.log_rate == pytest.approx(NOISE.log_rate, abs=0.7)
    assert found.cost == pytest.approx(0.25 * 20_000, rel=0.1)


def test_blocks_say_the_same_as_rows():
    data = level(20_000, 0.03, 5, 3, noise=0.5, load=0.05)
    found = []
    for every in (1, 5):
        likelihood = LevelLikelihood(data, 10, every)
        fit = likelihood.with_best_delay(data.u, likelihood.best(data.u, None))
        noise = fit.noise.over(1 / every)
        found.append((fit.gain, noise.log_ratio, noise.log_rate, likelihood.gain_of(fit, likelihood.still())))
    np.testing.assert_allclose(found[1], found[0], rtol=0.1)


def test_a_valve_that_acts_the_other_way_has_no_gain():
    data = level(2000, -0.03, 5, 4, noise=0.1)
    assert LevelLikelihood(data, 10).best(data.u, None).gain == 0.0


def test_segments_begin_anew():
    first, second = level(2000, 0.03, 5, 5), level(1500, 0.03, 5, 6)
    u, y = np.concatenate([first.u, second.u]), np.concatenate([first.y, second.y + 3.0])
    joined = ScaledData(u, y, np.array([[0, 2000], [2000, 3500]]))
    found = LevelLikelihood(joined, 10, 3).with_best_delay(joined.u, LevelFit(NOISE, 1, 0.0, 1.0))
    assert (found.delay, found.gain) == (5, pytest.approx(0.03, rel=1e-6))


def test_memory_is_that_of_the_slowest_zero():
    assert DriftingLoad(np.log(1e-6), np.log(1e-8)).memory == pytest.approx(1e2 * np.sqrt(2.0), rel=0.02)
