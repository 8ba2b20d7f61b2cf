"""A lag that differs with direction is a linear one with two inputs more."""

import math

import numpy as np
import pytest

from lostmotion.kernels import directional_lag as kernel
from tests.naive import directional_lag as naive


@pytest.mark.parametrize("pole", [0.99, 0.9, 0.3, 0.02])
@pytest.mark.parametrize(("up", "outward"), [(0.0, 0.0), (0.3, 0.0), (0.0, -0.4), (-0.2, 0.5)])
def test_a_linear_lag_with_both_inputs_is_the_lag(pole, up, outward):
    x, courses = np.repeat(np.random.default_rng(4).normal(size=60), 5), np.empty((2, 300))
    kernel.missing_travel(x, pole, up, outward, 0.1, courses)
    steps = min(max(math.ceil(-math.log(pole) / kernel.FINEST), 1), kernel.MOST_STEPS)
    wanted = naive.simulated(x, pole, up, outward, 0.1, steps)
    np.testing.assert_allclose(naive.linear(x, up * courses[0] + outward * courses[1], pole), wanted, atol=1e-12)


def test_what_stands_still_has_no_more_inputs():
    courses = np.empty((2, 20))
    kernel.missing_travel(np.full(20, 3.0), 0.9, 0.2, 0.1, 0.0, courses)
    assert not courses.any()
