"""A recording that stopped is not a measurement that stood still."""

from __future__ import annotations

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.diagnose.control_error.rows import ScreenRows

BEGIN, STOP = 1000, 1800


def record_with_a_standstill(op_inside: np.ndarray) -> lm.LoopRecord:
    rng = np.random.default_rng(7)
    op, pv = 40.0 + rng.normal(size=4000).cumsum() * 0.2, 50.0 + rng.normal(size=4000)
    op[BEGIN:STOP], pv[BEGIN:STOP] = op[BEGIN] + op_inside, pv[BEGIN]
    return lm.LoopRecord(op, pv, dt=1.0)


@pytest.mark.parametrize(
    ("steps", "stopped"),
    [
        ([], True),
        ([100, 200, 300, 400], True),  # too few
        ([100, 110, 120, 130, 140, 150], True),  # all at once: it ended a little later than PV
        ([10, 150, 300, 450, 600, 750], False),  # OP is still recorded, in steps of its resolution
    ],
)
def test_a_recording_that_stops_holds_both(steps, stopped):
    inside = np.zeros(STOP - BEGIN)
    for at in steps:
        inside[at:] += 0.01
    rows = ScreenRows(record_with_a_standstill(inside))
    middle = slice(BEGIN + 20, STOP - 20)
    assert rows.standing[middle].all()
    assert rows.stopped[middle].mean() == pytest.approx(float(stopped), abs=0.02)
