"""Whether a recursion may begin from the batch fit of its first window."""

from types import SimpleNamespace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import Status
from lostmotion.identify.recursive.ml_window import CLEAR_GAIN, LARGEST_WINDOW, may_begin

MANY = 500  # values of OP


def fitted(gain_error, status=Status.OK, integrating=False):
    """A fit in which the dead zone is clear, and the gain known to this share."""
    return SimpleNamespace(
        status=status,
        parameters={"width": 1.0, "slope_ratio": 0.6, "gain": -16.7},
        standard_errors={"width": 0.04, "slope_ratio": 0.12, "gain": gain_error * 16.7},
        chosen=SimpleNamespace(integrating=integrating),
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
