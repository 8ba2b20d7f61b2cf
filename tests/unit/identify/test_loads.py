"""Swings and steps beside the actuator: found, paid for, taken away again."""

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identify.actuators.fit_kind import fit_linear
from lostmotion.identify.actuators.loads import (
    loaded,
    pruned,
    sizes_of_loads,
    swings_of,
    with_own_loads,
    without_actuator,
    without_loads,
    without_swings,
    without_their_effect,
)
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.courses import Loads, Step, Swing
from lostmotion.identify.likelihood.criterion import criterion
from lostmotion.identify.likelihood.family import LinearFamily
from lostmotion.identify.scaled import ScaledData

pytestmark = pytest.mark.statistics  # whole fits: minutes without the JIT
N = 1500
PROCESS = lm.LinearModel([-0.85], [0.15], 2, 1.0)
PERIOD = 47.3
TIME = np.arange(N)
SWINGING = 0.8 * np.sin(2 * np.pi * TIME / PERIOD)
STEPPING = np.where(TIME < 600, 0.0, 1.5)
WHOLE = np.array([[0, N]])


def record(load, seed=0, deviation=0.05, segments=WHOLE):
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.normal(size=N // 15), 15)
    y = PROCESS.simulate(u + load) + rng.normal(scale=deviation, size=N)
    return ScaledData(u, y, segments)


def linear(data, zero=True):
    return fit_linear(data, Asked(zero=zero))


def events(fitted):
    loads = fitted.problem.family.loads
    return () if loads is None else loads.events


@pytest.mark.parametrize("seed", range(5))
def test_noise_has_no_loads(seed):
    plain = linear(record(np.zeros(N), seed))
    assert with_own_loads(plain) is plain


@pytest.mark.parametrize(("zero", "gain"), [(False, 100), (True, 50)], ids=["autoregression", "with a zero"])
def test_a_swing_is_found(zero, gain):
    """Noise with a zero explains some of it as well."""
    data = record(SWINGING)
    plain = linear(data, zero)
    found = with_own_loads(plain)
    assert all(isinstance(event, Swing) for event in events(found))
    assert {round(event.period / PERIOD, 1) for event in events(found)} == {1.0}
    assert criterion(found) < criterion(plain) - gain
    effect = data.y - without_their_effect(found, data).y
    np.testing.assert_allclose(effect[50:], PROCESS.simulate(SWINGING)[50:], atol=0.06)


def test_steps_are_found_at_their_rows():
    data = record(STEPPING)
    found = with_own_loads(linear(data))
    assert [abs(event.row - 600) <= 1 for event in events(found)] == [True]
    assert sizes_of_loads(found) == pytest.approx([1.5], abs=0.15)
    a, b = found.fit.theta[0], found.fit.theta[1]
    assert (a, b / (1 + a)) == (pytest.approx(-0.85, abs=0.02), pytest.approx(1.0, abs=0.05))


def test_a_load_that_does_not_pay_is_dropped():
    data = record(np.zeros(N))
    plain = linear(data)
    forced = loaded(plain, data.y, Loads((Step(400, 0, N),), N), np.zeros(1))
    assert events(forced) == (Step(400, 0, N),)
    kept = pruned(forced)
    assert events(kept) == ()
    assert kept.fit.theta == pytest.approx(plain.fit.theta, abs=1e-5)
    assert kept.parameters == plain.parameters == forced.parameters - 2  # its size and its time


def test_without_loads_is_the_model_before():
    data = record(SWINGING)
    found = with_own_loads(linear(data))
    assert events(without_loads(found)) == ()
    assert without_loads(found).problem.size == found.problem.size - len(sizes_of_loads(found))


def test_without_actuator_keeps_structure_and_loads():
    data = record(SWINGING)
    fit = fit_linear(data, Asked())
    found = without_actuator(with_own_loads(fit))
    assert isinstance(found.problem.family, LinearFamily)
    assert events(found) == events(with_own_loads(fit))


@pytest.mark.parametrize("segments", [WHOLE, np.array([[0, 700], [700, N]])], ids=["one", "two segments"])
def test_what_a_swing_leaves_is_the_same_process(segments):
    data = record(3.0 * SWINGING, segments=segments)
    swings = swings_of(data)
    assert swings is not None
    assert [event.period for event in swings.events] == pytest.approx([PERIOD] * len(segments), rel=0.02)
    fitted = linear(without_swings(data, swings))
    assert fitted.fit.theta[0] == pytest.approx(-0.85, abs=0.02)


def test_harmonics_of_the_loop_are_no_loads_without_their_fundamental():
    """OP swings with a period of 60, PV with a harmonic of it that OP has not."""
    rng = np.random.default_rng(3)
    u = 2.0 * np.sin(2 * np.pi * TIME / 60) + 0.3 * rng.normal(size=N)
    harmonic = 0.5 * np.sin(2 * np.pi * TIME / 20)
    y = PROCESS.simulate(u + harmonic) + rng.normal(scale=0.02, size=N)
    found = with_own_loads(linear(ScaledData(u, y, WHOLE)))
    periods = [event.period for event in events(found) if isinstance(event, Swing)]
    assert not any(abs(period / 20 - 1) < 0.02 for period in periods)


def test_a_dead_zone_beside_a_swing_is_told():
    """Without the swing in the model no dead zone is seen, or one of the wrong width."""
    rng = np.random.default_rng(4)
    linear_part = lm.LinearModel([-0.85], [0.15], 2, 1.0)
    reference = np.repeat(rng.normal(size=2000 // 80), 80) * 2.0
    loop = lm.simulate_loop(
        lm.Hammerstein(lm.DeadZone(-1.0, 1.0), linear_part), lm.PI(0.8, 0.12), reference,
        disturbance=linear_part.simulate(1.2 * np.sin(2 * np.pi * np.arange(2000) / 83.0)),
        noise=rng.normal(scale=0.1, size=2000), allow_unstable=True,
    )  # fmt: skip
    fit = lm.identify(lm.LoopRecord(loop.control + 50, loop.measured + 50, dt=1.0), nonlinearity="auto")
    assert fit.nonlinearity.kind == "dead zone"
    assert fit.parameters["width"] == pytest.approx(2.0, rel=0.1)
    assert any(abs(period / 83.0 - 1) < 0.02 for period in fit.chosen.periods)


def test_loads_are_told_to_the_reader():
    data = record(SWINGING)
    reference = lm.LoopRecord(data.u + 50, data.y + 50, dt=2.0)
    fit = lm.identify(reference, nonlinearity="auto")
    assert fit.nonlinearity.kind == "none"
    assert {round(period / PERIOD, 1) for period in fit.chosen.periods} == {1.0}
    assert "swings of 9" in fit.summary()
    assert "of load act on the process" in fit.summary()
