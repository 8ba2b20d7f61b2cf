"""Least squares for B over a grid of poles, compiled and by the columns themselves."""

import numpy as np
import pytest

from lostmotion.identify.likelihood.poles import grid_starts
from lostmotion.identify.likelihood.structure import LADDER, distinct
from lostmotion.identify.scaled import ScaledData
from lostmotion.kernels import pole_grid

SEGMENTS = {"one": [[0, 300]], "three": [[0, 120], [130, 140], [150, 300]]}


def grid(rng, na, number):
    """Polynomials and slowest modes; one pattern integrates."""
    sets = [np.append(rng.uniform(0.1, 0.95, max(na - 1, 0)), 1.0 if i == 0 else 0.7)[:na] for i in range(number)]
    return np.array([np.atleast_1d(np.poly(poles))[1:] for poles in sets]).reshape(number, na), np.array(
        [max(poles, default=0.0) for poles in sets]
    )


@pytest.mark.parametrize(("na", "number"), [(0, 1), (1, 4), (2, 6), (3, 5), (5, 3)])
@pytest.mark.parametrize("noise", [0, 2])
@pytest.mark.parametrize("segments", SEGMENTS)
def test_scan(na, number, noise, segments):
    rng = np.random.default_rng([na, noise])
    x, y, d = rng.normal(size=300), rng.normal(size=300), rng.uniform(-0.3, 0.3, noise)
    polynomials, decays = grid(rng, na, number)
    found = []
    for scan in (pole_grid._scan, pole_grid._scan_plain):
        rss, b = np.full((number, 2, 4), np.nan), np.zeros((number, 2, 4, 2))
        rows = scan(x, y, np.array(SEGMENTS[segments]), d, polynomials, decays, 1, 4, 2, rss, b)
        found.append((rows, rss, b))
    (rows, rss, b), (expected_rows, expected_rss, expected_b) = found
    assert rows == expected_rows
    np.testing.assert_allclose(rss, expected_rss, rtol=1e-9)
    np.testing.assert_allclose(b, expected_b, rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize(("na", "number"), [(0, 1), (1, 4), (2, 6), (3, 5), (5, 3)])
@pytest.mark.parametrize("noise", [0, 2])
@pytest.mark.parametrize("segments", SEGMENTS)
@pytest.mark.parametrize(("low", "high"), [(1, 4), (2, 2), (0, 12)])
def test_a_quick_scan_finds_the_same(na, number, noise, segments, low, high):
    rng = np.random.default_rng([na, noise])
    x, y, d = rng.normal(size=300), rng.normal(size=300), rng.uniform(-0.3, 0.3, noise)
    polynomials, decays = grid(rng, na, number)
    found = []
    for quick in (False, True):
        rss, b = np.full((number, 2, high - low + 1), np.nan), np.zeros((number, 2, high - low + 1, 2))
        pole_grid.scan(x, y, np.array(SEGMENTS[segments]), d, polynomials, decays, low, high, 2, rss, b, quick)
        found.append((rss, b))
    np.testing.assert_allclose(found[1][0], found[0][0], rtol=1e-9)
    np.testing.assert_allclose(found[1][1], found[0][1], rtol=1e-7, atol=1e-9)


def test_slow_poles_do_not_blur_a_quick_scan():
    rng = np.random.default_rng(5)
    a, decay, shape = np.poly([0.9975, 0.9975, 0.993])[1:], 0.9975, (1, 3, 25)
    x = np.cumsum(rng.normal(size=2000))
    y = 1e-4 * x + rng.normal(size=2000)
    found = []
    for quick in (False, True):
        rss, b = np.empty(shape), np.zeros((*shape, 3))
        pole_grid.scan(x, y, np.array([[0, 2000]]), np.zeros(0), a[None], np.array([decay]), 1, 25, 3, rss, b, quick)
        found.append(rss)
    np.testing.assert_allclose(found[1], found[0], rtol=1e-4)


def test_best_order_is_the_least_squares_fit():
    rng = np.random.default_rng(3)
    x, y, a, n = rng.normal(size=200), rng.normal(size=200), np.array([-0.8]), 200
    rss, b = np.empty((1, 2, 1)), np.zeros((1, 2, 1, 2))
    pole_grid.scan(x, y, np.array([[0, n]]), np.zeros(0), a[None], np.array([0.8]), 2, 2, 2, rss, b)
    response, level = np.zeros(n), np.zeros(n)
    for k in range(n):
        response[k], level[k] = x[k] + 0.8 * response[k - 1] * (k > 0), 1.0 + 0.8 * level[k - 1] * (k > 0)
    columns = [response[4 - 2 - i : n - 2 - i] for i in range(2)]
    table = np.column_stack([*columns, level[4:], 0.8 ** np.arange(n - 4)])
    gains = np.linalg.lstsq(table, y[4:], rcond=None)[0]
    assert rss[0, 1, 0] == pytest.approx(np.sum((y[4:] - table @ gains) ** 2), rel=1e-9)
    np.testing.assert_allclose(b[0, 1, 0], gains[:2], rtol=1e-7)


def test_a_command_at_rest_moves_nothing():
    rss, b = np.empty((1, 1, 1)), np.ones((1, 1, 1, 1))
    y = np.random.default_rng(0).normal(size=100)
    grid_of_one = np.array([[-0.9]]), np.array([0.9])
    pole_grid.scan(np.zeros(100), y, np.array([[0, 100]]), np.zeros(0), *grid_of_one, 1, 1, 1, rss, b)
    assert b[0, 0, 0, 0] == 0.0
    assert 0.0 < rss[0, 0, 0] < np.sum(y**2)


def test_starts_left_out_are_worse_than_the_limit_or_than_another_of_their_order():
    rng = np.random.default_rng(0)
    x, y = rng.normal(size=400), np.zeros(400)
    for k in range(3, 400):
        y[k] = 1.5 * y[k - 1] - 0.6 * y[k - 2] + x[k - 3] + 0.1 * rng.normal()
    data = ScaledData(x, y, np.array([[0, 400]]))
    found = grid_starts(data, x, np.zeros(0), LADDER, (1, 5))
    limit = found[len(found) // 2].score
    fewer = grid_starts(data, x, np.zeros(0), LADDER, (1, 5), limit=limit)
    assert [(one.key, one.score) for one in fewer] == [(one.key, one.score) for one in found if one.score < limit]
    best = grid_starts(data, x, np.zeros(0), LADDER, (1, 5), limit=None)
    assert [one.key for one in best] == [one.key for one in distinct(found, 3)]
    assert best[0].delay == 3
