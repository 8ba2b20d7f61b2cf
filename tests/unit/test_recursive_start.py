"""Whether a recursion may begin from the batch fit of its first window."""

from types import SimpleNamespace

import pytest

from lostmotion.errors import Status
from lostmotion.identify.recursive.ml_window import CLEAR_GAIN, LARGEST_WINDOW, may_begin


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
    assert may_begin(fitted(error), 1.0) is begins
    assert may_begin(fitted(error), LARGEST_WINDOW), "no start waits for ever"


def test_nothing_begins_from_a_fit_that_cannot_be_used():
    assert not may_begin(fitted(0.1, integrating=True), LARGEST_WINDOW)
    assert not may_begin(fitted(0.1, Status.CANNOT_TELL), LARGEST_WINDOW)
    assert may_begin(fitted(0.1), 1.0)
