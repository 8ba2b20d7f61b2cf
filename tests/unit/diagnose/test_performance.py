import json
import math

import numpy as np
import pytest

from lostmotion.diagnose.harris import harris_index
from lostmotion.diagnose.oscillation import Oscillation
from lostmotion.diagnose.performance import measure_performance
from lostmotion.identify.data import collect
from lostmotion.records import LoopRecord

QUIET = Oscillation(40.0, 0.3, 0.1, 25.0)
SWING = Oscillation(40.0, 5.0, 0.9, 25.0)
SPAN = (0.0, 100.0)


def rated(op, pv, sp=None, delay=1, dt=1.0, oscillation=QUIET, manual=0.0, loop_type="flow", span=SPAN):
    return measure_performance(collect(op, pv, dt), sp, delay, span, oscillation, manual, loop_type)


@pytest.fixture(scope="module")
def white():
    rng = np.random.default_rng(0)
    time = np.arange(2000)
    return 50 + 5 * np.sin(2 * np.pi * time / 40), 20 + rng.normal(size=2000)


def test_variance_is_about_the_set_point_where_it_is_known(white):
    op, pv = white
    assert rated(op, pv).variance == pytest.approx(np.var(pv))
    assert rated(op, pv, sp=np.full(2000, 21.0)).variance == pytest.approx(np.mean((pv - 21.0) ** 2))


def test_harris_is_that_of_the_delay_and_of_three_times_it():
    noise = np.random.default_rng(1).normal(size=4000)
    pv = np.zeros(4000)
    for k in range(1, 4000):
        pv[k] = 0.9 * pv[k - 1] + noise[k]
    found = rated(50 + noise, pv, delay=2)
    assert found.harris == pytest.approx([harris_index(pv, pv.mean(), delay).low for delay in (2, 6)], abs=0.01)
    assert found.harris == pytest.approx((1 - 0.9**4, 1 - 0.9**12), abs=0.05)


def test_travel_and_reversals_of_a_sine(white):
    found = rated(*white, dt=2.0)
    assert found.travel == pytest.approx(20 * 3600 / 80, rel=0.01)
    assert found.reversals == pytest.approx(2 * 3600 / 80, rel=0.02)
    assert rated(*white, span=(0.0, 50.0), dt=2.0).travel == pytest.approx(2 * found.travel)


def test_white_error_is_excellent_and_a_swing_costs_a_class(white):
    assert rated(*white).audit_class == "excellent"
    assert rated(*white, oscillation=SWING).audit_class == "acceptable"


def test_manual_and_limits_make_an_open_loop(white):
    op, pv = white
    assert rated(op, pv, manual=0.4).audit_class == "open loop"
    stuck = np.where(np.arange(2000) < 800, 100.0, op)
    found = rated(stuck, pv)
    assert found.limited == pytest.approx(0.4)
    assert found.audit_class == "open loop"
    assert rated(stuck, pv, manual=1.0).audit_class == "open loop"


def test_only_the_longest_piece_counts(white):
    op, pv = white
    parts = [LoopRecord(op[:300], pv[:300] + 7.0, dt=1.0), LoopRecord(op[300:], pv[300:], dt=1.0)]
    data = collect(parts, None, None, raw=True)
    sp = np.full(2000, 20.0)
    found = measure_performance(data, sp, 1, SPAN, QUIET, 0.0, "flow")
    assert found.variance == pytest.approx(np.mean((pv[300:] - 20.0) ** 2))


def test_a_delay_too_long_for_the_record_leaves_harris_unknown():
    rng = np.random.default_rng(0)
    found = rated(rng.normal(size=80), rng.normal(size=80), delay=40)
    assert all(math.isnan(value) for value in found.harris)
    data = found.to_dict()
    assert data["harris"] == [None, None]
    json.dumps(data, allow_nan=False)
