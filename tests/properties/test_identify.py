from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lostmotion as lm

pytestmark = pytest.mark.statistics
ORDERS = (1, 0, 1)
SIZE = st.floats(-3, 3).map(lambda power: 10.0**power)
SHIFT = st.floats(-1e3, 1e3)


def record(seed):
    """Command and noisy output of an asymmetric dead zone."""
    u = lm.signals.prs(600, -5, 5, 7, seed)
    model = lm.Hammerstein(lm.DeadZone(-0.7, 1.2, 2.0, 1.0), lm.LinearModel([-0.8], [0.3], 1), 0.5)
    return u, model.simulate(u) + np.random.default_rng(seed).normal(scale=0.05, size=u.size)


def fit(u, y):
    return lm.identify(u, y, 1.0, orders=ORDERS, noise="white", offset="free", nonlinearity="dead zone")


@cache
def reference(seed):
    return fit(*record(seed))


def check(result, expected, errors):
    """Within a thousandth of a standard error: only the stopping point of the search may differ."""
    for name, value in expected.items():
        reach = 1e-3 * errors[name]
        assert result.parameters[name] == pytest.approx(value, abs=reach, rel=1e-9), name
        assert result.standard_errors[name] == pytest.approx(errors[name], rel=1e-3), name


@given(st.integers(0, 3), SIZE, SHIFT, SIZE, st.sampled_from([-1, 1]), SHIFT)
@settings(max_examples=12, deadline=None)
def test_units_do_not_matter(seed, s, c, g, sign, h):
    u, y = record(seed)
    p, e = reference(seed).parameters, reference(seed).standard_errors
    result = fit(s * u + s * c, sign * g * y + g * h)
    factors = {
        "left": s,
        "right": s,
        "width": s,
        "slope_ratio": 1,
        "a1": 1,
        "gain": sign * g / s,
        "b0": sign * g / s,
    }
    expected = {name: factor * p[name] for name, factor in factors.items()}
    errors = {name: abs(factor) * e[name] for name, factor in factors.items()}
    for name in ("left", "right"):
        expected[name] += s * c
    expected["offset"], errors["offset"] = sign * g * p["offset"] + g * h, g * e["offset"]
    check(result, expected, errors)
    assert result.status is reference(seed).status
    assert result.fit_percent == pytest.approx(reference(seed).fit_percent, abs=1e-6)


@given(st.integers(0, 3))
@settings(max_examples=4, deadline=None)
def test_mirrored_command_swaps_the_sides(seed):
    u, y = record(seed)
    p, e = reference(seed).parameters, reference(seed).standard_errors
    result = fit(-u, -y)
    expected = {"left": -p["right"], "right": -p["left"], "width": p["width"], "slope_ratio": 1 / p["slope_ratio"]}
    expected |= {"a1": p["a1"], "offset": -p["offset"], "gain": p["gain"] * p["slope_ratio"]}
    for name, value in expected.items():
        reach = 0.01 * e["width" if name in ("left", "right") else name]
        assert result.parameters[name] == pytest.approx(value, abs=2 * reach), name


@given(st.floats(0.1, 10))
@settings(max_examples=4, deadline=None)
def test_known_gain_moves_into_the_slopes(gain):
    u, y = record(0)
    free = reference(0).parameters
    known = lm.identify(
        u, y, 1.0, orders=ORDERS, noise="white", offset="free", gain=gain, nonlinearity="dead zone"
    ).parameters
    assert known["gain"] == pytest.approx(gain)
    assert known["right_slope"] * gain == pytest.approx(free["gain"])
    assert known["left_slope"] * gain == pytest.approx(free["gain"] * free["slope_ratio"])
    for name in ("left", "right", "width", "slope_ratio", "offset", "a1"):
        assert known[name] == pytest.approx(free[name]), name
