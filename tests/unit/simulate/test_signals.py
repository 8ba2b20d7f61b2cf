import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import ParameterError
from tests.support.refusals import refusal

NAN, INF = float("nan"), float("inf")


@pytest.mark.parametrize(("n", "hold"), [(1, 1), (10, 3), (9, 3), (2, 5), (100, 1)])
def test_prs_is_a_staircase_in_its_range(n, hold):
    u = lm.signals.prs(n, 2.0, 3.0, hold, seed=0)
    assert u.shape == (n,)
    assert u.min() >= 2.0
    assert u.max() < 3.0
    np.testing.assert_array_equal(u, u[np.arange(n) // hold * hold])
    assert np.unique(u).size == -(-n // hold)


def test_prs_fills_its_range_evenly():
    u = lm.signals.prs(3000, -5, 5, 1, seed=1)
    assert np.histogram(u, bins=10, range=(-5, 5))[0].min() > 230


def test_prs_depends_on_the_seed_only():
    first = lm.signals.prs(50, -1, 1, 5, seed=3)
    np.testing.assert_array_equal(first, lm.signals.prs(50, -1, 1, 5, seed=3))
    np.testing.assert_array_equal(first, lm.signals.prs(50, -1, 1, 5, np.random.default_rng(3)))
    assert (first != lm.signals.prs(50, -1, 1, 5, seed=4)).any()


@pytest.mark.parametrize("settings", [{"n": 0}, {"n": -3}, {"hold": 0}, {"hold": -1}, {"n": 10.5}, {"hold": 2.5}])
def test_prs_refuses_lengths(settings):
    assert next(iter(settings)) in refusal(
        ParameterError, lm.signals.prs, **{"n": 10, "low": -1, "high": 1, "hold": 2, "seed": 0, **settings}
    )


@pytest.mark.parametrize(("low", "high"), [(1, 1), (2, 1), (NAN, 1), (0, NAN), (0, INF), (-INF, 0)])
def test_prs_refuses_ranges(low, high):
    assert "low" in refusal(ParameterError, lm.signals.prs, 10, low, high, 2, 0)


def test_level_tank_is_the_papers():
    tank = lm.platforms.level_tank()
    assert tank.nonlinearity == lm.DeadZone(-1, 1, 3, 3)
    assert tank.linear.delay == 3
    assert tank.linear.dt == 0.1
    assert tank.linear.gain == pytest.approx(2.0 / 0.9)
    assert tank.offset == 0.0
    expected = np.exp(np.array([-0.9, -2.5 + 1j * np.sqrt(18.75), -2.5 - 1j * np.sqrt(18.75)]) * 0.1)
    np.testing.assert_allclose(np.sort_complex(tank.linear.poles), np.sort_complex(expected), rtol=1e-10)


def test_routine_operation():
    record = lm.routine_operation(700, drift="strong", seed=2)
    assert len(record) == 700
    assert set(record.reference) <= {-1.0, 0.0, 1.0}
    again = lm.routine_operation(700, drift="strong", seed=2)
    np.testing.assert_array_equal(record.measured, again.measured)
    assert "drift" in refusal(ParameterError, lm.routine_operation, 100, drift="wild")
