"""A characteristic that bends behind the lost motion: found, along the valve, no fault by itself."""

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identify.actuators.characteristic import LEAST_SLOPE, bent, slopes
from lostmotion.identify.actuators.fit_kind import fit_linear
from lostmotion.identify.actuators.loads import sizes_of_loads, without_actuator
from lostmotion.identify.chosen import Chosen
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.courses import Bend, Loads
from lostmotion.identify.scaled import ScaledData
from lostmotion.report.remarks_on_fit import fit_remarks

N = 1500
PROCESS = lm.LinearModel([-0.85], [0.15], 2, 1.0)


def command(seed=0, low=30.0, high=70.0):
    return np.repeat(np.random.default_rng(seed).uniform(low, high, size=N // 15), 15)


def equal_percentage(x):
    """Rangeability 50, with slope 1 at 50 %."""
    return 50.0 ** ((x - 50.0) / 100.0) * 100.0 / np.log(50.0)


def record(x, seed=0, deviation=0.3):
    return PROCESS.simulate(x) + np.random.default_rng(seed).normal(scale=deviation, size=N)


def test_courses_have_no_straight_line_and_slopes_are_those_of_the_curve():
    position = np.random.default_rng(0).normal(3.0, 2.0, size=400)
    bend, courses = Bend(position), np.empty((2, 400))
    bend.fill(courses)
    assert np.abs(courses @ np.column_stack([position, np.ones(400)])).max() < 1e-9 * 400
    sizes, step = np.array([0.7, -0.2]), 1e-6
    order = np.argsort(position)
    curve = np.interp(position[order] + step, position[order], position[order] + sizes @ courses[:, order])
    assert bend.slopes(np.zeros(2), position).tolist() == [1.0] * 400
    inner = slice(50, -50)  # between two positions the curve is a straight line
    between = np.diff(curve) / np.diff(position[order])
    middle = 0.5 * (position[order][1:] + position[order][:-1])
    np.testing.assert_allclose(between[inner], bend.slopes(sizes, middle)[inner], rtol=1e-3)


def test_the_bend_of_another_way_keeps_the_other_loads():
    loads = Loads((Bend(np.arange(5.0)),), 5)
    other = loads.along(np.arange(5.0) ** 2)
    assert loads.bend == 0
    assert loads.sought == 0
    assert other.events[0].position[-1] == 16.0
    assert loads.to_dicts() == ()


def test_slopes_survive_their_file():
    chosen = Chosen(1, 0, 2, 1, slopes=(0.5, 1.8))
    assert Chosen.from_dict(chosen.to_dict()) == chosen
    assert Chosen.from_dict({"na": 1, "nb": 0, "delay": 2, "noise_order": 1}).slopes is None


@pytest.mark.statistics
@pytest.mark.parametrize("seed", range(4))
def test_a_straight_valve_stays_straight(seed):
    fitted = fit_linear(ScaledData(command(seed), record(command(seed), seed), np.array([[0, N]])), Asked())
    assert bent(fitted) is fitted
    assert slopes(fitted) is None


@pytest.mark.statistics
def test_an_equal_percentage_valve_bends_as_it_does():
    u = command()
    fitted = bent(fit_linear(ScaledData(u, record(equal_percentage(u)), np.array([[0, N]])), Asked()))
    low, high = slopes(fitted)
    assert high / low == pytest.approx(50.0**0.4, rel=0.15)
    assert bent(fitted).problem.family.loads.bend == 0


@pytest.mark.statistics
def test_a_characteristic_that_turns_back_is_none():
    u = command()
    fitted = bent(fit_linear(ScaledData(u, record(0.05 * (u - 45.0) ** 2), np.array([[0, N]])), Asked()))
    assert slopes(fitted) is None or min(slopes(fitted)) > LEAST_SLOPE


@pytest.mark.statistics
@pytest.mark.parametrize("kind", ["none", "backlash", "stiction", "dead zone"])
def test_the_fault_behind_a_bent_characteristic_is_told(kind):
    """With a straight one a dead zone of any size is seen, and nothing is told."""
    u = command(3)
    valve = {
        "none": lm.Identity(), "backlash": lm.Backlash(3.0), "stiction": lm.Stiction(4.0, 2.0),
        "dead zone": lm.DeadZone(48.0, 52.0),
    }[kind]  # fmt: skip
    x = valve(u) + (0.0 if kind != "dead zone" else 50.0)
    fit = lm.identify(u, record(equal_percentage(x)), 1.0)
    assert fit.kind.name == kind
    assert fit.chosen.slopes[0] < 0.8
    assert fit.chosen.slopes[1] > 1.2
    assert any("characteristic bends" in line for line in fit_remarks(fit))
    if kind != "none":
        size = fit.kind.size
        low, high = fit.interval(size)
        assert low < {"backlash": 3.0, "stiction": 4.0, "dead zone": 4.0}[kind] < high


@pytest.mark.statistics
def test_the_sound_valve_beside_a_fault_bends_along_op():
    """What the position of the valve tells of its lost motion is not given to the model without one."""
    u = command(3)
    x = lm.Backlash(6.0)(u)
    fitted = fit_linear(ScaledData(u, record(equal_percentage(x)), np.array([[0, N]])), Asked())
    loads = Loads((Bend(x),), N)
    plain = bent(fitted).problem
    assert isinstance(plain.family.loads.events[0], Bend)
    beside = without_actuator(bent(fitted))
    np.testing.assert_array_equal(beside.problem.family.loads.events[0].position, u)
    assert sizes_of_loads(beside).size == len(loads.names)
