from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.diagnose.pooled.record_profile import profile_record
from lostmotion.records import prepare

SIZES, MORE = np.array([0.5, 1.0, 2.0]), np.array([0.7, 1.4])


@pytest.mark.statistics
def test_a_loop_that_settles_between_its_rows_says_nothing_of_valves_that_stick():
    """Neither for them nor, beside the process of another record, against them."""
    u = np.round(np.cumsum(np.random.default_rng(3).normal(size=700)) % 10.0)
    y = lm.LinearModel([-0.7], [0.3], 1, 1.0).simulate(u) + np.random.default_rng(4).normal(scale=0.1, size=u.size)
    profile = profile_record(prepare(lm.LoopRecord(u, y, None, dt=1.0)), SIZES)
    other = replace(profile._models.linear.problem.structure, delay=3)
    assert profile.finer("backlash", MORE, like=other).curves["backlash"].gains.max() < -10.0
    settled = replace(profile, _models=replace(profile._models, settled=True))
    finer = settled.finer("backlash", MORE, like=other).curves["backlash"]
    np.testing.assert_array_equal(finer.gains[np.isin(finer.sizes, MORE)], 0.0)
