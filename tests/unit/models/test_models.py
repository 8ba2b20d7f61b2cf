from dataclasses import FrozenInstanceError

import numpy as np
import pytest

from lostmotion.errors import DataError, InputError, ParameterError
from lostmotion.models import DeadZone, Hammerstein, Identity, LinearModel, NoiseModel
from tests.support.refusals import refusal

NAN, INF = float("nan"), float("inf")
LAG = LinearModel([-0.5], [0.5], 1, 0.1)


def test_dead_zone_by_hand():
    zone = DeadZone(-1, 2, left_slope=0.5, right_slope=3)
    assert zone([-3, -1, 0, 2, 4]).tolist() == [-1.0, 0.0, 0.0, 0.0, 6.0]
    assert zone.width == 3.0
    assert zone.inverse()([-1, 0, 6]).tolist() == [-3.0, 0.0, 4.0]


@pytest.mark.parametrize(("left", "right", "at_zero"), [(-1, 2, 0), (1, 2, 1), (-2, -1, -1), (0, 2, 0), (3, 3, 3)])
def test_inverse_at_zero(left, right, at_zero):
    assert DeadZone(left, right).inverse()(0.0) == at_zero


def test_width_zero_is_allowed():
    assert DeadZone(2, 2)([1.0, 2.0, 3.5]).tolist() == [-1.0, 0.0, 1.5]


@pytest.mark.parametrize("name", ["left", "right", "left_slope", "right_slope"])
@pytest.mark.parametrize("value", [NAN, INF, -INF, None, "wide", [1.0, 2.0]])
def test_dead_zone_refuses_what_is_not_a_number(name, value):
    settings = {"left": -1.0, "right": 1.0, name: value}
    assert name in refusal(ParameterError, DeadZone, **settings)


@pytest.mark.parametrize("name", ["left_slope", "right_slope"])
@pytest.mark.parametrize("value", [0, 0.0, -1.0])
def test_dead_zone_refuses_slopes_that_are_not_positive(name, value):
    assert refusal(ParameterError, DeadZone, -1, 1, **{name: value}).startswith(f"expected {name} > 0, got {value}")


def test_dead_zone_refuses_crossed_break_points():
    message = refusal(ParameterError, DeadZone, 1.0, -1.0)
    assert "left=1.0, right=-1.0" in message


def test_dead_zone_refuses_what_is_no_signal():
    refusal(InputError, DeadZone(-1, 1), "wide open")


@pytest.mark.parametrize("model", [DeadZone(-1, 1), DeadZone(-1, 1).inverse(), Identity()])
def test_shapes_types_and_missing_values(model):
    assert isinstance(model(3), float)
    assert isinstance(model(np.float64(3)), float)
    assert model(np.zeros((2, 3, 1))).shape == (2, 3, 1)
    assert model([]).shape == (0,)
    assert model(np.arange(12, dtype=np.int8).reshape(3, 4)[:, ::2]).dtype == np.float64
    assert np.isnan(model([NAN, 0.0])).tolist() == [True, False]
    assert np.abs(model([-INF, INF])).tolist() == [INF, INF]


@pytest.mark.parametrize("model", [DeadZone(-1, 1), DeadZone(-1, 1).inverse(), Identity(), LAG.simulate])
def test_signals_are_not_changed_and_not_shared(model):
    u = np.linspace(-2.0, 2.0, 9)
    copy = u.copy()
    model(u)[:] = 7.0
    np.testing.assert_array_equal(u, copy)
    u.setflags(write=False)
    model(u)


@pytest.mark.parametrize(
    ("model", "name"),
    [
        (DeadZone(-1, 1), "left"),
        (DeadZone(-1, 1).inverse(), "dead_zone"),
        (LAG, "a"),
        (NoiseModel((0.1,), 2.0), "d"),
        (Hammerstein(Identity(), LAG), "offset"),
    ],
)
def test_models_are_frozen_values(model, name):
    with pytest.raises(FrozenInstanceError):
        setattr(model, name, 3.0)
    assert hash(model) == hash(model)


def test_linear_by_hand():
    model = LinearModel(a=[-0.5], b=[1.0, 2.0], delay=2)
    assert model.simulate([1, 0, 0, 0, 0]).tolist() == [0.0, 0.0, 1.0, 2.5, 1.25]
    assert model.gain == 6.0
    assert model.poles.tolist() == [0.5]
    assert model.step_response(4).tolist() == [0.0, 0.0, 1.0, 3.5]


def test_linear_without_poles():
    model = LinearModel(a=[], b=[2.0], delay=0)
    assert (model.gain, model.poles.size, model.is_stable) == (2.0, 0, True)
    assert model.simulate([1.0, 2.0]).tolist() == [2.0, 4.0]


def test_integrator():
    model = LinearModel.from_continuous([1.0], [1.0, 0.0], dead_time=0.0, dt=0.5)
    np.testing.assert_allclose(model.step_response(4), [0.0, 0.5, 1.0, 1.5])
    assert model.gain == INF
    assert LinearModel([-1.0], [-0.5]).gain == -INF
    assert not model.is_stable


def test_time_constants_are_those_of_the_slowest_pole_that_settles():
    one = LinearModel.from_continuous([1.0], np.polymul([40.0, 1.0], [5.0, 1.0]), 6.0, 2.0)
    assert one.slowest_time_constant == pytest.approx(40.0, rel=1e-9)
    assert one.slowest_lag() == pytest.approx(20.0, rel=1e-9)
    assert one.slowest_lag(within=np.exp(-1 / 10)) == pytest.approx(2.5, rel=1e-9)
    assert one.process_time == pytest.approx(8.0 + 40.0, rel=1e-9)
    assert not one.integrates()


@pytest.mark.parametrize("a", [(), (-1.0,), (0.0,)])
def test_without_a_lag_the_process_time_is_the_dead_time(a):
    model = LinearModel(a, [0.5], 3, 2.0)
    assert (model.slowest_lag(), model.slowest_time_constant, model.process_time) == (0.0, 0.0, 6.0)
    assert LinearModel(a, [0.5], 0, 2.0).process_time == 2.0


def test_integrator_with_a_lag():
    model = LinearModel(np.poly([1.0, np.exp(-1 / 7)])[1:], [0.1], 1)
    assert model.integrates()
    assert model.integrates(within=1e-9)
    assert model.slowest_lag() == pytest.approx(7.0)
    slow = LinearModel([-(1.0 - 1e-7)], [0.1], 1)
    assert (slow.integrates(), slow.integrates(within=1e-9)) == (True, False)


def test_linear_keeps_its_own_coefficients():
    a, b = np.array([-0.5]), np.array([0.5])
    model = LinearModel(a, b)
    a[0] = b[0] = 9.0
    assert (model.a, model.b) == ((-0.5,), (0.5,))


@pytest.mark.parametrize("name", ["a", "b"])
@pytest.mark.parametrize("value", [[NAN], [INF], [[0.5]], 0.5, ["half"], None])
def test_linear_refuses_bad_coefficients(name, value):
    settings = {"a": [-0.5], "b": [0.5], name: value}
    assert name in refusal(ParameterError, LinearModel, **settings)


def test_linear_refuses_no_numerator():
    refusal(ParameterError, LinearModel, [-0.5], [])


@pytest.mark.parametrize("delay", [-1, 1.5, NAN, INF, "two", None])
def test_linear_refuses_bad_delay(delay):
    assert "delay" in refusal(ParameterError, LinearModel, [-0.5], [0.5], delay)


@pytest.mark.parametrize("dt", [0.0, -0.1, NAN, INF, None])
def test_linear_refuses_bad_dt(dt):
    assert "dt" in refusal(ParameterError, LinearModel, [-0.5], [0.5], 1, dt)


def test_whole_delay_may_come_as_a_float():
    assert LinearModel([], [1.0], 2.0).delay == 2
    assert type(LinearModel([], [1.0], np.int64(2)).delay) is int


@pytest.mark.parametrize(
    ("num", "den"),
    [
        ([1, 0, 0], [1, 1]),
        ([], [1, 1]),
        ([0.0], [1, 1]),
        ([1], []),
        ([1], [0, 1]),
        ([NAN], [1, 1]),
        ([1], [1, NAN]),
    ],
)
def test_from_continuous_refuses_bad_transfer_functions(num, den):
    refusal(ParameterError, LinearModel.from_continuous, num, den, 0.0, 0.1)


@pytest.mark.parametrize("dead_time", [-0.1, NAN, INF])
def test_from_continuous_refuses_bad_dead_time(dead_time):
    assert "dead_time" in refusal(ParameterError, LinearModel.from_continuous, [1], [1, 1], dead_time, 0.1)


@pytest.mark.parametrize("dt", [0.0, -0.1, NAN])
def test_from_continuous_refuses_bad_dt(dt):
    assert "dt" in refusal(ParameterError, LinearModel.from_continuous, [1], [1, 1], 0.0, dt)


def test_from_continuous_of_a_gain_with_fractional_dead_time():
    assert LinearModel.from_continuous([3], [1], 0.0, 0.1).step_response(2).tolist() == [3.0, 3.0]
    assert LinearModel.from_continuous([3], [1], 0.25, 0.1).step_response(5).tolist() == [0.0, 0.0, 0.0, 3.0, 3.0]


def test_rounding_of_the_dead_time_adds_no_coefficient():
    model = LinearModel.from_continuous([1], [1, 1], dead_time=0.3, dt=0.1)  # 0.3 / 0.1 is below 3
    assert (model.delay, len(model.b)) == (4, 1)


def test_from_control_refuses_a_continuous_system():
    control = pytest.importorskip("control")
    refusal(ParameterError, LinearModel.from_control, control.tf([1], [1, 1]))
    refusal(ParameterError, LinearModel.from_control, control.tf([1], [1, 1], True))


def test_from_dict_names_the_keys():
    assert "a, b, delay, dt" in refusal(InputError, LinearModel.from_dict, {"a": [0.5]})


@pytest.mark.parametrize("x", [[[1.0, 2.0]], 1.0])
def test_simulate_refuses_other_than_one_signal(x):
    refusal(DataError, LAG.simulate, x)
    refusal(DataError, Hammerstein(Identity(), LAG).simulate, x)


def test_simulate_refuses_text():
    refusal(DataError, LAG.simulate, ["high", "low"])


def test_hammerstein_by_hand():
    model = Hammerstein(DeadZone(-1, 1), LAG, offset=10)
    assert model.simulate([3.0, 0.5, 0.5]).tolist() == [10.0, 11.0, 10.5]
    assert model.offset == 10.0
    description = {"nonlinearity": model.nonlinearity.to_dict(), "linear": LAG.to_dict(), "offset": 10.0}
    assert model.to_dict() == description


@pytest.mark.parametrize("offset", [NAN, INF, None, "zero"])
def test_hammerstein_refuses_bad_offset(offset):
    assert "offset" in refusal(ParameterError, Hammerstein, Identity(), LAG, offset)


def test_noise_model():
    model = NoiseModel([0.5, -0.1], 2)
    assert (model.order, model.d, model.variance) == (2, (0.5, -0.1), 2.0)
    assert NoiseModel().order == 0
    assert model.to_dict() == {"d": [0.5, -0.1], "variance": 2.0}


@pytest.mark.parametrize("settings", [{"d": [NAN]}, {"d": [[1.0]]}, {"variance": NAN}, {"variance": -1.0}])
def test_noise_model_refuses(settings):
    assert next(iter(settings)) in refusal(ParameterError, NoiseModel, **settings)


def test_a_small_gain_per_time_constant_is_not_lost():
    """SciPy drops leading coefficients below 1e-14: such a gain was a model of nothing, with a warning."""
    usual = LinearModel.from_continuous([1.0], [30.0, 1.0], 0.0, 1.0)
    small = LinearModel.from_continuous([1e-20], [30.0, 1.0], 0.0, 1.0)
    assert np.allclose(small.b, np.array(usual.b) * 1e-20, rtol=1e-12, atol=0.0)
