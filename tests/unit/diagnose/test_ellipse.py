import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from lostmotion.diagnose.ellipse import apparent_stiction, fit_ellipse
from lostmotion.errors import DataError, ParameterError
from tests.support.refusals import refusal

T = np.arange(2000)


@settings(max_examples=50, deadline=None)
@given(
    st.floats(0.1, 10), st.floats(0.1, 1), st.floats(0, 3.1), st.floats(-5, 5), st.floats(-5, 5), st.integers(5, 200)
)
@example(0.1, 0.1, 0.97, -5, 2.5, 5)  # far from the origin: three digits were left of the squares
def test_an_ellipse_is_recovered_exactly(major, ratio, angle, at_x, at_y, points):
    minor = ratio * major
    t = 2 * np.pi * np.arange(points) / points + 0.3
    x = at_x + major * np.cos(t) * np.cos(angle) - minor * np.sin(t) * np.sin(angle)
    y = at_y + major * np.cos(t) * np.sin(angle) + minor * np.sin(t) * np.cos(angle)
    a, b, c, d, e, f = fit_ellipse(x, y)
    centre = np.linalg.solve([[2 * a, b], [b, 2 * c]], [-d, -e])
    assert centre == pytest.approx([at_x, at_y], abs=1e-8 * major)
    level = -(f + 0.5 * (d * centre[0] + e * centre[1]))
    published = 2 * major * minor / np.hypot(major * np.sin(angle), minor * np.cos(angle))
    assert 2 * np.sqrt(level / a) == pytest.approx(published, rel=1e-8)


@pytest.mark.parametrize("period", [16.0, 57.3, 200.0])
@pytest.mark.parametrize("degrees", [5.0, 30.0, 90.0, 150.0])
def test_width_of_two_sines(period, degrees):
    """A phase between two sines opens the figure by 2 sin(phase) amplitudes."""
    phi = np.radians(degrees)
    u, y = 30 + 4 * np.sin(2 * np.pi * T / period), 7 * np.sin(2 * np.pi * T / period - phi)
    found = apparent_stiction(u, y, period)
    assert found.width == pytest.approx(8 * np.sin(phi), abs=0.15)
    assert found.share == pytest.approx(np.sin(phi), abs=0.02)
    assert found.misfit < 0.1


def test_width_of_a_dead_band():
    """The path of a backlash of 2 under a sine of amplitude 5: near enough an ellipse, of that width."""
    u, y, x = 5 * np.sin(2 * np.pi * T / 100), [], 0.0
    for value in u:
        x = max(value - 1, min(value + 1, x))
        y.append(x)
    found = apparent_stiction(u, np.array(y), 100)
    assert found.width == pytest.approx(2.0, rel=0.3)
    line = apparent_stiction(u, 3 * u + 1, 100)
    assert (line.width, line.share) == (0.0, 0.0)


@settings(max_examples=25, deadline=None)
@given(st.floats(1e-6, 1e6), st.floats(-1e3, 1e3), st.integers(0, 5), st.sampled_from([-1.0, 1.0]))
def test_width_has_the_units_of_op_only(scale, shift, seed, sign):
    noise = 0.3 * np.random.default_rng(seed).normal(size=(2, 2000))
    u, y = np.sin(2 * np.pi * T / 44) + noise[0], np.cos(2 * np.pi * T / 44 + 0.7) + noise[1]
    one, other = apparent_stiction(u, y, 44), apparent_stiction(sign * scale * (u + shift), scale * y - shift, 44)
    assert other.width == pytest.approx(scale * one.width, rel=1e-5)
    assert other.misfit == pytest.approx(one.misfit, abs=1e-5)


def test_refusals():
    x = np.sin(2 * np.pi * T / 50)
    refusal(DataError, apparent_stiction, x[:90], x[:90], 50.0)
    refusal(DataError, apparent_stiction, x, x[1:], 50.0)
    refusal(DataError, apparent_stiction, x, np.ones(2000), 50.0)
    refusal(ParameterError, apparent_stiction, x, x, 0.0)
    refusal(DataError, fit_ellipse, np.arange(9.0), np.arange(9.0))
    refusal(DataError, fit_ellipse, np.zeros(9), np.zeros(9))
