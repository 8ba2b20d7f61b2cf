import json

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from lostmotion.models import Hammerstein, LinearModel
from tests.naive import linear as slow_linear
from tests.properties.strategies import dead_zones, linear_models, polynomial, roots, signals

control = pytest.importorskip("control")
poles = st.lists(st.integers(1, 20), min_size=1, max_size=4, unique=True).map(lambda whole: -0.25 * np.array(whole))
residues = st.floats(0.5, 5) | st.floats(-5, -0.5)


@st.composite
def continuous(draw):
    """Distinct real poles, their residues and a direct term; num and den in falling powers of s."""
    p = draw(poles)
    r = np.array([draw(residues) for _ in p])
    direct = draw(st.sampled_from([0.0, 0.0, 0.7, -2.0]))
    den = np.poly(p)
    num = direct * den
    for i, residue in enumerate(r):
        num[1:] += residue * np.poly(np.delete(p, i))
    return p, r, direct, num, den


def step_at(times, p, r, direct):
    """Unit step response by partial fractions; 0 before the step."""
    held = np.maximum(times, 0.0)
    value = direct + (r / p * np.expm1(np.outer(held, p))).sum(axis=1)
    return np.where(times >= -1e-9, value, 0.0)


def same(result, expected, scale):
    np.testing.assert_allclose(result, expected, rtol=1e-7, atol=1e-7 * scale)


@given(continuous(), st.sampled_from([0.1, 0.25, 0.5]), st.integers(0, 6), st.integers(0, 9))
def test_from_continuous_has_the_step_response_of_the_process(process, dt, whole, tenths):
    p, r, direct, num, den = process
    dead_time = (whole + 0.1 * tenths) * dt
    model = LinearModel.from_continuous(num, den, dead_time, dt)
    scale = np.abs(r / p).sum() + abs(direct)
    times = dt * np.arange(60) - dead_time
    same(model.step_response(60), step_at(times, p, r, direct), scale)


@given(continuous(), st.sampled_from([0.1, 0.25, 0.5]), st.floats(0, 3))
def test_from_continuous_keeps_gain_and_poles(process, dt, dead_time):
    p, r, direct, num, den = process
    gain = direct - (r / p).sum()
    model = LinearModel.from_continuous(num, den, dead_time, dt)
    scale = np.abs(r / p).sum() + abs(direct)
    assert model.gain == pytest.approx(gain, rel=1e-6, abs=1e-6 * scale)
    assert model.is_stable
    np.testing.assert_allclose(np.sort(model.poles.real), np.sort(np.exp(p * dt)), rtol=1e-4)


@given(continuous(), st.sampled_from([0.1, 0.25, 0.5]))
@settings(deadline=None, max_examples=30)
def test_from_continuous_agrees_with_python_control(process, dt):
    _, _, _, num, den = process
    discrete = control.sample_system(control.tf(num, den), dt, "zoh")
    times = dt * np.arange(40)
    expected = control.step_response(discrete, times).outputs
    model = LinearModel.from_continuous(num, den, 0.0, dt)
    same(model.step_response(40), expected, np.abs(expected).max())


@given(linear_models())
@settings(deadline=None)
def test_there_and_back_through_python_control(model):
    back = LinearModel.from_control(model.to_control())
    assert (back.delay, back.dt) == (model.delay, model.dt)
    impulse = np.eye(1, 40).ravel()
    expected = model.simulate(impulse)
    np.testing.assert_allclose(back.simulate(impulse), expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


@given(linear_models())
@settings(deadline=None, max_examples=30)
def test_python_control_simulates_the_same(model):
    times = model.dt * np.arange(40)
    expected = control.step_response(model.to_control(), times).outputs
    np.testing.assert_allclose(model.step_response(40), expected, rtol=1e-7, atol=1e-8 * np.abs(expected).max())


@given(linear_models())
def test_description_survives_json(model):
    assert LinearModel.from_dict(json.loads(json.dumps(model.to_dict()))) == model


@given(roots(1.4, most=6), st.floats(0.1, 1.2))
def test_is_stable_is_the_root_test(found, radius):
    largest = max(np.abs(found), default=0.0)
    a = polynomial(found)
    assume(abs(largest - 1.0) > 1e-3 and abs(slow_linear.largest_root(a) - 1.0) > 1e-3)
    assert LinearModel(a, [1.0]).is_stable == (largest < 1.0)


@given(linear_models(), signals, signals, st.floats(-10, 10), st.floats(-10, 10))
def test_superposition(model, one, other, p, q):
    n = min(one.size, other.size)
    one, other = one[:n], other[:n]
    parts = p * model.simulate(one), q * model.simulate(other)
    scale = sum(np.abs(part).max() for part in parts)
    np.testing.assert_allclose(model.simulate(p * one + q * other), sum(parts), rtol=1e-9, atol=1e-10 * scale + 1e-12)


@given(linear_models(), signals, st.integers(0, 10))
def test_time_invariance(model, x, late):
    shifted = model.simulate(np.concatenate([np.zeros(late), x]))
    np.testing.assert_allclose(shifted[late:], model.simulate(x), rtol=1e-14, atol=1e-300)
    assert not shifted[:late].any()


@given(linear_models(), signals)
def test_causality_and_delay(model, x):
    y = model.simulate(x)
    assert not y[: model.delay].any()
    changed = np.append(x, 1e3)
    np.testing.assert_array_equal(model.simulate(changed)[: x.size], y)


@given(linear_models(largest=0.7))
def test_gain_is_the_end_of_the_step_response(model):
    expected = sum(model.b) / (1 + sum(model.a))
    scale = sum(map(abs, model.b)) / abs(1 + sum(model.a))
    assert model.gain == pytest.approx(expected)
    assert model.step_response(300)[-1] == pytest.approx(expected, rel=1e-8, abs=1e-9 * max(scale, 1.0))


@given(linear_models(), st.floats(0.1, 10), signals)
def test_scaled(model, factor, x):
    scale = np.abs(model.simulate(x)).max()
    np.testing.assert_allclose(
        model.scaled(factor).simulate(x), factor * model.simulate(x), rtol=1e-9, atol=1e-10 * scale * factor
    )


@given(dead_zones(), linear_models(), signals, st.floats(-100, 100))
def test_hammerstein_is_actuator_then_process_then_offset(zone, model, u, offset):
    expected = slow_linear.simulate(model.a, model.b, model.delay, zone(u)) + offset
    result = Hammerstein(zone, model, offset).simulate(u)
    np.testing.assert_allclose(result, expected, rtol=1e-9, atol=1e-9 * (np.abs(expected).max() + 1e-12))
