import json

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.models import SeriesInverse, actuator_from_dict
from tests.support.refusals import refusal

VALVE = lm.Series((lm.Backlash(1.0), lm.DeadZone(-1.0, 2.0, 0.5, 2.0)))


def test_is_one_behind_the_other():
    u = np.cumsum(np.random.default_rng(0).normal(size=300))
    one, other = VALVE.actuators
    np.testing.assert_array_equal(VALVE(u), other(one(u)))
    assert not np.allclose(VALVE(u), one(other(u)))  # the order matters
    assert VALVE(4.0) == 4.0


def test_inverse():
    v = np.cumsum(np.random.default_rng(1).normal(size=300))
    np.testing.assert_allclose(VALVE(VALVE.inverse()(v)), v, atol=1e-12)
    assert VALVE.inverse().inverse() is VALVE
    assert VALVE.inverse() == SeriesInverse(VALVE)


def test_lists_and_nested_series_are_welcome():
    nested = lm.Series([VALVE, lm.Saturation(-1, 1)])
    assert nested.actuators == (VALVE, lm.Saturation(-1, 1))
    assert nested([0.0, 9.0]).tolist() == [0.0, 1.0]


@pytest.mark.parametrize(
    "actuator",
    [
        lm.Backlash(1.0), lm.DeadZone(-1, 1), lm.Identity(), lm.Saturation(0, 1), lm.Stiction(2, 1, "he"), VALVE,
        lm.Series((VALVE, lm.Identity())),
    ],
)  # fmt: skip
def test_description_survives_json(actuator):
    data = json.loads(json.dumps(actuator.to_dict()))
    assert actuator_from_dict(data) == actuator
    assert type(actuator).from_dict(data) == actuator


def test_in_a_hammerstein_model():
    model = lm.Hammerstein(VALVE, lm.LinearModel([-0.5], [0.5], 1))
    u = np.sin(np.arange(50.0)) * 5
    np.testing.assert_array_equal(model.simulate(u), model.linear.simulate(VALVE(u)))
    assert model.to_dict()["nonlinearity"]["kind"] == "series"


@pytest.mark.parametrize("actuators", [(), None, 3, (lm.Backlash(1.0), "dead zone"), (abs,)])
def test_refuses_what_is_no_actuator(actuators):
    assert "actuator" in refusal(lm.ParameterError, lm.Series, actuators)


def test_other_refusals():
    assert "stiction" in refusal(lm.ParameterError, lm.Series((lm.Stiction(1, 1),)).inverse)
    assert "'gearbox'" in refusal(lm.ParameterError, actuator_from_dict, {"kind": "gearbox"})
    refusal(lm.ParameterError, actuator_from_dict, {})
    refusal(lm.ParameterError, actuator_from_dict, {"kind": "backlash"})
    refusal(lm.ParameterError, lm.Series.from_dict, {"kind": "series"})
