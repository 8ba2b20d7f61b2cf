"""Families of actuators with memory: derivatives, segments, rests, projection."""

import numpy as np
import pytest

import lostmotion as lm
from lostmotion import _verbs
from lostmotion.identify.actuators.backlash_family import BacklashFamily
from lostmotion.identify.actuators.saturation import SaturationFamily
from lostmotion.identify.actuators.stiction import StictionFamily
from lostmotion.identify.actuators.stiction_family import RampFamily
from lostmotion.identify.likelihood.courses import Loads, Step, Swing
from lostmotion.identify.likelihood.family import LinearFamily
from lostmotion.models.stiction import CODES
from tests.naive import backlash as slow_backlash
from tests.naive import stiction as slow_stiction
from tests.support.refusals import refusal

WHOLE = np.array([[0, 300]])
HALVES = np.array([[0, 120], [120, 300]])
STEP = 1e-6


def commands(seed):
    """A wandering command: no two samples alike, so that no kink is met by chance."""
    return np.cumsum(np.random.default_rng(seed).normal(scale=0.5, size=300))


def families(segments=WHOLE, load=False):
    return [
        (BacklashFamily(9.0, segments, load=load), [1.3]),
        *[(StictionFamily(9.0, segments, model=model, load=load), [1.3, 0.6]) for model in CODES if model != "he ramp"],
        (RampFamily(9.0, segments, load=load, rests=(0.3, -0.4)), [1.3, 0.6]),
        (SaturationFamily((-9.0, 9.0), load=load), [-0.7, 0.9]),
    ]


def evaluated(family, eta, u):
    x, dx = np.full(u.size, np.nan), np.full((len(family.names), u.size), np.nan)
    family.evaluate(np.array(eta, dtype=float), u, x, dx)
    return x, dx


@pytest.mark.parametrize("load", [False, True])
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("index", range(6))
def test_derivatives_are_finite_differences_between_the_jumps(index, seed, load):
    family, eta = families(HALVES, load)[index]
    eta = [*eta, 0.4] if load else eta
    u = commands(seed)
    _, dx = evaluated(family, eta, u)
    assert len(family.names) == len(eta)
    for row in range(len(eta)):
        if isinstance(family, RampFamily) and row == 1:
            assert not dx[row].any()  # held: the gain undoes it
            continue
        ends = []
        for sign in (1.0, -1.0):
            moved = list(eta)
            moved[row] += sign * STEP
            ends.append(evaluated(family, moved, u)[0])
        slope = (ends[0] - ends[1]) / (2.0 * STEP)
        # elsewhere a break-away moved by a sample; on a ramp it may move fast, and one more or less is rare
        smooth = np.abs(slope) < (1e4 if isinstance(family, RampFamily) else 10.0)
        assert smooth.mean() > 0.98
        np.testing.assert_allclose(dx[row][smooth], slope[smooth], rtol=1e-4, atol=1e-6)


@pytest.mark.parametrize("index", range(6))
def test_path_is_what_evaluate_gives_without_derivatives(index):
    family, eta = families(HALVES)[index]
    u, x = commands(index), np.empty(300)
    family.path(np.array(eta), u, x)
    np.testing.assert_array_equal(x, evaluated(family, eta, u)[0])


def test_positions_are_those_of_the_twins():
    u = commands(5)
    start = u[0] + 0.5 * 0.5 * 1.3
    x, _ = evaluated(BacklashFamily(9.0, WHOLE, rests=(0.5,)), [1.3], u)
    np.testing.assert_allclose(x, slow_backlash.backlash(u, 1.3, start), atol=1e-12)
    start = u[0] + 0.5 * 0.5 * (1.3 + 0.6)
    for model, slow in slow_stiction.MODELS.items():
        x, _ = evaluated(StictionFamily(9.0, WHOLE, rests=(0.5,), model=model), [1.3, 0.6], u)
        np.testing.assert_allclose(x, slow(u, 1.3, 0.6, start), atol=1e-12)


@pytest.mark.parametrize("index", range(4))
def test_memory_begins_anew_in_every_segment(index):
    both, eta = families(HALVES)[index]
    alone, _ = families(np.array([[0, 180]]))[index]
    u = commands(1)
    x, dx = evaluated(both, eta, u)
    second, slopes = evaluated(alone, eta, u[120:])
    np.testing.assert_array_equal(x[120:], second)
    np.testing.assert_array_equal(dx[:, 120:], slopes)
    through, _ = evaluated(families(WHOLE)[index][0], eta, u)
    assert not np.array_equal(through[120:], second)


def test_rests_of_a_valve_that_begins_anywhere_in_its_band():
    u = np.zeros(300)
    u[150:] = 3.0
    for rest in (-1.0, -0.25, 0.5, 1.0):
        family = StictionFamily(9.0, WHOLE, rests=(rest,))
        x, _ = evaluated(family, [1.3, 0.7], u)
        np.testing.assert_allclose(x[:150], rest)  # half of band and jump together
        assert x[-1] == pytest.approx(3.0 - 0.5 * (1.3 - 0.7))
        x, _ = evaluated(BacklashFamily(9.0, WHOLE, rests=(rest,)), [2.0], u)
        np.testing.assert_allclose(x[:150], rest)
        assert x[-1] == pytest.approx(2.0)
    second = BacklashFamily(9.0, HALVES, rests=(1.0,))  # the second segment: in the middle
    assert evaluated(second, [2.0], np.zeros(300))[0][[0, 120]].tolist() == [1.0, 0.0]


def test_projection_and_names():
    play, stiff = BacklashFamily(4.0, WHOLE), StictionFamily(4.0, WHOLE)
    clamp = SaturationFamily((-2.0, 2.0))
    assert play.project(np.array([-1.0])).tolist() == [0.0]
    assert play.with_load(True).project(np.array([9.0, -3.0])).tolist() == [4.0, -3.0]
    assert stiff.project(np.array([1.0, 9.0])).tolist() == [1.0, 3.0]
    assert stiff.project(np.array([-1.0, 1.0])).tolist() == [0.0, 0.0]
    assert clamp.project(np.array([1.0, -5.0])).tolist() == [-2.0, 1.0]
    for family in (play, stiff, clamp, LinearFamily()):
        assert family.with_load(True).names == (*family.names, "load")
        assert family.with_load(True).with_load(False) == family


def test_load_is_added_behind_the_actuator():
    u = commands(2)
    for family, eta in families():
        x, _ = evaluated(family, eta, u)
        loaded, dx = evaluated(family.with_load(True), [*eta, -0.3], u)
        np.testing.assert_allclose(loaded, x - 0.3)
        assert (dx[-1] == 1.0).all()


def test_only_a_dead_zone_and_a_backlash_have_an_inverse():
    assert _verbs.compensator(lm.Backlash(1.0)).kind == "backlash"
    assert "block" in refusal(lm.ParameterError, _verbs.compensator, lm.Stiction(1.0, 0.5))


def test_families_with_loads():
    time = np.arange(200)
    shapes = np.vstack([np.sin(time), np.cos(time), time > 10.0]).astype(float)
    both = Loads((Swing(2.0 * np.pi, 0, 200), Step(11, 0, 200)), 200)
    family = LinearFamily().with_loads(both).with_load(True)
    assert family.names == ("load", "sine", "cosine", "step")
    assert family.sought == 2
    u, eta = np.linspace(-1, 1, 200), np.array([0.5, 1.0, -2.0, 3.0])
    x, dx = np.empty(200), np.empty((4, 200))
    family.evaluate(eta, u, x, dx)
    np.testing.assert_allclose(x, u + 0.5 + np.sin(time) - 2 * np.cos(time) + 3.0 * (time > 10))
    np.testing.assert_allclose(dx[1:], shapes, atol=1e-12)
    assert both.kept([1]).events == (Step(11, 0, 200),)
    assert both.kept([1]).shapes.shape == (1, 200)
    assert both.kept([]) is None
    assert both.joined(both).shapes.shape == (6, 200)


def test_a_load_acts_in_its_own_segment():
    later = Loads((Swing(8.0, 50, 90), Step(60, 50, 90)), 200).shapes
    assert not later[:, :50].any()
    assert not later[:, 90:].any()
    np.testing.assert_allclose(later[0, 50:90], np.sin(np.arange(40) * np.pi / 4), atol=1e-12)
    assert later[2].sum() == 30


def test_courses_of_several_fits_by_turns():
    one, other = Loads((Step(11, 0, 200),), 200), Loads((Step(12, 0, 200),), 200)
    for loads, rows in ((one, 189), (other, 188), (one, 189), (one, 189)):
        assert loads.shapes.sum() == rows
