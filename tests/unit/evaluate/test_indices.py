import numpy as np
import pytest

from lostmotion.errors import DataError
from lostmotion.evaluate import control_variance, mean_absolute_error, reversals, travel
from tests.support.refusals import refusal

NAN = float("nan")


def test_control_variance_is_eq_32():
    u = np.random.default_rng(0).normal(size=50)
    mean = sum(u) / 50
    assert control_variance(u) == pytest.approx(sum((value - mean) ** 2 for value in u) / 50, rel=1e-12)
    assert control_variance([3.0]) == 0.0
    assert control_variance([1, 5]) == 4.0


def test_mean_absolute_error_is_eq_33():
    r, y = np.random.default_rng(0).normal(size=(2, 50))
    assert mean_absolute_error(r, y) == pytest.approx(sum(abs(a - b) for a, b in zip(r, y, strict=True)) / 50)
    assert mean_absolute_error([1, 2], [1, 2]) == 0.0


def test_travel():
    assert travel([2.0]) == 0.0
    assert travel([0, 1, 1, -2, 0]) == 6.0


@pytest.mark.parametrize(
    ("command", "band", "expected"),
    [
        ([1.0], 0.0, 0),
        ([1.0, 2.0], 0.0, 0),
        ([0, 1, 0], 0.0, 1),
        ([0, 1, 1, 1, 0], 0.0, 1),
        ([0, -1, 0, -1], 0.0, 2),
        ([3, 3, 3], 0.0, 0),
        ([0, 1, 0.9, 2, 1.9, 3], 0.2, 0),
        ([0, 1, 0.9, 2, 1.9, 3], 0.05, 4),
        ([0, 1, 0.75, 0.5, 0.25, 0], 0.4, 1),  # small moves that add up to a large one
        ([0, 5, 4, 5, 3, 5], 1.5, 2),
    ],
)
def test_reversals(command, band, expected):
    assert reversals(command, band) == expected


def test_reversals_of_a_sine():
    wave = np.sin(np.linspace(0, 10 * np.pi, 1001))
    assert reversals(wave) == 10
    assert reversals(wave, band=0.9) == 10
    assert reversals(wave, band=2.1) == 0


def test_reversals_about_the_first_value():
    assert reversals([0.0, 0.4, -0.4, 0.4, -0.4], band=0.5) == 2
    assert reversals(np.sin(np.linspace(0, 10 * np.pi, 1001)), band=1.9) == 8


@pytest.mark.parametrize("index", [control_variance, travel, reversals])
@pytest.mark.parametrize("bad", [[1.0, NAN], [[1.0, 2.0]], ["a"], [np.inf]])
def test_bad_signals(index, bad):
    refusal(DataError, index, bad)


@pytest.mark.parametrize(("r", "y"), [([1.0, 2.0], [1.0]), ([NAN], [1.0]), ([1.0], [NAN]), ([1.0], 1.0)])
def test_bad_pairs(r, y):
    refusal(DataError, mean_absolute_error, r, y)


@pytest.mark.parametrize(("index", "signals"), [(control_variance, [[]]), (mean_absolute_error, [[], []])])
def test_empty_signals(index, signals):
    refusal(DataError, index, *signals)


@pytest.mark.parametrize("band", [-1.0, NAN])
def test_bad_band(band):
    refusal(ValueError, reversals, [0.0, 1.0, 0.0], band)


def test_nothing_is_changed():
    u, y = np.arange(6.0), np.arange(6.0)[::-1].copy()
    before = u.copy(), y.copy()
    control_variance(u)
    mean_absolute_error(u, y)
    travel(u)
    reversals(u, 0.5)
    np.testing.assert_array_equal(u, before[0])
    np.testing.assert_array_equal(y, before[1])
