"""Whether a recursion may begin from the batch fit of its first window."""

from types import SimpleNamespace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import Status
from lostmotion.identify.recursive.ml_window import CLEAR_GAIN, LARGEST_WINDOW, may_begin

MANY = 500  # values of OP


def fitted(gain_error, status=Status.OK, integrating=False, inside=0.0):
    """A fit in which the dead zone is clear, and the gain known to this share."""
    return SimpleNamespace(
        status=status,
        parameters={"left": -0.5, "right": 0.5, "width": 1.0, "slope_ratio": 0.6, "gain": -16.7},
        standard_errors={"left": 0.03, "right": 0.03, "width": 0.04, "slope_ratio": 0.12, "gain": gain_error * 16.7},
        chosen=SimpleNamespace(integrating=integrating),
        data=SimpleNamespace(u=np.array([-2.0, -1.0, inside, 3.0])),
    )


@pytest.mark.parametrize(("error", "begins"), [(0.28, False), (0.9, False), (0.9 * CLEAR_GAIN, True)])
def test_a_window_that_does_not_tell_the_gain_waits(error, begins):
    assert may_begin(fitted(error), 1.0, MANY) is begins
    assert may_begin(fitted(error), LARGEST_WINDOW, MANY), "no start waits for ever"


def test_nothing_begins_from_a_fit_that_cannot_be_used():
    assert not may_begin(fitted(0.1, integrating=True), LARGEST_WINDOW, MANY)
    assert not may_begin(fitted(0.1, Status.CANNOT_TELL), LARGEST_WINDOW, MANY)
    assert may_begin(fitted(0.1), 1.0, MANY)


def test_few_places_of_op_wait():
    assert not may_begin(fitted(0.1), 1.0, 9)
    assert may_begin(fitted(0.1), 1.0, 10)
    assert may_begin(fitted(0.1), LARGEST_WINDOW, 9), "no start waits for ever"


@pytest.mark.parametrize(("op", "begins"), [(0.0, True), (0.4, True), (0.45, False), (0.6, False)])
def test_a_dead_zone_without_op_inside_waits(op, begins):
    assert may_begin(fitted(0.1, Status.WIDE, inside=op), 2.0, MANY) is begins
    assert may_begin(fitted(0.1, Status.WIDE, inside=op), LARGEST_WINDOW, MANY), "no start waits for ever"


def test_what_is_hardly_a_dead_zone_need_not_be_entered():
    fit = fitted(0.1, inside=2.0)
    fit.standard_errors["width"] = 0.2
    assert may_begin(fit, 2.0, MANY)


@pytest.mark.statistics
@pytest.mark.parametrize(("hold", "seed"), [(600, 7), (200, 2), (200, 4), (60, 7)])
def test_of_little_noise_nothing_changes(hold, seed):
    """The filters stayed behind the parameters by some deviations, and three to eight events came."""
    tank = lm.platforms.level_tank()
    u = lm.signals.prs(20_000, -5, 5, hold=hold, seed=seed)
    y = tank.simulate(u) + np.random.default_rng(seed).normal(scale=0.003, size=u.size)
    rml = lm.RecursiveML(3, 2, 3, gain=2.2222)
    rml.run(u, y)
    assert not rml.events
    assert_holds(rml.estimate)


def assert_holds(estimate):
    assert estimate.status is Status.OK
    for name, value in (("left", -1.0), ("right", 1.0)):
        assert abs(estimate.parameters[name] - value) < 4.0 * estimate.standard_errors[name]


@pytest.mark.statistics
@pytest.mark.parametrize("seed", range(4))
def test_an_op_that_hardly_ever_moves(seed):
    """Through the first few of 33 places another dead zone went as well, and up to 31 events came."""
    tank = lm.platforms.level_tank()
    u = lm.signals.prs(20_000, -5, 5, hold=600, seed=seed)
    y = tank.simulate(u) + np.random.default_rng(seed).normal(scale=0.1, size=u.size)
    rml = lm.RecursiveML(3, 2, 3, gain=2.2222)
    rml.run(u, y)
    values, spread = rml.estimate.parameters, rml.estimate.standard_errors
    assert rml.estimate.status is Status.OK
    assert abs(values["left"] + 1.0) < 4.0 * spread["left"]
    assert abs(values["right"] - 1.0) < 4.0 * spread["right"]
    assert len(rml.events) <= 4
