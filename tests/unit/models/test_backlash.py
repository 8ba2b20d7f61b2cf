import json
from dataclasses import FrozenInstanceError

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.kernels import backlash as kernel
from lostmotion.models import BacklashInverse
from tests.naive import backlash as slow
from tests.support.refusals import refusal

NAN, INF = float("nan"), float("inf")
SEEDS = range(6)


def commands(seed, n=400):
    """Noise, ramps, holds and whole numbers one behind the other."""
    rng = np.random.default_rng(seed)
    walk = np.cumsum(rng.normal(size=n))
    held = np.repeat(rng.uniform(-4, 4, n // 8), 8)
    return np.concatenate([walk, held, np.linspace(3, -3, n), rng.integers(-5, 5, n).astype(float)])


@pytest.mark.sampled(6)
@pytest.mark.parametrize("width", [0.0, 0.5, 2.0, 7.0])
@pytest.mark.parametrize("seed", SEEDS)
def test_twin(seed, width):
    u = commands(seed)
    start = np.random.default_rng(seed).uniform(-5, 5)
    np.testing.assert_allclose(kernel.run(u, width, start), slow.backlash(u, width, start), rtol=1e-15)
    np.testing.assert_allclose(kernel.run(u, width, NAN), slow.backlash(u, width, None), rtol=1e-15)
    np.testing.assert_allclose(kernel.inverse_run(u, width, 0.0), slow.inverse(u, width), rtol=1e-15)
    np.testing.assert_allclose(kernel.inverse_run(u, width, -1.0), slow.inverse(u, width, -1), rtol=1e-15)


@pytest.mark.parametrize("width", [0.5, 2.0, 7.0])
@pytest.mark.parametrize("seed", SEEDS)
def test_sensitivities(seed, width):
    u = commands(seed)
    start = np.random.default_rng(seed).uniform(-5, 5)
    x, dx = np.full(u.size, NAN), np.full((2, u.size), NAN)
    kernel.sensitivities(u, width, start, x, dx)
    np.testing.assert_array_equal(x, kernel.run(u, width, start))
    np.testing.assert_allclose(dx, slow.derivatives(u, width, start), rtol=1e-14)


@pytest.mark.parametrize("seed", SEEDS)
def test_sensitivities_against_finite_differences(seed):
    u, h = np.cumsum(np.random.default_rng(seed).normal(size=300)), 1e-7
    start = u[0] + 0.2
    x, dx = np.empty(u.size), np.empty((2, u.size))
    kernel.sensitivities(u, 2.0, start, x, dx)
    by_width = (kernel.run(u, 2.0 + h, start) - kernel.run(u, 2.0 - h, start)) / (2 * h)
    by_start = (kernel.run(u, 2.0, start + h) - kernel.run(u, 2.0, start - h)) / (2 * h)
    np.testing.assert_allclose(dx, [by_width, by_start], atol=1e-7)
    assert dx[1, 0] == 1.0  # start lies inside the band at the first sample
    assert dx[1, -1] == 0.0


def test_derivative_by_a_start_outside_the_band_is_zero():
    x, dx = np.empty(3), np.empty((2, 3))
    kernel.sensitivities(np.array([0.0, 0.1, -0.1]), 1.0, 5.0, x, dx)
    assert x.tolist() == [0.5, 0.5, 0.4]
    assert dx.tolist() == [[0.5] * 3, [0.0] * 3]


def test_by_hand():
    gear = lm.Backlash(2.0)
    assert gear([0, 0.5, 3, 2, 1, 0, -1]).tolist() == [0, 0, 2, 2, 2, 1, 0]
    assert gear.run([0, 0.5, 3], start=1).tolist() == [1, 1, 2]
    assert gear.run([5.0, 5.0], start=0).tolist() == [4, 4]
    assert gear(3.0) == 3.0
    assert gear.run(3.0, start=0.0) == 2.0
    assert gear([]).tolist() == []


def test_inverse_by_hand():
    undo = lm.Backlash(2.0).inverse()
    assert undo([0, 1, 1, 2, 1, 1]).tolist() == [0, 2, 2, 3, 0, 0]
    assert undo.run([0, 0, 1], side=-1).tolist() == [-1, -1, 2]
    assert undo(4.0) == 4.0
    assert undo.inverse() == lm.Backlash(2.0)


def test_missing_samples_keep_the_position():
    u = np.array([NAN, 1.0, 4.0, NAN, 3.5, NAN, -1.0])
    gear = lm.Backlash(2.0)
    np.testing.assert_array_equal(np.isnan(gear(u)), np.isnan(u))
    np.testing.assert_array_equal(gear(u)[~np.isnan(u)], gear(u[~np.isnan(u)]))
    undo = gear.inverse()
    np.testing.assert_array_equal(undo(u)[~np.isnan(u)], undo(u[~np.isnan(u)]))
    x, dx = np.empty(u.size), np.empty((2, u.size))
    kernel.sensitivities(u, 2.0, NAN, x, dx)
    np.testing.assert_array_equal(x, gear(u))
    assert dx[1].tolist() == [0.0] * u.size
    assert dx[0].tolist() == [0.0, 0.0, -0.5, -0.5, -0.5, -0.5, 0.5]


def test_description_survives_json():
    gear = lm.Backlash(1.25)
    assert lm.Backlash.from_dict(json.loads(json.dumps(gear.to_dict()))) == gear
    assert gear.to_dict() == {"kind": "backlash", "width": 1.25}


@pytest.mark.parametrize("width", [NAN, INF, -1.0, None, "wide", [1.0, 2.0]])
def test_refuses_widths(width):
    assert "width" in refusal(lm.ParameterError, lm.Backlash, width)


def test_refuses_what_has_no_time_axis():
    gear = lm.Backlash(1.0)
    for call in (gear, gear.run, gear.inverse()):
        assert "shape (2, 3)" in refusal(lm.ParameterError, call, np.zeros((2, 3)))
    assert "start" in refusal(lm.ParameterError, gear.run, [1.0], start=NAN)
    assert "side" in refusal(lm.ParameterError, gear.inverse().run, [1.0], side=2)
    assert "width" in refusal(lm.ParameterError, lm.Backlash.from_dict, {})
    refusal(lm.DataError, gear, ["a"])


def test_frozen_and_leaves_its_input_alone():
    gear, u = lm.Backlash(1.0), np.array([0.0, 3.0, -3.0])
    with pytest.raises(FrozenInstanceError):
        gear.width = 2.0
    gear(u)
    assert u.tolist() == [0.0, 3.0, -3.0]
    assert BacklashInverse(gear) == gear.inverse()


@pytest.mark.statistics
def test_no_drift_over_ten_million_samples():
    u = 50.0 + 0.1 * np.pi * np.random.default_rng(0).integers(-40, 40, 10_000_000)
    x = kernel.run(u, 0.3, NAN)
    step = np.diff(u)
    moved = np.abs(step) > 1e-9  # then by 0.1 pi > 0.3 at least: x is known without memory, to the last bit
    np.testing.assert_array_equal(x[1:][moved], u[1:][moved] - np.sign(step[moved]) * 0.15)
    assert np.all(x[1:][~moved] == x[:-1][~moved])
