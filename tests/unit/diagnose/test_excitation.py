"""Smooth moves of SP tell the process where PV answers them and OP alone reproduces it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from lostmotion.diagnose.excitation import FOLLOWS, follows_sp, only_fed_back
from tests.support.diagnoses import example

RAMP = np.linspace(0.0, 10.0, 100)


def test_ramps_move_op_little_from_row_to_row() -> None:
    assert only_fed_back(True, 0.0005, RAMP)


@pytest.mark.parametrize(
    ("answered", "percent", "sp", "follows"),
    [
        (True, FOLLOWS, RAMP, True),
        (False, 95.0, RAMP, False),
        (True, FOLLOWS - 1.0, RAMP, False),
        (True, 95.0, np.zeros(100), False),
        (True, 95.0, None, False),
    ],
)
def test_what_tells_the_process(answered, percent, sp, follows) -> None:
    fit = example().fit
    seen = replace(fit, evidence=replace(fit.evidence, answered=answered), fit_percent=percent)
    assert follows_sp(seen, sp) is follows
