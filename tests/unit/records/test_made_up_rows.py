"""Quantisation, historian compression, slower scans: what a signal's own values give away."""

import numpy as np
import pytest
from benchmarks.historian import exceptions, swinging_door

import lostmotion as lm
from lostmotion.kernels import lines
from lostmotion.kernels.lines import knots
from lostmotion.records import LoopRecord, prepare
from lostmotion.records.compression import compression, scan_factor
from lostmotion.records.quantum import quantum
from tests.naive.lines import knots as slow_knots

N = 1500
LOOP = lm.routine_operation(N, drift="mild", seed=5)
NOISE = 0.03**0.5


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("tolerance", [0.0, 0.5, 2.0])
def test_knots_against_the_slow_twin(seed, tolerance):
    random = np.random.default_rng(seed)
    values = np.cumsum(random.normal(size=random.integers(2, 80)))
    if seed % 2:
        values = np.round(values)
    if seed % 3 == 0 and len(values) > 5:
        values[random.integers(len(values))] = np.nan
    expected = slow_knots(values.tolist(), tolerance)
    assert knots(values, tolerance).tolist() == expected
    assert lines._compiled()(values, tolerance).tolist() == expected
    assert lines._knots(values.tolist(), tolerance).tolist() == expected


@pytest.mark.parametrize("step", [0.001, 0.0125, 0.05, 1.0, 7.5, 1 / 3])
@pytest.mark.parametrize("offset", [0.0, 812.34])
@pytest.mark.parametrize("single", [False, True])
def test_step_is_found(step, offset, single):
    values = np.round(np.random.default_rng(0).normal(scale=30 * step, size=N) / step) * step + offset
    stored = values.astype(np.float32).astype(float) if single and step > 1e-6 * offset * 10 else values
    assert quantum(stored) == pytest.approx(step, rel=1e-3)


def test_step_with_a_few_values_off_the_grid():
    values = np.round(np.random.default_rng(0).normal(scale=3.0, size=N), 1)
    values[[3, 50, 700]] += 0.0371
    assert quantum(values) == pytest.approx(0.1, rel=1e-3)


def test_step_rounded_to_too_few_decimals():
    values = np.round(np.round(np.random.default_rng(0).normal(scale=2.0, size=N) / 0.0625) * 0.0625, 2)
    assert quantum(values) == pytest.approx(0.0625, rel=0.01)


def test_steps_of_different_size_have_a_typical_one():
    flow = np.sqrt(np.round(np.random.default_rng(0).normal(400.0, 4.0, size=N)))
    assert quantum(flow) == pytest.approx(0.025, rel=0.05)


@pytest.mark.parametrize("values", [np.full(9, 2.0), np.full(3, np.nan), np.random.default_rng(0).normal(size=N)])
def test_no_step(values):
    assert quantum(values) == 0.0


@pytest.mark.parametrize("decimals", [9, 2])
@pytest.mark.parametrize(("deviation", "low", "high"), [(1.0, 0.35, 0.7), (3.0, 0.85, 0.97)])
def test_interpolated_archive(decimals, deviation, low, high):
    pv = np.round(swinging_door(LOOP.measured, deviation * NOISE), decimals)
    assert low < compression(LoopRecord(LOOP.command, pv, dt=0.1), "pv").share < high


def test_held_archive():
    pv = exceptions(LOOP.measured, 3.0 * NOISE)
    found = compression(LoopRecord(LOOP.command, pv, dt=0.1), "pv")
    assert found.held == pytest.approx(np.mean(np.diff(pv) == 0), abs=0.01)
    assert found.straight < 0.05


@pytest.mark.parametrize(
    "pv",
    [
        LOOP.measured,
        np.round(LOOP.measured, 1),
        np.round(LOOP.measured / 0.5) * 0.5,
        np.round(LOOP.output, 2),
        LOOP.output,
        np.round(3 * np.sin(np.arange(N) / 40), 2),
        np.round(3 * np.sin(np.arange(N) / 400), 1),
    ],
)
def test_measured_signals_are_not_accused(pv):
    assert compression(LoopRecord(LOOP.command, pv, dt=0.1), "pv").share < 0.15
    assert prepare(LoopRecord(LOOP.command, pv, dt=0.1)).usable


def test_a_process_that_settles_after_steps_by_hand_is_not_accused():
    op = np.repeat([0.0, 3.0, -2.0, 4.0, 0.0], N // 5)
    pv = np.round(lm.platforms.level_tank().simulate(op), 1)
    assert compression(LoopRecord(op, pv, dt=0.1), "pv").share == 0.0


def test_op_on_lines_only_while_pv_moves():
    op = swinging_door(LOOP.command, 0.3)
    assert compression(LoopRecord(op, LOOP.measured, dt=0.1), "op").share > 0.5
    ramp, flat = np.arange(N) * 0.01, np.repeat(LOOP.measured[::50], 50)
    assert compression(LoopRecord(np.where(np.arange(N) < 750, ramp, 15 - ramp), flat, dt=0.1), "op").share < 0.05


def test_warning_and_refusal():
    soft = prepare(LoopRecord(LOOP.command, swinging_door(LOOP.measured, 1.6 * NOISE), dt=0.1))
    assert soft.usable
    assert any("made up by the historian" in note and "too narrow" in note for note in soft.notes)
    hard = prepare(LoopRecord(LOOP.command, swinging_door(LOOP.measured, 4.0 * NOISE), dt=0.1))
    assert "made up by the historian" in hard.refusal
    assert "with raw=True" in hard.refusal


@pytest.mark.parametrize("factor", [2, 3, 10])
def test_repeated_and_interpolated_scans(factor):
    op, pv = np.repeat(LOOP.command, factor), np.repeat(LOOP.measured, factor)
    assert scan_factor(LoopRecord(op, pv, dt=1.0)) == (factor, 0)
    assert scan_factor(LoopRecord(op[1:], pv[1:], dt=1.0)) == (factor, factor - 1)
    at = np.arange(len(op))
    line = np.interp(at, at[::factor], LOOP.measured)
    assert scan_factor(LoopRecord(op, line, dt=1.0))[0] == factor


def test_scans_at_different_phases_are_left_alone():
    op, pv = np.repeat(LOOP.command, 5)[2:], np.repeat(LOOP.measured, 5)[:-2]
    assert scan_factor(LoopRecord(op, pv, dt=1.0)) == (1, 0)
    assert scan_factor(LoopRecord(LOOP.command, LOOP.measured, dt=1.0)) == (1, 0)
