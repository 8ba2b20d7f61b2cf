"""Lines of a periodogram: found where there are some, of the right period, and none in noise."""

import numpy as np
import pytest
from scipy.fft import next_fast_len

from lostmotion.identify.actuators import spectral_lines
from lostmotion.identify.actuators.spectral_lines import (
    FEWEST_PERIODS,
    PADDING,
    SHORTEST_PERIOD,
    dominant,
    lines,
    share_of,
    strongest,
)


def swinging(period, deviation, n=1500, seed=0):
    return np.sin(2.0 * np.pi / period * np.arange(n) + 0.7) + np.random.default_rng(seed).normal(
        scale=deviation, size=n
    )


@pytest.mark.parametrize("period", [7.3, 41.0, 160.7])
def test_a_sine_behind_noise(period):
    found = lines(3.0 + swinging(period, 1.0))
    assert found[0][0] == pytest.approx(period, rel=5e-3)  # a sixteenth of a line
    assert share_of(swinging(period, 1.0), period) == pytest.approx(1.0 / 3.0, abs=0.05)


def test_an_offset_changes_nothing():
    ((period, size),) = lines(swinging(41.0, 1.0))
    assert lines(1e6 + swinging(41.0, 1.0)) == [(period, pytest.approx(size, rel=1e-9))]


def test_noise_has_none():
    assert not lines(np.random.default_rng(1).normal(size=2000))
    assert not lines(np.zeros(20))  # too short to tell a line from its neighbours


def test_two_sines_largest_first():
    found = [period for period, _ in lines(swinging(50.0, 0.3) + 0.5 * swinging(13.0, 0.0))]
    assert found[:2] == pytest.approx([50.0, 13.0], rel=2e-3)


def test_what_a_loop_mostly_does():
    assert dominant(swinging(50.0, 0.3)) == pytest.approx(50.0, rel=2e-3)
    assert dominant(swinging(50.0, 1.5)) is None  # a line, but not most of it
    assert dominant(np.zeros(500)) is None


@pytest.mark.parametrize("n", [150, 257])
@pytest.mark.parametrize("at_once", [0, 1000])
def test_strongest_line_of_a_padded_transform(n, at_once, monkeypatch):
    monkeypatch.setattr(spectral_lines, "AT_ONCE", at_once)
    x = np.random.default_rng(n).normal(size=n) + np.sin(2.0 * np.pi * np.arange(n) / 11.3)
    size = PADDING * next_fast_len(n, real=True)
    power = np.abs(np.fft.rfft(x, size)) ** 2 * 2.0 / n
    low, high = int(np.ceil(FEWEST_PERIODS * size / n)), int(size / SHORTEST_PERIOD)
    for banned in (0.0, 0.05):  # relative distance from the period of the sine
        periods = size / np.arange(low, high)
        allowed = np.where(np.abs(periods / 11.3 - 1.0) < banned, 0.0, power[low:high])
        period, gain = strongest(x, lambda trials, banned=banned: np.abs(trials / 11.3 - 1.0) < banned)
        assert period == pytest.approx(periods[np.argmax(allowed)], rel=1e-12)
        assert gain == pytest.approx(allowed.max(), rel=1e-9)
