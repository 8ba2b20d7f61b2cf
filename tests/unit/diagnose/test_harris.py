import numpy as np
import pytest
import scipy.signal
from hypothesis import given, settings
from hypothesis import strategies as st

from lostmotion.diagnose.harris import harris_index
from lostmotion.errors import DataError, ParameterError
from tests.support.refusals import refusal


def shaped(top, below, seed=0, n=20000):
    return scipy.signal.lfilter(top, below, np.random.default_rng(seed).normal(size=n + 500))[500:]


@pytest.mark.parametrize("delay", [1, 3, 8])
def test_minimum_variance_control_has_one(delay):
    """What it leaves is a moving average of as many terms as the delay."""
    error = shaped(0.9 ** np.arange(delay), [1.0])
    assert harris_index(50 + error, 50.0, delay).low == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize("delay", [1, 2, 5])
@pytest.mark.parametrize("pole", [0.5, 0.9, 0.98])
def test_an_autoregressive_error_has_its_theoretical_index(delay, pole):
    found = harris_index(shaped([1.0], [1.0, -pole], n=100_000), 0.0, delay)
    assert found.low == pytest.approx(1 - pole ** (2 * delay), abs=0.02)
    assert found.minimum_variance[0] == pytest.approx(sum(pole ** (2 * k) for k in range(delay)), rel=0.03)
    assert found.minimum_variance[0] / found.variance == pytest.approx(found.low, rel=1e-9)


def test_a_simulated_loop_under_its_minimum_variance_controller():
    """y(k) = 0.8 y(k-1) + u(k-2) + e(k), u = -0.64 y / (1 + 0.8 q^-1): Astrom's law leaves e(k) + 0.8 e(k-1)."""
    rng = np.random.default_rng(1)
    tight, slack = [], []
    for gain, out in ((1.0, tight), (0.3, slack)):
        y = u1 = u2 = 0.0
        for e in rng.normal(size=20000):
            y = 0.8 * y + u2 + e
            u1, u2 = -gain * 0.64 * y - 0.8 * u1, u1
            out.append(y)
    assert harris_index(tight, 0.0, 2).low == pytest.approx(1.0, abs=0.02)
    assert np.var(tight) == pytest.approx(1.64, rel=0.05)
    assert harris_index(slack, 0.0, 2).low < 0.97


def test_a_range_of_delays_gives_a_range():
    error = shaped([1.0], [1.0, -0.9])
    found = harris_index(error, 0.0, (1, 6))
    assert found.low == pytest.approx(harris_index(error, 0.0, 1).low, rel=1e-2)  # five rows fewer
    assert found.high == pytest.approx(harris_index(error, 0.0, 6).high, rel=1e-12)
    assert found.low < found.high
    assert (found.shortest, found.longest) == (1, 6)


def test_it_is_the_regression():
    error = shaped([1.0], [1.0, -0.9], n=400)
    error -= error.mean()
    design = np.array([[*error[k - 3 - 4 : k - 3 + 1], 1.0] for k in range(7, 400)])
    residual = error[7:] - design @ np.linalg.lstsq(design, error[7:])[0]
    expected = residual @ residual / (393 - 6)
    assert harris_index(error, 0.0, 3, order=5).minimum_variance[0] == pytest.approx(expected, rel=1e-9)


@settings(max_examples=25, deadline=None)
@given(st.floats(1e-6, 1e6), st.floats(-1e3, 1e3), st.integers(0, 5), st.sampled_from([-1.0, 1.0]))
def test_units_and_offset_do_not_matter(scale, shift, seed, sign):
    error = shaped([1.0], [1.0, -0.9], seed, 1000)
    one, other = harris_index(error, 0.0, 3), harris_index(sign * scale * (error + shift), scale, 3)
    assert other.low == pytest.approx(one.low, rel=1e-6)
    assert other.variance == pytest.approx(scale**2 * one.variance, rel=1e-6)


def test_refusals():
    error = shaped([1.0], [1.0], n=100)
    refusal(ParameterError, harris_index, error, 0.0, 0)
    refusal(ParameterError, harris_index, error, 0.0, (4, 2))
    refusal(ParameterError, harris_index, error, 0.0, (1, 2, 3))
    refusal(ParameterError, harris_index, error, 0.0, 1, 0)
    refusal(DataError, harris_index, error, 0.0, 22)
    assert harris_index(error, 0.0, 21).low > 0
    refusal(DataError, harris_index, error, error, 1)
    refusal(DataError, harris_index, error, error[1:], 1)
