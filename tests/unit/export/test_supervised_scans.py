"""Requests that the scans of a proof write."""

import pytest

from lostmotion.export.supervised_scans import LARGEST, _whole


@pytest.mark.parametrize(
    ("value", "unit", "expected"),
    [(0.3, 0.1, 3), (0.38, 0.1, 3), (-0.38, 0.1, -3), (1e300, 0.1, LARGEST), (float("nan"), 1.0, 0)],
)
def test_whole_units_of_a_request(value, unit, expected):
    """0.3 / 0.1 is a little less than 3."""
    assert _whole(value, unit) == expected
