import json

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.kernels import saturation as kernel
from tests.naive import saturation as slow
from tests.support.refusals import refusal

NAN, INF = float("nan"), float("inf")


@pytest.mark.parametrize("seed", range(6))
def test_twin_and_derivatives(seed):
    rng = np.random.default_rng(seed)
    low, high = np.sort(rng.uniform(-3, 3, 2))
    u = np.concatenate([rng.uniform(-6, 6, 80), [low, high]])
    np.testing.assert_array_equal(kernel.run(u, low, high), slow.saturation(u, low, high))
    x, dx = np.empty(u.size), np.empty((2, u.size))
    kernel.sensitivities(u, low, high, x, dx)
    np.testing.assert_array_equal(x, kernel.run(u, low, high))
    h, inner = 1e-7, slice(80)  # at the limits themselves there is no derivative
    by_low = (kernel.run(u, low + h, high) - kernel.run(u, low - h, high)) / (2 * h)
    by_high = (kernel.run(u, low, high + h) - kernel.run(u, low, high - h)) / (2 * h)
    np.testing.assert_allclose(dx[:, inner], np.array([by_low, by_high])[:, inner], atol=1e-7)


def test_by_hand():
    valve = lm.Saturation(-1, 2)
    assert valve([[-3, 0], [2, 5]]).tolist() == [[-1, 0], [2, 2]]
    assert valve(7.0) == 2.0
    assert np.isnan(valve(NAN))
    assert valve(INF) == 2.0
    assert valve.inverse() is valve


def test_description_survives_json():
    valve = lm.Saturation(-1, 2)
    assert lm.Saturation.from_dict(json.loads(json.dumps(valve.to_dict()))) == valve
    assert valve.to_dict()["kind"] == "saturation"


@pytest.mark.parametrize("name", ["low", "high"])
@pytest.mark.parametrize("value", [NAN, INF, -INF, None, "wide", [1.0, 2.0]])
def test_refuses_what_is_not_a_number(name, value):
    assert name in refusal(lm.ParameterError, lm.Saturation, **{"low": -1.0, "high": 1.0, name: value})


def test_refuses_crossed_limits_and_missing_keys():
    assert "low=1.0, high=-1.0" in refusal(lm.ParameterError, lm.Saturation, 1, -1)
    refusal(lm.ParameterError, lm.Saturation.from_dict, {"low": 0})
