"""Limit cycles: predicted against simulated, and none where there is none."""

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import ParameterError
from lostmotion.evaluate import simc
from lostmotion.evaluate.limit_cycle import LimitCycle, loop_response, measure_limit_cycle, predict_limit_cycles
from tests.support.refusals import refusal

LEVEL = lm.LinearModel.from_continuous([0.05], [1.0, 1.0, 0.0], 0.2, 0.1)
LAG = lm.LinearModel.from_continuous([1.0], [10.0, 1.0], 2.0, 0.1)
SIZES = np.geomspace(1.02, 50.0, 60)


@pytest.mark.statistics
def test_backlash_on_a_level_cycles_as_predicted():
    gear, pi = lm.Backlash(2.0), lm.PI(4.0, 0.2)
    (found,) = predict_limit_cycles(gear.describing_function, SIZES, LEVEL, pi)
    loop = lm.simulate_loop(lm.Hammerstein(gear, LEVEL), pi, np.ones(20_000), allow_unstable=True)
    seen = measure_limit_cycle(loop.output, loop.control, 0.1, 1e-6)
    assert found.amplitude == pytest.approx(seen.amplitude, rel=0.05)
    assert found.op_amplitude == pytest.approx(seen.op_amplitude, rel=0.15)
    assert found.period == pytest.approx(seen.period, rel=0.25)  # a triangle of OP is not a sine


def test_saturation_of_an_unstable_loop_is_exact_in_frequency():
    """N is real, so the cycle lies at the phase crossover, at the amplitude where N is one over the gain there."""
    pi, limit = lm.PI(12.0, 1.0), lm.Saturation(-1.0, 1.0)
    frequency = np.linspace(0.1, 3.0, 20_000)
    answer = loop_response(LAG, pi, frequency)
    at = int(np.argmin(np.abs(np.unwrap(np.angle(answer)) + np.pi)))
    (found,) = predict_limit_cycles(limit.describing_function, np.geomspace(0.5, 50.0, 200), LAG, pi)
    assert found.period == pytest.approx(2.0 * np.pi / frequency[at], rel=1e-3)
    assert abs(limit.describing_function(found.op_amplitude)) == pytest.approx(1.0 / abs(answer[at]), rel=1e-2)


def test_a_dead_zone_in_a_stable_loop_has_no_cycle():
    zone = lm.DeadZone(-1.0, 1.0)
    assert predict_limit_cycles(zone.describing_function, SIZES, LAG, lm.PI(2.0, 0.2)) == []
    assert predict_limit_cycles(lambda _: 0j, SIZES, LAG, lm.PI(2.0, 0.2)) == []


@pytest.mark.parametrize(
    "signal",
    [np.zeros(300), np.exp(-np.arange(300) / 40.0) * np.sin(np.arange(300)), np.linspace(0.0, 1.0, 300)],
    ids=["rest", "dies out", "drifts"],
)
def test_what_is_no_cycle_is_not_measured_as_one(signal):
    assert measure_limit_cycle(signal, signal, 1.0, 1e-3).amplitude == 0.0
    assert LimitCycle().to_dict()["period"] is None


def test_a_swing_after_a_large_move_is_a_cycle():
    """The move itself, in the third before, is no measure of it."""
    time = np.arange(3000)
    swing = 0.1 * np.sin(time / 3.0) + np.where(time < 1000, 5.0, 5.0 * np.exp(-(time - 1000) / 50.0))
    found = measure_limit_cycle(swing, swing, 1.0, 1e-3)
    assert found.amplitude == pytest.approx(0.1, rel=0.02)
    assert found.period == pytest.approx(6.0 * np.pi, rel=0.02)


@pytest.mark.parametrize("seed", range(5))
def test_a_swing_that_comes_and_goes_is_a_cycle(seed):
    """Pulses of a block that beat with what the valve does."""
    rng = np.random.default_rng(seed)
    time, beats = np.arange(6000), 1.0 + 0.5 * np.sin(np.arange(6000) / rng.uniform(100, 400) + rng.uniform(0, 6.3))
    signal = beats * np.sin(time / 4.0)
    assert 1.0 < measure_limit_cycle(signal, signal, 1.0, 1e-3).amplitude < 1.6
    dying = np.exp(-time / 2000.0) * np.sin(time / 4.0)
    assert measure_limit_cycle(dying, dying, 1.0, 1e-3).amplitude == 0.0


@pytest.mark.parametrize(
    ("linear", "kp", "ki"),
    [
        (lm.LinearModel.from_continuous([2.0], [10.0, 1.0], 1.5, 0.01), 10 / 2 / 3, 10 / 2 / 3 / 10),
        (lm.LinearModel.from_continuous([2.0], [100.0, 1.0], 1.5, 0.01), 100 / 2 / 3, 100 / 2 / 3 / 12),
        (lm.LinearModel.from_continuous([-0.5], [1.0, 0.0], 2.0, 0.01), -1 / 0.5 / 4, -1 / 0.5 / 4 / 16),
        (
            lm.LinearModel.from_continuous([1.0], np.polymul([8.0, 1.0], [2.0, 1.0]), 1.0, 0.01),
            9 / (2 * 2.0),
            9 / (2 * 2.0) / 9,
        ),
    ],
    ids=["lag", "slow lag", "integrator", "half rule"],
)
def test_simc_gives_the_published_settings(linear, kp, ki):
    found = simc(linear)
    assert found.kp == pytest.approx(kp, rel=0.02)
    assert found.ki == pytest.approx(ki, rel=0.02)


def test_simc_refuses_what_it_cannot_tune():
    assert "slowness" in refusal(ParameterError, simc, LAG, 0.0)
    assert "gain" in refusal(ParameterError, simc, lm.LinearModel([-0.5], [1.0, -1.0], 1))
