"""What checks outside the repository rely on: names, signatures and behaviour of the documented interface."""

import inspect
import json
from dataclasses import FrozenInstanceError

import numpy as np
import pytest

import lostmotion as lm

EMPTY = inspect.Parameter.empty
FIT_NAMES = (
    "status", "model", "nonlinearity", "linear", "noise", "residuals", "fit_percent", "parameters",
    "standard_errors", "covariance", "interval", "summary", "plot", "to_dict", "compensator",
)  # fmt: skip


@pytest.fixture(scope="module")
def data():
    model = lm.Hammerstein(lm.DeadZone(-1.0, 1.5), lm.LinearModel([-0.8], [0.2], 1))
    u = lm.signals.prs(200, -5, 5, 7, seed=0)
    return u, model.simulate(u) + np.random.default_rng(0).normal(scale=0.05, size=200)


@pytest.fixture(scope="module", params=["dead zone", "none"])
def fit(data, request):
    return lm.identify(*data, dt=1.0, nonlinearity=request.param, orders=(1, 0, 1), noise="white")


@pytest.fixture(scope="module")
def zone_fit(data):
    return lm.identify(*data, dt=1.0, orders=(1, 0, 1), noise=1, nonlinearity="dead zone")


def check_signature(call, expected):
    """Names, order and defaults; further parameters with a default may follow."""
    parameters = inspect.signature(call).parameters
    found = {name: parameter.default for name, parameter in parameters.items()}
    assert list(found)[: len(expected)] == list(expected)
    assert {name: found[name] for name in expected} == expected
    further = {name for name in found if name not in expected and found[name] is EMPTY}
    assert further <= {"dt"}  # keyword-only in LoopRecord


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("DeadZone", {"left": EMPTY, "right": EMPTY, "left_slope": 1.0, "right_slope": 1.0}),
        ("LinearModel", {"a": EMPTY, "b": EMPTY, "delay": 0, "dt": 1.0}),
        ("LinearModel.from_continuous", {"num": EMPTY, "den": EMPTY, "dead_time": EMPTY, "dt": EMPTY}),
        ("Hammerstein", {"nonlinearity": EMPTY, "linear": EMPTY}),
        ("Identity", {}),
        ("Backlash", {"width": EMPTY}),
        ("Stiction", {"band": EMPTY, "jump": EMPTY}),
        ("Saturation", {"low": EMPTY, "high": EMPTY}),
        ("Series", {"actuators": EMPTY}),
        ("PI", {"kp": EMPTY, "ki": EMPTY}),
        ("signals.prs", {"n": EMPTY, "low": EMPTY, "high": EMPTY, "hold": EMPTY, "seed": EMPTY}),
        ("platforms.level_tank", {}),
        (
            "identify",
            {
                "u": EMPTY,
                "y": None,
                "dt": None,
                "nonlinearity": "auto",
                "orders": "auto",
                "noise": "auto",
                "gain": None,
            },
        ),
        ("LoopRecord", {"op": EMPTY, "pv": EMPTY, "sp": None, "position": None}),
    ],
)
def test_signature(name, expected):
    found = lm
    for part in name.split("."):
        found = getattr(found, part)
    check_signature(found, expected)


def test_signature_of_simulate_loop():
    parameters = list(inspect.signature(lm.simulate_loop).parameters)
    names = ["plant", "controller", "reference", "dt", "compensator", "disturbance", "noise", "seed"]
    assert parameters[: len(names)] == names
    assert all(
        inspect.signature(lm.simulate_loop).parameters[name].default is None
        for name in ("compensator", "disturbance", "noise", "seed")
    )


def test_loop_record_wants_dt_by_name():
    assert inspect.signature(lm.LoopRecord).parameters["dt"].kind is inspect.Parameter.KEYWORD_ONLY
    record = lm.LoopRecord([1.0, 2.0], [0.0, 1.0], dt=0.5, tag="FIC-101", source="a.csv")
    assert (record.dt, record.tag, record.source, record.sp, record.position) == (
        0.5,
        "FIC-101",
        "a.csv",
        None,
        None,
    )
    assert record.op.tolist() == [1.0, 2.0]
    with pytest.raises(FrozenInstanceError):
        record.dt = 1.0


def test_everything_in_all_exists_and_is_documented():
    assert len(set(lm.__all__)) == len(lm.__all__)
    for name in lm.__all__:
        assert inspect.getdoc(getattr(lm, name)), name


def test_dead_zone():
    zone = lm.DeadZone(left=-1.0, right=1.0, left_slope=3.0, right_slope=3.0)
    assert zone(2.0) == 3.0
    assert zone(np.array([2.0])).tolist() == [3.0]
    assert zone.inverse()(3.0) == 2.0
    assert lm.Identity()(2.0) == 2.0


def test_linear_model():
    model = lm.LinearModel(a=[-0.5], b=[0.5], delay=1, dt=0.1)
    assert model.gain == 1.0
    assert model.poles.tolist() == [0.5]
    assert model.simulate([1.0, 1.0]).tolist() == [0.0, 0.5]
    assert isinstance(lm.LinearModel.from_continuous([1], [1, 1], 0.2, 0.1), lm.LinearModel)


def test_linear_model_to_control():
    control = pytest.importorskip("control")
    system = lm.LinearModel(a=[-0.5], b=[0.5], delay=1, dt=0.1).to_control()
    assert isinstance(system, control.TransferFunction)
    assert system.dt == 0.1


def test_hammerstein_simulates():
    tank = lm.platforms.level_tank()
    assert isinstance(tank, lm.Hammerstein)
    assert tank.simulate(np.zeros(5)).shape == (5,)


@pytest.mark.parametrize("name", FIT_NAMES)
def test_fit_has(fit, name):
    assert hasattr(type(fit), name) or hasattr(fit, name)


def test_types_of_the_fit(fit):
    assert isinstance(fit, lm.HammersteinFit)
    assert isinstance(fit.status, lm.Status)
    assert isinstance(fit.model, lm.Hammerstein)
    assert isinstance(fit.linear, lm.LinearModel)
    assert fit.nonlinearity is fit.model.nonlinearity
    assert fit.linear is fit.model.linear
    assert isinstance(fit.noise, lm.NoiseModel)
    assert isinstance(fit.fit_percent, float)
    assert isinstance(fit.residuals, np.ndarray)
    assert fit.residuals.ndim == 1
    assert np.isfinite(fit.residuals).all()


def test_parameters_errors_and_covariance_belong_together(fit):
    names = list(fit.parameters)
    assert list(fit.standard_errors) == names
    assert fit.covariance.shape == (len(names), len(names))
    np.testing.assert_allclose(fit.covariance, fit.covariance.T, rtol=1e-9, atol=1e-18)
    np.testing.assert_allclose(np.sqrt(np.diag(fit.covariance)), list(fit.standard_errors.values()))
    for number in (*fit.parameters.values(), *fit.standard_errors.values()):
        assert type(number) is float


def test_parameters_are_the_models(zone_fit):
    parameters, zone, linear = zone_fit.parameters, zone_fit.nonlinearity, zone_fit.linear
    for name in ("left", "right", "left_slope", "right_slope", "width"):
        assert parameters[name] == pytest.approx(getattr(zone, name))
    assert parameters["right_slope"] == 1.0
    assert parameters["gain"] == pytest.approx(linear.gain)
    assert (parameters["a1"], parameters["b0"]) == (linear.a[0], linear.b[0])
    assert parameters["offset"] == zone_fit.model.offset
    assert parameters["slope_ratio"] == pytest.approx(zone.left_slope / zone.right_slope)


def test_interval_holds_the_estimate_and_grows_with_the_level(fit):
    for name, value in fit.parameters.items():
        previous = (value, value)
        for level in (0.5, 0.9, 0.95, 0.99):
            low, high = fit.interval(name, level=level)
            assert low <= previous[0] <= value <= previous[1] <= high, name
            previous = low, high
        assert fit.interval(name) == fit.interval(name, 0.95)
        if fit.standard_errors[name] > 0:
            assert previous[0] < previous[1], name


def test_interval_of_a_break_point_is_normal(zone_fit):
    low, high = zone_fit.interval("right", level=0.95)
    assert 0.5 * (high - low) == pytest.approx(1.959964 * zone_fit.standard_errors["right"], rel=1e-6)
    assert 0.5 * (high + low) == pytest.approx(zone_fit.parameters["right"])


def test_interval_keeps_its_sign(zone_fit):
    for name in ("left_slope", "slope_ratio", "width"):
        assert zone_fit.interval(name, 0.999999)[0] >= 0


def test_to_dict_is_json(fit):
    text = json.dumps(fit.to_dict(), allow_nan=False)
    data = json.loads(text)
    assert data["status"] == fit.status.name
    assert data["parameters"] == fit.parameters
    assert list(data["standard_errors"]) == list(data["parameters"]) == list(data["intervals_95"])
    assert data["data"]["samples"] == 200
    assert data["model"]["linear"] == fit.linear.to_dict()


def test_to_dict_is_a_copy(data):
    fit = lm.identify(*data, dt=1.0, orders=(1, 0, 1), noise="white", nonlinearity="dead zone")
    description = fit.to_dict()
    description["parameters"]["left"] = 99.0
    description["settings"]["chosen"]["na"] = 99
    description["settings"]["orders"][0] = 99
    assert fit.parameters["left"] != 99.0
    assert fit.to_dict()["settings"]["chosen"]["na"] == 1
    assert fit.to_dict()["settings"]["orders"] == [1, 0, 1]


@pytest.mark.parametrize("name", ["status", "model", "parameters", "covariance", "anything"])
def test_fit_is_frozen(fit, name):
    with pytest.raises((FrozenInstanceError, AttributeError, TypeError)):
        setattr(fit, name, None)


def test_same_data_same_fingerprint(data, zone_fit):
    again = lm.identify(*data, dt=1.0, orders=(1, 0, 1), noise=1, nonlinearity="dead zone")
    assert again.data.fingerprint == zone_fit.data.fingerprint
    assert again.to_dict() == zone_fit.to_dict()
    other = lm.identify(data[0], data[1] + 1e-9, dt=1.0, orders=(1, 0, 1), noise=1, nonlinearity="dead zone")
    assert other.data.fingerprint != zone_fit.data.fingerprint


def test_settings_are_kept(zone_fit):
    for name, value in {"nonlinearity": "dead zone", "orders": [1, 0, 1], "noise": 1, "gain": None}.items():
        assert zone_fit.settings[name] == value


def test_records_are_welcome(data, zone_fit):
    record = lm.LoopRecord(*data, dt=1.0, tag="FIC-101")
    for argument in (record, [record]):
        fit = lm.identify(argument, orders=(1, 0, 1), noise=1, nonlinearity="dead zone")
        assert fit.parameters == zone_fit.parameters


def test_compensator_of_a_fit(zone_fit):
    block = zone_fit.compensator()
    uc = np.linspace(-3, 3, 13)
    np.testing.assert_allclose(zone_fit.nonlinearity(block(uc)), uc, atol=1e-12)
    assert [block.step(float(value)) for value in uc] == block(uc).tolist()
    assert isinstance(block(1.0), float)
    assert block.reset() is None
    json.dumps(block.to_dict())


def test_loop_with_the_fit_in_it(zone_fit):
    loop = lm.simulate_loop(
        plant=zone_fit.model, controller=lm.PI(kp=0.5, ki=0.1), reference=np.ones(200), dt=1.0,
        compensator=zone_fit.compensator(), disturbance=np.zeros(200), noise=0.001, seed=1,
    )  # fmt: skip
    assert isinstance(loop, lm.LoopResponse)
    with pytest.raises(FrozenInstanceError):
        loop.output = None
    np.testing.assert_allclose(loop.internal, loop.control, atol=1e-12)


def test_errors_are_one_tree():
    for error in (lm.InputError, lm.FileAccessError):
        assert issubclass(error, lm.LostMotionError)
    for error in (lm.ParameterError, lm.DataError):
        assert issubclass(error, lm.InputError)
        assert issubclass(error, ValueError)
    for error in (lm.ColumnError, lm.TimeError):
        assert issubclass(error, lm.DataError)


def test_every_status_is_a_sentence_with_a_remedy():
    for status in lm.Status:
        assert status.value.endswith(".")
        assert status.ok in (True, False)
        assert status is lm.Status.OK or status.value.count(". ") >= 1
    assert [status for status in lm.Status if status.ok] == [lm.Status.OK, lm.Status.MISFIT]
