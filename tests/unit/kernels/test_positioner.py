"""Kernels of a positioner against their slow twins, and the filter against what it must find."""

import numpy as np
import pytest

from lostmotion.kernels import positioner as kernel
from tests.naive import positioner as naive

RNG = np.random.default_rng(4)
OP = np.cumsum(RNG.normal(size=80)) + 50.0
Y = OP + RNG.normal(scale=0.3, size=80)


@pytest.mark.parametrize("line", [False, True])
@pytest.mark.parametrize(("delay", "lag", "parts"), [(0.0, 0.0, 1), (0.6, 2.0, 1), (1.3, 0.7, 4), (3.0, 5.0, 2)])
def test_command_against_its_twin(delay, lag, line, parts):
    v = np.empty(parts * OP.size)
    kernel.command(OP, delay, lag, line, parts, v)
    np.testing.assert_allclose(v, naive.command(OP, delay, lag, line, parts), rtol=1e-12)


@pytest.mark.parametrize("parts", [1, 4])
@pytest.mark.parametrize(("half", "approach", "rate"), [(0.0, 1.0, np.inf), (1.0, 0.4, np.inf), (0.5, 1.0, 0.2)])
def test_play_against_its_twin(half, approach, rate, parts):
    v, x = np.repeat(OP, parts), np.empty(OP.size)
    kernel.follow(v, Y, np.zeros(OP.size), half, 0.3, approach, rate, parts, x)
    np.testing.assert_allclose(x, naive.follow(v, Y, half, 0.3, approach, rate, parts), rtol=1e-12)


def test_holds_against_their_twin():
    y = np.round(Y)
    found = kernel.holds(y, 1.0, np.zeros(y.size))
    np.testing.assert_allclose(found, naive.holds(y, 1.0))


def test_the_filter_is_most_likely_at_the_truth():
    op = 50.0 + 10.0 * np.sin(np.arange(400) / 30.0)
    position, x = np.empty(400), 50.0
    for k, u in enumerate(op):
        x = u if abs(u - x) > 1.0 else x
        position[k] = x
    wide, per_row, state = 5.0, np.empty(400), np.empty(400)

    def likelihood(half):
        theta = np.array([0.0, half, 0.0, 0.0, 0.0, 1.0, np.inf, 0.02, 0.02, 0.02])
        return kernel.filtered(op, position, np.zeros(400), theta, wide, per_row, state, 0)

    assert max((0.5, 0.8, 1.0, 1.2, 2.0), key=likelihood) == 1.0
    assert likelihood(1.0) == pytest.approx(per_row.sum())


def test_missing_samples_are_passed_over():
    position = OP.copy()
    position[10:15] = np.nan
    theta = np.array([0.0, 0.5, 1.0, 0.0, 0.0, 1.0, np.inf, 0.1, 0.1, 0.1])
    per_row = np.empty(OP.size)
    assert np.isfinite(kernel.filtered(OP, position, np.zeros(80), theta, 5.0, per_row, np.empty(80), 0))
    assert not per_row[10:15].any()
