import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lostmotion.diagnose.yamashita import yamashita_index
from lostmotion.errors import DataError
from tests.support.refusals import refusal

T = np.arange(2400)


def test_a_random_path_has_a_quarter():
    """Steps of independent Gaussian moves, one a sample: 2 of the 8 patterns in which something moves."""
    u, y = np.cumsum(np.random.default_rng(0).normal(size=(2, 40000)), axis=1)
    found = yamashita_index(u, y, 7.0)
    assert found.rho1 == pytest.approx(0.25, abs=0.02)
    assert found.rho3 < found.rho1
    assert found.rho2 < found.rho1


def test_a_path_that_follows_has_none_and_one_that_sticks_has_most():
    swing = np.abs((T % 120) - 60.0)
    assert yamashita_index(swing, swing, 120).rho1 < 0.1
    stuck = np.where((T // 60) % 2 == 0, 1.0, -1.0)
    found = yamashita_index(np.roll(swing, 30), stuck, 120)
    assert found.rho1 > 0.6


def test_following_in_the_same_direction_is_what_counts():
    """OP rises by itself, then both rise, then OP falls by itself, then both fall."""
    rise, flat = np.arange(20.0), np.full(20, 20.0)
    u = np.concatenate([rise, 20 + rise, 40 - rise, 20 - rise])
    y = np.concatenate([np.zeros(20), rise, flat, 20 - rise])
    u, y = np.tile(u, 20), np.tile(y, 20)
    found = yamashita_index(u, y, 80)
    assert found.rho1 == pytest.approx(0.5, abs=0.12)
    assert found.rho2 > 0.8 * found.rho1
    assert found.rho3 > 0.8 * found.rho1
    turned = yamashita_index(u, -y, 80)
    assert turned == found


@settings(max_examples=25, deadline=None)
@given(st.floats(1e-6, 1e6), st.floats(-1e3, 1e3), st.integers(0, 5))
def test_units_do_not_matter(scale, shift, seed):
    noise = 0.3 * np.random.default_rng(seed).normal(size=(2, 2400))
    u, y = np.sin(2 * np.pi * T / 44) + noise[0], np.cos(2 * np.pi * T / 44 + 0.7) + noise[1]
    one, other = yamashita_index(u, y, 44), yamashita_index(scale * (u + shift), scale * y - shift, 44)
    assert (other.rho1, other.rho2, other.rho3) == pytest.approx((one.rho1, one.rho2, one.rho3), abs=0.01)


def test_refusals():
    x = np.sin(2 * np.pi * T / 50)
    refusal(DataError, yamashita_index, x[:90], x[:90], 50.0)
    refusal(DataError, yamashita_index, x, x[1:], 50.0)
    refusal(DataError, yamashita_index, x, np.ones(2400), 50.0)
