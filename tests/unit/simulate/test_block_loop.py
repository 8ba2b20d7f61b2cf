"""Blocks in a simulated loop: what they must reach, and what must not change."""

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.compensate import BacklashCompensator, DeadZoneCompensator, block_from_model
from lostmotion.errors import ParameterError
from lostmotion.paper.control import CONTROLLER, DT, NOISE_VARIANCE, disturbance, reference
from lostmotion.records.movement import reversals
from lostmotion.simulate import BlockLoop
from tests.support.refusals import refusal

TANK = lm.platforms.level_tank()
SPAN = (-200.0, 200.0)
LEVEL = lm.LinearModel.from_continuous([0.05], [1.0, 1.0, 0.0], 0.2, 0.1)
LAG = lm.LinearModel.from_continuous([1.0], [10.0, 1.0], 2.0, 0.1)
LOOPS = {"level": (LEVEL, lm.PI(4.0, 0.2)), "self-regulating": (LAG, lm.PI(2.0, 0.5))}
GEAR = lm.Backlash(2.0)  # 2 % of the span


def respond(plant, block, seed, factor=1.0):
    load, path = disturbance()
    options = {"disturbance": load, "noise": NOISE_VARIANCE, "seed": seed, "disturbance_path": path}
    return lm.simulate_loop(plant, CONTROLLER, reference(), DT, block, **options)


def tank_block(**options):
    options = {"span": SPAN, "op_noise": 0.5 * NOISE_VARIANCE**0.5, "process_time": 1.4, **options}
    return block_from_model(TANK.nonlinearity, DT, **options)


def test_off_the_noise_and_without_a_jump_the_block_is_the_plain_inverse():
    valve = lm.DeadZone(-1, 2, 1.5, 1.0)
    plant = lm.Hammerstein(valve, TANK.linear)
    block = block_from_model(valve, DT, span=SPAN, shape=0.0, ramp=1e4)
    found = lm.simulate_loop(plant, CONTROLLER, reference(), DT, block, noise=0.03, seed=1)
    plain = lm.simulate_loop(plant, CONTROLLER, reference(), DT, DeadZoneCompensator(valve), noise=0.03, seed=1)
    first = lm.simulate_loop(plant, CONTROLLER, reference(), DT, None, noise=0.03, seed=1)
    assert found.command[0] == first.command[0]  # the first scan passes OP through
    np.testing.assert_allclose(found.command[1:3], plain.command[1:3], atol=1e-12)
    assert np.std(found.output - plain.output) < 0.1 * np.std(plain.output)


def test_ideal_backlash_inverse_in_the_loop_is_its_model():
    plant = lm.Hammerstein(GEAR, LAG)
    loop = lm.simulate_loop(
        plant, lm.PI(2.0, 0.5), np.ones(500), compensator=BacklashCompensator(GEAR), noise=0.01, seed=1
    )
    np.testing.assert_allclose(GEAR.inverse()(loop.control), loop.command, atol=1e-12)
    same = lm.simulate_loop(plant, lm.PI(2.0, 0.5), np.ones(500), compensator=GEAR.inverse(), noise=0.01, seed=1)
    np.testing.assert_array_equal(same.command, loop.command)
    np.testing.assert_allclose(loop.internal[5:], loop.control[5:], atol=1e-12)  # from the first move of the gear on


@pytest.mark.parametrize("kind", ["dead zone", "backlash", "stiction"])
def test_pieces_are_the_whole(kind):
    valve = {"dead zone": lm.DeadZone(49, 51), "backlash": GEAR, "stiction": lm.Stiction(2, 1)}[kind]
    plant = lm.Hammerstein(valve, LAG, offset=-50.0 if kind != "dead zone" else 0.0)
    pi = lm.PI(2.0, 0.5, bias=50.0, low=0.0, high=100.0)
    block = block_from_model(valve, 0.1, op_noise=0.05)
    r, zero, noise = np.ones(400), np.zeros(400), np.random.default_rng(0).normal(scale=0.02, size=400)
    whole = lm.simulate_loop(plant, pi, r, compensator=block, noise=noise)
    loop = BlockLoop(plant, pi, r, zero, noise, block)
    for samples in (1, 99, 300, 50):
        loop.advance(samples)
    for name in ("control", "command", "internal", "output", "measured"):
        np.testing.assert_array_equal(getattr(loop.response, name), getattr(whole, name))
    np.testing.assert_array_equal(block.run(whole.control).op_out, whole.command)  # the loop runs the block itself


def test_clamps_stop_the_integral():
    plant = lm.Hammerstein(GEAR, LAG)
    block = block_from_model(GEAR, 0.1, span=(-3.0, 3.0), op_noise=0.0)
    r = np.repeat([10.0, 0.0], [600, 300])
    loop = lm.simulate_loop(plant, lm.PI(2.0, 0.5), r, compensator=block)
    assert loop.command.max() == 3.0
    assert loop.control[620] < 3.0  # a wound-up integral would stay above for minutes


def test_refuses_another_scan_time_and_kind():
    block = block_from_model(TANK.nonlinearity, 0.2, span=SPAN)
    assert "scan_time" in refusal(ParameterError, lm.simulate_loop, TANK, CONTROLLER, np.ones(9), compensator=block)
    loop = BlockLoop(TANK, CONTROLLER, np.ones(9), np.zeros(9), np.zeros(9), tank_block())
    assert "kind" in refusal(ParameterError, loop.set_valve, GEAR)
    assert "kind" in refusal(ParameterError, loop.set_block, block_from_model(GEAR, DT, span=SPAN))


@pytest.mark.statistics
def test_level_tank_with_a_known_dead_zone():
    """IAE within 1 % of no dead zone; at most a third of the reversals of the plain inverse, beyond the noise."""
    iae = {"none": 0.0, "plain": 0.0, "block": 0.0}
    turns = {"plain": 0, "block": 0}
    linear = lm.Hammerstein(lm.Identity(), TANK.linear)
    for seed in range(60):
        cases = {
            "none": respond(linear, None, seed),
            "plain": respond(TANK, DeadZoneCompensator(TANK.nonlinearity), seed),
            "block": respond(TANK, tank_block(), seed),
        }
        for name, loop in cases.items():
            iae[name] += np.mean(np.abs(loop.reference - loop.measured))
            if name in turns:
                turns[name] += reversals(loop.command, 0.26)  # 3 deviations of the noise of OP
    assert iae["block"] / iae["none"] < 1.01
    assert abs(iae["block"] / iae["plain"] - 1.0) < 0.03
    assert turns["block"] < turns["plain"] / 3


@pytest.mark.parametrize("name", LOOPS)
@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_backlash_oscillation_falls_to_a_fifth(name, noise):
    linear, pi = LOOPS[name]
    plant, r = lm.Hammerstein(GEAR, linear), np.ones(6000)
    amplitude = []
    block = block_from_model(GEAR, 0.1, span=(-50, 50), op_noise=pi.kp * noise)
    for compensator in (None, block):
        loop = lm.simulate_loop(plant, pi, r, compensator=compensator, noise=noise**2, seed=1, allow_unstable=True)
        amplitude.append(np.ptp(loop.output[3000:]))
    assert amplitude[0] > 0.4
    assert amplitude[1] < amplitude[0] / 5


@pytest.mark.parametrize("factor", [0.8, 0.996, 1.004, 1.2])
@pytest.mark.parametrize("variance", [0.0, NOISE_VARIANCE])
def test_a_wrong_dead_zone_leaves_no_larger_cycle(factor, variance):
    r = np.repeat([0.0, 1.0, 0.2], [200, 800, 2000])
    with_block, without = (
        np.std(lm.simulate_loop(TANK, CONTROLLER, r, DT, block, noise=variance, seed=3).output[-1500:])
        for block in (tank_block(factor=factor), None)
    )
    assert with_block < without
    if factor > 1.1:  # it is the guard that does it
        bare = lm.simulate_loop(
            TANK, CONTROLLER, r, DT, tank_block(factor=factor, hunt_scans=0.0), noise=variance, seed=3
        )
        assert np.std(bare.output[-1500:]) > without


@pytest.mark.statistics
@pytest.mark.parametrize("name", LOOPS)
@pytest.mark.parametrize("factor", [0.8, 1.2])
def test_a_wrong_width_leaves_no_larger_cycle(name, factor):
    linear, pi = LOOPS[name]
    plant, r = lm.Hammerstein(GEAR, linear), np.ones(6000)
    block = block_from_model(GEAR, 0.1, span=(-50, 50), op_noise=pi.kp * 0.02, factor=factor)
    with_block, without = (
        np.ptp(lm.simulate_loop(plant, pi, r, compensator=c, noise=4e-4, seed=1, allow_unstable=True).output[3000:])
        for c in (block, None)
    )
    assert with_block < 0.5 * without


@pytest.mark.statistics
@pytest.mark.parametrize("model", ["kano", "he"])
def test_knocker_halves_the_error_of_a_sticking_valve(model):
    process = lm.LinearModel.from_continuous([1.0], [20.0, 1.0], 3.0, 1.0)
    valve, pi, r = lm.Stiction(2.0, 2.0, model), lm.PI(1.5, 0.075), np.ones(4000)
    plant = lm.Hammerstein(valve, process)
    errors = []
    for compensator in (None, block_from_model(valve, 1.0, span=(-50, 50), op_noise=0.075)):
        loop = lm.simulate_loop(plant, pi, r, compensator=compensator, noise=0.0025, seed=1)
        errors.append(np.mean(np.abs(loop.output - r)[2000:]))
    assert errors[1] < 0.5 * errors[0]
