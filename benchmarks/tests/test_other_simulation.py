"""The loops of ``benchmarks/other_simulation.py`` are what they are called."""

from dataclasses import replace

import numpy as np
import pytest
from benchmarks.verdicts.other_loops import LOOPS
from benchmarks.verdicts.other_simulation import compressed, recorded_loop
from benchmarks.verdicts.other_specification import HistorianSpec, LoopSpec, ProcessSpec, SetPointSpec, ValveSpec

SHORT = HistorianSpec(rows=400, scans=1, fine_steps=2)
SOUND = LoopSpec("", "none", ProcessSpec("flow"), ValveSpec(lag=0.0), set_point=SetPointSpec("moves"), historian=SHORT)


def with_fault(rule, band, jump=0.0):
    return replace(SOUND, valve=ValveSpec(rule, band, jump, lag=0.0))


def test_a_seed_makes_the_same_loop_again():
    one, again, other = (recorded_loop(SOUND, seed) for seed in (3, 3, 4))
    assert np.array_equal(one.op, again.op)
    assert np.array_equal(one.pv, again.pv)
    assert not np.array_equal(one.op, other.op)


def test_a_sound_valve_without_lag_is_where_op_is():
    loop = recorded_loop(SOUND, 1)
    assert np.ptp(loop.op) > 1.0
    np.testing.assert_allclose(loop.place, loop.op, rtol=0.0, atol=1e-9)


@pytest.mark.parametrize(("rule", "jump"), [("backlash", 0.0), ("he", 1.0), ("choudhury", 1.0)])
def test_a_valve_with_memory_is_behind_op_by_no_more_than_it_may(rule, jump):
    loop = recorded_loop(with_fault(rule, 2.0, jump), 1)
    away = np.abs(loop.op - loop.place)
    assert np.count_nonzero(np.diff(loop.place) == 0.0) > 10
    assert 0.9 * (2.0 + jump) / 2 < away.max() <= (2.0 + jump) / 2 + 1e-9


def test_a_dead_zone_loses_its_width():
    loop = recorded_loop(with_fault("dead zone", 2.0), 1)
    lost = np.abs(loop.op - loop.place)
    assert np.ptp(loop.op) > 2.0
    np.testing.assert_allclose(lost.max(), 1.0)


def test_compression_stays_within_its_deviation():
    values = np.cumsum(np.random.default_rng(0).normal(size=200)) * 0.1
    held = compressed(values, 0.3, "hold")
    assert np.unique(held).size < 150
    assert np.abs(held - values).max() <= 0.3


def test_the_table_has_faults_and_sound_valves():
    assert [sum(spec.lost_motion is fault for spec in LOOPS) for fault in (True, False)] == [106, 86]
    assert all(spec.valve.rule != "" for spec in LOOPS if spec.lost_motion)
