"""Regressions on pairs of hinges and jumps, against the same through the lagged matrix."""

import numpy as np
import pytest

from lostmotion.identify.actuators.bends import Hinges, Jumps
from lostmotion.identify.actuators.paired_inputs import regress_on_pairs
from lostmotion.identify.likelihood.arx_gram import Lags, arx_products
from lostmotion.identify.scaled import ScaledData
from lostmotion.kernels import cells
from tests.naive import lagged as slow

SEGMENTS = {"one": [(0, 400)], "three": [(0, 150), (160, 170), (180, 400)]}
LAGS = [Lags(4, 3, 1), Lags(2, 5, 0), Lags(3, 2, 4)]


def record(seed, segments, levels=None):
    """Closed loop of a kind: PV depends on OP through a dead zone; OP on a few levels or anywhere."""
    rng = np.random.default_rng(seed)
    u = rng.uniform(-2.0, 2.0, 400) if levels is None else rng.choice(np.linspace(-2.0, 2.0, levels), 400)
    x, y = np.sign(u) * np.maximum(np.abs(u) - 0.5, 0.0), rng.normal(scale=0.3, size=400)
    for k in range(2, 400):
        y[k] += 0.8 * y[k - 1] + x[k - 2]
    return ScaledData(u, y, np.array(segments))


@pytest.mark.parametrize("lags", LAGS)
@pytest.mark.parametrize("segments", SEGMENTS)
@pytest.mark.parametrize("levels", [None, 5])  # 5: knots are values of OP
def test_hinges(lags, segments, levels):
    data = record(lags.inputs, SEGMENTS[segments], levels)
    hinges = Hinges(np.linspace(-1.0, 0.5, 4), np.linspace(-0.5, 1.0, 3))
    found = regress_on_pairs(hinges, data, lags, uniform=True)
    for at, (i, j) in enumerate(hinges.places):
        left, right = np.minimum(data.u - hinges.left[i], 0.0), np.maximum(data.u - hinges.right[j], 0.0)
        rows = (data.y, lags.outputs)
        expected, gains = slow.regression(*rows, [left, right], lags.delay, lags.inputs, data.segments)
        assert found.rss[at] == pytest.approx(expected, rel=1e-6)
        np.testing.assert_allclose(found.gains[at], gains, rtol=1e-5, atol=1e-6)
        expected, _ = slow.regression(*rows, [left + right], lags.delay, lags.inputs, data.segments)
        assert found.rss_of_sum[at] == pytest.approx(expected, rel=1e-6)
    assert found.samples == sum(max(stop - start - lags.head, 0) for start, stop in data.segments)


@pytest.mark.parametrize("lags", LAGS)
@pytest.mark.parametrize("segments", SEGMENTS)
@pytest.mark.parametrize("levels", [None, 21])
def test_jumps(lags, segments, levels):
    data = record(lags.inputs, SEGMENTS[segments], levels)
    places = np.linspace(-1.5, 1.5, 16)
    found = regress_on_pairs(Jumps(places), data, lags, uniform=False)
    for at, place in enumerate(places):
        signals = [data.u, (data.u > place).astype(float)]
        expected, gains = slow.regression(data.y, lags.outputs, signals, lags.delay, lags.inputs, data.segments)
        assert found.rss[at] == pytest.approx(expected, rel=1e-6)
        np.testing.assert_allclose(found.gains[at], gains, rtol=1e-4, atol=1e-5)


def test_a_jump_that_never_happens_explains_nothing():
    data, lags = record(0, SEGMENTS["one"]), LAGS[0]
    found = regress_on_pairs(Jumps(np.array([-3.0, 3.0])), data, lags, uniform=False)
    expected, _ = slow.regression(data.y, lags.outputs, [data.u], lags.delay, lags.inputs, data.segments)
    np.testing.assert_allclose(found.rss, expected, rtol=1e-6)


@pytest.mark.parametrize("lags", LAGS)
@pytest.mark.parametrize("segments", SEGMENTS)
def test_products_of_an_arx(lags, segments):
    data = record(1, SEGMENTS[segments])
    rows = [k for start, stop in data.segments for k in range(start + lags.head, stop)]
    matrix = slow.lagged_matrix(data.y, lags.outputs, [data.u], lags.delay, lags.inputs, rows)
    gram, target, total, samples = arx_products(data.u, data, lags)
    np.testing.assert_allclose(gram, matrix.T @ matrix, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(target, matrix.T @ data.y[rows], rtol=1e-9, atol=1e-9)
    assert (total, samples) == (pytest.approx(data.y[rows] @ data.y[rows]), len(rows))


def test_sums_over_cells_compiled_and_plain():
    rng = np.random.default_rng(0)
    u, y, origin = rng.normal(size=200), rng.normal(size=200), np.array([-1.0, -1.0, 0.0, 1.0])
    cell = np.searchsorted(origin[1:], u).astype(np.uint8)
    rows = (u, cell, origin)
    calls = [
        (cells.add_pairs, cells._add_pairs_plain, (*rows, 20, 190), (5, 4, 4, 4)),
        (cells.add_behind, cells._add_behind_plain, (y, 1, *rows, 3, 20, 190), (5, 4, 2)),
        (cells.add_ahead, cells._add_ahead_plain, (y, 1, *rows, 3, 20, 190), (5, 4, 2)),
        (cells.add_lower, cells._add_lower_plain, (cell, 20, 190), (5, 4)),
    ]
    for fast, plain, arguments, shape in calls:
        first, second = np.ones(shape), np.ones(shape)
        fast(*arguments, first)
        plain(*arguments, second)
        np.testing.assert_allclose(first, second, rtol=1e-12, atol=1e-12)
