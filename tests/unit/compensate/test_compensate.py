import json
from dataclasses import FrozenInstanceError

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.compensate import DeadZoneCompensator
from lostmotion.errors import InputError, ParameterError
from tests.support.refusals import refusal

NAN, INF = float("nan"), float("inf")
ZONE = lm.DeadZone(-1, 2, left_slope=2, right_slope=4)


def test_deviations():
    block = DeadZoneCompensator(ZONE)
    assert block([-2.0, 0.0, 4.0]).tolist() == [-2.0, 0.0, 3.0]
    assert ZONE(block([-2.0, 0.0, 4.0])).tolist() == [-2.0, 0.0, 4.0]


def test_absolute_units():
    block = DeadZoneCompensator(lm.DeadZone(44, 46), centre=45)
    assert block([40, 44.9, 45, 45.1, 50]).tolist() == pytest.approx([39, 43.9, 45, 46.1, 51])


@pytest.mark.parametrize(("centre", "at_zero"), [(-3, -1), (0.5, 0.5), (7, 2)])
def test_rest_is_the_point_of_the_dead_zone_nearest_to_the_centre(centre, at_zero):
    block = DeadZoneCompensator(ZONE, centre)
    assert block.at_zero == block(centre) == block.step(centre) == at_zero


def test_step_call_and_reset():
    block = DeadZoneCompensator(ZONE, 0.3)
    uc = np.linspace(-5, 5, 41)
    assert block.reset() is None
    np.testing.assert_array_equal([block.step(value) for value in uc], block(uc))
    assert isinstance(block(1.0), float)
    assert isinstance(block.step(1), float)
    assert block(uc.reshape(41, 1)).shape == (41, 1)
    assert np.isnan(block(NAN))
    assert np.isnan(block.step(NAN))


def test_input_is_not_changed():
    uc = np.linspace(-5, 5, 41)
    uc.setflags(write=False)
    DeadZoneCompensator(ZONE, 0.3)(uc)[:] = 0.0
    np.testing.assert_array_equal(uc, np.linspace(-5, 5, 41))


def test_frozen_and_json():
    block = DeadZoneCompensator(ZONE, 0.5)
    with pytest.raises(FrozenInstanceError):
        block.centre = 1.0
    data = json.loads(json.dumps(block.to_dict()))
    assert data == {"kind": "dead zone", "centre": 0.5, "left": -1, "right": 2, "left_slope": 2, "right_slope": 4}


@pytest.mark.parametrize("centre", [NAN, INF, None, "middle"])
def test_refuses_a_centre_that_is_not_finite(centre):
    assert "centre" in refusal(ParameterError, DeadZoneCompensator, ZONE, centre)


@pytest.mark.parametrize("zone", [None, lm.Identity(), ZONE.inverse(), {"left": -1, "right": 1}])
def test_refuses_what_is_no_dead_zone(zone):
    message = refusal(ParameterError, DeadZoneCompensator, zone)
    assert type(zone).__name__ in message


def test_refuses_text():
    refusal(InputError, DeadZoneCompensator(ZONE), "high")
