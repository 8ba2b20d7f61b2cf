from dataclasses import FrozenInstanceError, fields

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.compensate import DeadZoneCompensator
from lostmotion.errors import DataError, ParameterError
from tests.support.refusals import refusal

NAN, INF = float("nan"), float("inf")
TANK = lm.platforms.level_tank()
PI = lm.PI(0.5, 0.7)
STEP = np.ones(300)


def test_linear_loop_settles_on_the_reference():
    loop = lm.simulate_loop(TANK.linear, PI, np.full(600, 2.0))
    assert loop.output[-1] == pytest.approx(2.0, abs=1e-4)
    np.testing.assert_array_equal(loop.control, loop.command)
    np.testing.assert_array_equal(loop.command, loop.internal)
    np.testing.assert_array_equal(loop.output, loop.measured)


def test_response_belongs_together():
    loop = lm.simulate_loop(TANK, PI, STEP, noise=0.03, seed=1)
    assert len(loop) == 300
    arrays = [getattr(loop, field.name) for field in fields(loop) if field.name != "dt"]
    assert {array.shape for array in arrays} == {(300,)}
    np.testing.assert_allclose(loop.time, 0.1 * np.arange(300))
    assert loop.dt == 0.1
    np.testing.assert_allclose(TANK.simulate(loop.command), loop.output, atol=1e-12)
    np.testing.assert_array_equal(TANK.nonlinearity(loop.command), loop.internal)
    with pytest.raises(FrozenInstanceError):
        loop.dt = 1.0


def test_right_compensator_makes_the_loop_linear():
    inverse = TANK.nonlinearity.inverse()
    linear = lm.simulate_loop(TANK.linear, PI, STEP, noise=0.01, seed=2)
    for compensator in (inverse, DeadZoneCompensator(TANK.nonlinearity)):
        loop = lm.simulate_loop(TANK, PI, STEP, compensator=compensator, noise=0.01, seed=2)
        np.testing.assert_allclose(loop.output, linear.output, atol=1e-9)
        np.testing.assert_allclose(loop.internal, loop.control, atol=1e-12)
        np.testing.assert_array_equal(loop.command, inverse(loop.control))


def test_noise_by_variance_by_seed_and_by_samples():
    loop = lm.simulate_loop(TANK, PI, np.zeros(3000), noise=0.04, seed=5)
    noise = loop.measured - loop.output
    assert noise.var() == pytest.approx(0.04, rel=0.1)
    again = lm.simulate_loop(TANK, PI, np.zeros(3000), noise=0.04, seed=np.random.default_rng(5))
    np.testing.assert_array_equal(again.measured, loop.measured)
    given = lm.simulate_loop(TANK, PI, np.zeros(3000), noise=noise)
    np.testing.assert_allclose(given.measured, loop.measured, atol=1e-9)
    silent = lm.simulate_loop(TANK, PI, STEP, noise=0.0)
    np.testing.assert_array_equal(silent.measured, silent.output)


def test_disturbance_is_at_the_output_behind_its_path():
    path = lm.LinearModel([-0.9], [0.1], 1, 0.1)
    quiet = lm.PI(0.0, 0.0)
    loop = lm.simulate_loop(TANK, quiet, np.zeros(50), disturbance=np.ones(50))
    np.testing.assert_array_equal(loop.output, np.ones(50))
    loop = lm.simulate_loop(TANK, quiet, np.zeros(50), disturbance=np.ones(50), disturbance_path=path)
    np.testing.assert_allclose(loop.output, path.step_response(50))


def test_limits_and_windup():
    bounded = lm.PI(0.5, 0.7, low=-2.0, high=2.0)
    reference = np.concatenate([np.full(600, 50.0), np.zeros(200)])
    loop = lm.simulate_loop(TANK, bounded, reference)
    assert loop.control.max() == 2.0
    assert loop.control.min() >= -2.0
    assert loop.control[601] < 0.5  # a wound-up integral would hold the limit for long


def test_bias_is_the_output_at_rest():
    offset = lm.Hammerstein(lm.DeadZone(44, 46), TANK.linear, offset=50.0)
    loop = lm.simulate_loop(offset, lm.PI(0.5, 0.7, bias=45.0), np.full(20, 50.0))
    np.testing.assert_array_equal(loop.control, np.full(20, 45.0))
    np.testing.assert_array_equal(loop.output, np.full(20, 50.0))


def test_negative_process_with_negative_controller():
    loop = lm.simulate_loop(TANK.linear.scaled(-1.0), lm.PI(-0.5, -0.7), np.full(600, 2.0))
    assert loop.output[-1] == pytest.approx(2.0, abs=1e-4)


def test_nothing_handed_in_is_changed():
    arrays = [np.ones(100), 0.1 * np.ones(100), 0.2 * np.ones(100)]
    copies = [array.copy() for array in arrays]
    for array in arrays:
        array.setflags(write=False)
    lm.simulate_loop(TANK, PI, arrays[0], disturbance=arrays[1], noise=arrays[2])
    for array, copy in zip(arrays, copies, strict=True):
        np.testing.assert_array_equal(array, copy)


def test_result_does_not_change_with_what_was_handed_in():
    reference = np.ones(100)
    loop = lm.simulate_loop(TANK, PI, reference)
    reference[0] = 9.0
    assert loop.reference[0] == 1.0


def test_refuses_an_unstable_plant():
    message = refusal(ParameterError, lm.simulate_loop, lm.LinearModel([-1.2], [0.1], 1), PI, STEP)
    assert "stable" in message


def test_refuses_a_plant_without_delay():
    assert "delay" in refusal(ParameterError, lm.simulate_loop, lm.LinearModel([-0.5], [0.5], 0), PI, STEP)


@pytest.mark.parametrize("dt", [0.2, 0.0, -0.1, NAN])
def test_refuses_another_dt(dt):
    assert "dt=0.1" in refusal(ParameterError, lm.simulate_loop, TANK, PI, STEP, dt)


@pytest.mark.parametrize("name", ["disturbance", "noise"])
def test_refuses_other_lengths(name):
    message = refusal(DataError, lm.simulate_loop, TANK, PI, STEP, **{name: np.zeros(299)})
    assert name in message
    assert "300" in message
    assert "299" in message


@pytest.mark.parametrize("name", ["reference", "disturbance", "noise"])
@pytest.mark.parametrize("bad", [NAN, INF])
def test_refuses_signals_that_are_not_finite(name, bad):
    signals = {"reference": STEP, name: np.where(np.arange(300) == 17, bad, 0.0)}
    assert name in refusal(DataError, lm.simulate_loop, TANK, PI, **signals)


@pytest.mark.parametrize("variance", [-0.1, NAN, INF])
def test_refuses_noise_variance(variance):
    assert "variance" in refusal(ParameterError, lm.simulate_loop, TANK, PI, STEP, noise=variance)


def test_refuses_a_reference_of_two_dimensions():
    assert "reference" in refusal(DataError, lm.simulate_loop, TANK, PI, [[1.0, 2.0]])


def test_refuses_an_unknown_actuator():
    class Sticky:
        kind = "sticky"

        def __call__(self, u):
            return u

        def to_dict(self):
            return {}

    message = refusal(ParameterError, lm.simulate_loop, lm.Hammerstein(Sticky(), TANK.linear), PI, STEP)
    assert "Sticky" in message


def test_refuses_a_compensator_in_absolute_units():
    block = DeadZoneCompensator(lm.DeadZone(44, 46), centre=45)
    assert "centre" in refusal(ParameterError, lm.simulate_loop, TANK, PI, STEP, compensator=block)


@pytest.mark.parametrize("name", ["kp", "ki", "bias"])
@pytest.mark.parametrize("value", [NAN, INF, None, "fast"])
def test_controller_refuses_what_is_not_a_number(name, value):
    assert name in refusal(ParameterError, lm.PI, **{"kp": 1.0, "ki": 1.0, name: value})


@pytest.mark.parametrize(("low", "high"), [(1, 1), (2, 1), (NAN, 1), (0, NAN)])
def test_controller_refuses_limits(low, high):
    assert "low" in refusal(ParameterError, lm.PI, 1.0, 1.0, low, high)


VALVES = [
    lm.DeadZone(-0.4, 0.6, 1.5, 1.0),
    lm.Backlash(0.8),
    lm.Stiction(0.8, 0.5),
    lm.Stiction(0.8, 0.3, "he"),
    lm.Stiction(0.8, 0.4, "choudhury"),
    lm.Saturation(-0.5, 1.2),
    lm.Identity(),
]


@pytest.mark.parametrize("bias", [0.0, 0.7])
@pytest.mark.parametrize("valve", VALVES, ids=lambda valve: f"{valve.kind} {getattr(valve, 'model', '')}")
def test_internal_is_the_actuator_of_the_command(valve, bias):
    """Every actuator; with memory it begins at rest at the bias of the controller."""
    plant = lm.Hammerstein(valve, TANK.linear)
    reference = np.repeat([0.0, 2.0, -1.0, 0.5], 100)
    loop = lm.simulate_loop(plant, lm.PI(0.5, 0.7, bias=bias), reference, noise=0.02, seed=4)
    memory = hasattr(valve, "run")
    wanted = valve.run(loop.command, start=bias) if memory else valve(loop.command)
    np.testing.assert_allclose(loop.internal, wanted, atol=1e-12)
    np.testing.assert_allclose(TANK.linear.simulate(loop.internal), loop.output, atol=1e-9)
    assert np.unique(np.sign(np.diff(loop.internal))).size >= 2
