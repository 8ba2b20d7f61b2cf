import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lostmotion.diagnose.filters import without_trend
from lostmotion.diagnose.halves import cut_halves, relay_answer, sine, triangle
from lostmotion.diagnose.relay import relay_index
from lostmotion.diagnose.shape import shape_index
from lostmotion.errors import DataError, ParameterError
from tests.support.refusals import refusal

T = np.arange(2000)


def wave(form, period, n=2000, phase=0.13):
    """A periodic wave of a half-wave form on 0 to 1, odd about its zero crossings."""
    turn = 2 * (np.arange(n) / period + phase)
    return np.where(turn.astype(int) % 2 == 0, 1, -1) * form(turn % 1.0)


@pytest.mark.parametrize("period", [16.3, 42.0, 150.0, 470.0])
def test_a_sine_is_no_triangle_and_no_relay(period):
    x = np.sin(2 * np.pi * T / period + 0.4)
    assert shape_index(x, period).index < 0.05
    assert relay_index(x, period).index < -0.9


@pytest.mark.parametrize("period", [42.0, 150.7, 470.0])
@pytest.mark.parametrize("apex", [0.2, 0.5, 0.9])
def test_a_triangle_wherever_its_tip(period, apex):
    found = shape_index(wave(lambda s: triangle(s, apex), period), period)
    assert found.index > 0.9
    assert abs(found.halves - 2 * 2000 / period) <= 2
    assert found.spread < 0.05


@pytest.mark.parametrize("lag", [0.1, 0.3, 1.0])
def test_the_answer_to_a_relay(lag):
    """A first order process behind a relay, simulated; not by the formula that is fitted."""
    half, x, y = 40, 0.0, []
    pole = np.exp(-1 / (lag * half))
    for k in range(2000):
        x = pole * x + (1 - pole) * (1.0 if (k // half) % 2 == 0 else -1.0)
        y.append(x)
    assert relay_index(np.array(y), 2 * half).index > 0.6


def test_relay_answer_is_zero_at_both_ends_and_between_square_and_triangle():
    place = np.linspace(0, 1, 101)
    for lag in (0.03, 0.5, 20.0):
        assert relay_answer(place, lag)[[0, -1]] == pytest.approx([0, 0], abs=1e-9)
    assert relay_answer(place, 0.01)[10:90] == pytest.approx(np.ones(80), abs=1e-3)
    long = relay_answer(place, 50.0)
    assert long / long.max() == pytest.approx(triangle(place, 0.5), abs=0.02)


def test_drift_and_noise_do_not_turn_the_answer():
    noise = 0.2 * np.random.default_rng(2).normal(size=2000)
    drift = 0.002 * T + np.sin(2 * np.pi * T / 1500)
    assert shape_index(np.sin(2 * np.pi * T / 60) + noise + drift, 60).index < 0.4
    assert shape_index(wave(lambda s: triangle(s, 0.5), 60) + 0.5 * noise + drift, 60).index > 0.5


def test_trend_removal_leaves_the_oscillation():
    x = np.sin(2 * np.pi * T / 57.3) + 0.2 * np.sin(6 * np.pi * T / 57.3)
    assert without_trend(x + 5 + 0.01 * T, 57.3) == pytest.approx(x, abs=0.02)


@settings(max_examples=25, deadline=None)
@given(st.floats(1e-6, 1e6), st.floats(-1e3, 1e3), st.integers(0, 5), st.sampled_from([-1.0, 1.0]))
def test_units_and_sign_do_not_matter(scale, shift, seed, sign):
    x = wave(lambda s: triangle(s, 0.4), 44) + 0.2 * np.random.default_rng(seed).normal(size=2000)
    y = sign * scale * (x + shift)
    assert shape_index(y, 44).index == pytest.approx(shape_index(x, 44).index, abs=1e-5)
    assert relay_index(y, 44).index == pytest.approx(relay_index(x, 44).index, abs=1e-5)


@pytest.mark.parametrize("index", [shape_index, relay_index])
def test_refusals(index):
    x = np.sin(2 * np.pi * T / 50)
    refusal(DataError, index, x[:90], 50.0)
    refusal(DataError, index, np.ones(100), 20.0)
    refusal(DataError, index, np.sin(2 * np.pi * T / 5), 5.0)
    refusal(ParameterError, index, x, 3.0)
    refusal(ParameterError, index, x, float("nan"))


def test_misfit_is_the_least_squares_one_half_period_after_the_other():
    x = wave(lambda s: triangle(s, 0.4), 44.3) + 0.2 * np.random.default_rng(3).normal(size=2000)
    halves = cut_halves("x", x, 44.3)
    found = halves.misfit(sine(halves.place), 1)
    for number in (0, 7, halves.count - 1):
        mine = halves.owner == number
        values, form = halves.values[mine], np.sin(np.pi * halves.place[mine])
        left = values - form * np.linalg.lstsq(form[:, None], values)[0]
        assert found[number] == pytest.approx(left @ left / mine.sum() * 6 / 5, rel=1e-9)
    assert (np.diff(halves.place)[np.diff(halves.owner) == 0] > 0).all()
    assert (halves.place > 0).all()
    assert (halves.place < 1).all()
