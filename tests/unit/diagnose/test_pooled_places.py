"""A limit of an actuator is one place in all records of it."""

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.diagnose.pooled.common_place import at_common_places
from lostmotion.diagnose.pooled.record_profile import profile_record
from lostmotion.models import Nonlinearity
from lostmotion.records import prepare

pytestmark = pytest.mark.statistics
SIZES = np.array([1.0, 3.0])
ROWS = 500


def profile(seed: int, valve: Nonlinearity, home: float = 50.0):
    """Of a flow loop in open operation about `home`, where it comes 8 % of span to either side."""
    rng = np.random.default_rng(seed)
    plant = lm.LinearModel((-0.8,), (0.2,), 2, 1.0)
    op = home + np.repeat(rng.uniform(-8.0, 8.0, size=ROWS // 10), 10)
    pv = lm.Hammerstein(valve, plant).simulate(op) + 0.1 * rng.normal(size=ROWS)
    return profile_record(prepare(lm.LoopRecord(op, pv, dt=1.0, op_span=(0.0, 100.0))), SIZES)


def gains(*profiles) -> list[float]:
    return [one.gains["saturation"] for one in at_common_places(profiles)]


def test_a_limit_counts_in_every_record_that_goes_beyond_it():
    limited = lm.Saturation(0.0, 53.0)
    below = profile(3, limited, 40.0)
    found = gains(profile(1, limited), profile(2, limited), below)
    assert min(found[:2]) > 20.0
    assert found[2] == 0.0  # OP stays below the limit, which tells nothing


def test_a_record_that_moves_on_beyond_the_limit_speaks_against_it():
    once, freely = profile(1, lm.Saturation(0.0, 53.0)), profile(2, lm.Identity())
    assert once.gains["saturation"] > 20.0
    assert gains(once)[0] > 20.0
    found = gains(once, freely)
    assert found[1] < -20.0 or found == [0.0, 0.0]
    assert gains(once, freely, profile(4, lm.Identity())) == [0.0, 0.0, 0.0]
