"""The plants of ``benchmarks/off_model`` are what they are called, and its bounds and bars work."""

import time

import numpy as np
import pytest
from benchmarks.off_model import asymmetric, levels, mixed, thinning
from benchmarks.off_model.answer import Answer, OutOfTime, time_limit
from benchmarks.off_model.bars import MET, MISSED, at_least, at_most
from benchmarks.off_model.plant import (
    BACKLASH,
    DEAD_ZONE,
    MOTION,
    NONE,
    RANGE,
    SPEED,
    STICTION,
    Actuator,
    Controller,
    Plant,
    closed_loop,
    open_loop,
)
from benchmarks.off_model.scored import ScoredRow, Truth
from benchmarks.off_model.suites import Job

GAIN, DT = 2.0, 0.1
UP = np.arange(0.0, 60.0, 0.5)


def at_once(actuator, op, bend=0.0):
    """Where the actuator is: a process of gain 1 that has followed before the next row."""
    plant = Plant(actuator, 1.0, 1e-3, 1e-3, bend=bend)
    return open_loop(plant, DT, np.append(op, 0.0))[1:]


def test_gain_with_and_without_a_second_lag():
    for plant in (Plant(Actuator(), GAIN, 0.5, 0.5), Plant(Actuator(), GAIN, 0.5, 0.5, second=0.3, dead_time=0.25)):
        np.testing.assert_allclose(open_loop(plant, DT, np.full(200, 7.0))[-1], 7.0 * GAIN, rtol=1e-6)


@pytest.mark.parametrize("direction", [MOTION, SPEED])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_time_constants_up_and_down(direction, sign):
    """A step away from zero and one back: after one time constant 63 % of the way are done."""
    plant = Plant(Actuator(), 1.0, 1.0, 2.0, direction)
    there, back = (1.0, 2.0) if direction == SPEED or sign > 0 else (2.0, 1.0)
    pv = sign * open_loop(plant, DT, sign * np.repeat([1.0, 0.0], 300))
    np.testing.assert_allclose(pv[round(there / DT)], 1.0 - np.exp(-1.0), atol=1e-6)
    np.testing.assert_allclose(pv[300 + round(back / DT)], np.exp(-1.0), atol=1e-6)


def test_dead_time_and_integral():
    held = open_loop(Plant(Actuator(), GAIN, 0.5, 0.5, dead_time=1.0), DT, np.full(50, 3.0))
    assert np.flatnonzero(held)[0] == 11
    level = open_loop(Plant(Actuator(), GAIN, 1.0, 1.0, integrates=True), DT, np.full(50, 3.0))
    np.testing.assert_allclose(np.diff(level), GAIN * 3.0 * DT)


def test_a_dead_zone_is_still_inside_and_on_its_lines_outside():
    op = np.linspace(-20.0, 20.0, 401)
    place = at_once(Actuator(DEAD_ZONE, left=-6.0, right=8.0), op)
    np.testing.assert_allclose(place, np.maximum(op - 8.0, 0.0) + np.minimum(op + 6.0, 0.0), atol=1e-9)


def test_break_away_jumps_onto_the_line():
    op = np.linspace(-20.0, 20.0, 401)
    place = at_once(Actuator(DEAD_ZONE, left=-6.5, right=6.5, still=1.0 / mixed.ZERO), op)
    assert np.abs(place[np.abs(op) < 9.9]).max() < 1e-9
    np.testing.assert_allclose(place[op > 10.05], op[op > 10.05] - 6.5, atol=1e-9)


@pytest.mark.parametrize("jump", [0.0, 1.5])
def test_a_play_and_a_stiction_lose_their_width_between_the_branches(jump):
    kind = STICTION if jump else BACKLASH
    place = at_once(Actuator(kind, width=4.0, jump=jump), np.concatenate([UP, UP[::-1]]))
    rising, falling = place[: UP.size], place[UP.size :][::-1]
    middle = slice(40, 80)
    lost = np.median((falling - rising)[middle])
    assert lost == pytest.approx(4.0, abs=0.6)
    assert np.abs(UP - rising)[middle].max() <= 0.5 * (4.0 + jump) + 1e-9


def test_a_tapered_play_is_wider_at_one_end():
    valve = Actuator(BACKLASH, width=4.0, taper=0.3)
    assert at_once(valve, UP)[-1] == pytest.approx(UP[-1] - 2.0 * (1.0 + 0.3 * UP[-1] / (RANGE / 2)))


def test_a_bend_changes_the_gain_three_times_over_the_range():
    place = at_once(Actuator(), np.array([-60.0, -59.99, 59.99, 60.0]), bend=0.5)
    assert (place[3] - place[2]) / (place[1] - place[0]) == pytest.approx(3.0, rel=1e-3)


def test_a_closed_loop_reaches_its_set_point():
    plant = Plant(Actuator(), GAIN, 1.0, 1.0)
    op, pv = closed_loop(plant, DT, np.full(300, 5.0), np.zeros(300), np.full(300, -1.0), Controller(0.5, 1.0))
    assert pv[-1] == pytest.approx(5.0, abs=1e-3)
    assert op[-1] == pytest.approx(5.0 / GAIN + 1.0, abs=1e-3)


def test_a_job_makes_the_same_record_again_and_no_cell_fails():
    one, again = (asymmetric.record_of(Job("asymmetric", 3)) for _ in range(2))
    assert np.array_equal(one.pv, again.pv)
    for cell in range(len(mixed.CELLS)):
        record = mixed.record_of(Job("off_model", cell, 7))
        assert np.isfinite(record.pv).all()
        assert record.op.size <= mixed.ROWS[1]
        assert record.truth.op_range > RANGE / 4
    for loop in (thinning.loop_of(Job("thinning", 7)), levels.loop_of(Job("levels", 1))):
        assert np.isfinite(loop[1]).all()
        assert np.ptp(loop[0]) > loop[2].actuator.size


def test_designs_have_the_sizes_they_should():
    seeds = range(5)
    suites = [suite for module in (asymmetric, thinning, levels, mixed) for suite in module.SUITES]
    assert [len(suite.jobs(seeds)) for suite in suites] == [270, 270, 100, 60, 200]


def scored(truth, **answer):
    return ScoredRow("", truth, {}, Answer(**{"status": "OK", **answer}))


def test_scores():
    zone = Truth(DEAD_ZONE, 14.0, RANGE, -6.0, 8.0)
    ends = {"left": (-6.5, -5.5), "right": (8.5, 9.0)}
    found = scored(zone, kind=DEAD_ZONE, size=14.5, interval=(13.0, 15.0), ends=ends)
    assert (found.right, found.holds, found.places, found.misleads) == (True, True, [True, False], False)
    assert scored(zone, kind=DEAD_ZONE, size=20.0, interval=(19.0, 21.0), ends=ends).misleads
    assert scored(zone, kind=NONE).misleads
    assert not scored(zone, kind="cannot tell").misleads
    sound = Truth(NONE, 0.0, RANGE)
    accused = [scored(sound, kind=BACKLASH, size=size, interval=(0.1, 9.0)) for size in (1.0, 1.5)]
    assert [(one.right, one.accused, one.misleads) for one in accused] == [(True, False, False), (False, True, True)]
    saturated = scored(sound, kind="saturation")
    assert (saturated.right, saturated.accused, saturated.misleads) == (False, False, True)


def test_bars():
    assert [at_least("", [True] * 3 + [False], bar)[-1] for bar in (0.75, 0.76)] == [MET, MISSED]
    assert [at_most("", [True] + [False] * 3, bar)[-1] for bar in (0.25, 0.24)] == [MET, MISSED]


def test_a_record_that_takes_too_long_is_stopped():
    with pytest.raises(OutOfTime), time_limit(0.05):
        time.sleep(5.0)
