"""The valves of ``benchmarks/ingredients.py`` are what they are called, and its verdicts are judged as it says."""

from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from benchmarks.one_ingredient.changes import CHANGES, seeds_of
from benchmarks.one_ingredient.draw import base_case, met, reversals, streams_of, valve_of
from benchmarks.one_ingredient.judge import (
    ACCUSED,
    CALLED_SOUND,
    CANNOT_TELL,
    LIMIT,
    OTHER_FAULT,
    OTHER_STICKING,
    REFUSED,
    RIGHT,
    SAID_SOUND,
    judged,
)
from benchmarks.one_ingredient.loops import Loop, loop_of
from benchmarks.one_ingredient.page import said_of, truth_of, wrong_decisions
from benchmarks.one_ingredient.record import Recording
from benchmarks.one_ingredient.tuning import margin, response_of, tuned
from benchmarks.one_ingredient.valves import STEM, move_valve, valve_at

FRICTIONS = ("stenman", "he", "choudhury", "kano", "karnopp")
SIZE, JUMP_SHARE, TOP, STEP = 4.0, 0.4, 60.0, 0.05
UP = np.arange(50.0, TOP, STEP)
DOWN = np.arange(TOP, 40.0, -STEP)


def case_with(**changes):
    """The base case of a seed with a valve that follows at once."""
    case = base_case(streams_of(0).case, 0)
    return replace(case, **{"actuator_lag": 0.0, "rows": 2, "jump_share": JUMP_SHARE, "size": SIZE, **changes})


def stems(case, commands):
    """Where the stem is after each command, given at a scan."""
    valve, state, found = valve_of(case), valve_at(commands[0]), []
    for command in commands:
        move_valve(valve, state, command, 0, True)
        found.append(state[STEM])
    return np.array(found)


@pytest.mark.parametrize("friction", FRICTIONS)
def test_a_sticking_valve_without_size_is_where_the_command_is(friction):
    commands = 50.0 + 5.0 * np.sin(np.arange(400) / 100)
    found = stems(case_with(kind="stiction", friction=friction, size=1e-9), commands)
    slack = 0.11 if friction == "karnopp" else 1e-8  # a mass is a tenth of a row late; 1 % in a row
    np.testing.assert_allclose(found, commands, rtol=0.0, atol=slack)


@pytest.mark.parametrize("kind", ["none", "backlash", "dead zone"])
def test_a_valve_without_friction_and_size_is_where_the_command_is(kind):
    commands = 50.0 + 5.0 * np.sin(np.arange(200) / 20)
    np.testing.assert_allclose(stems(case_with(kind=kind, size=0.0), commands), commands)


@pytest.mark.parametrize("friction", FRICTIONS)
def test_a_sticking_valve_holds_for_its_size_and_slips_by_its_jump(friction):
    found = stems(case_with(kind="stiction", friction=friction), np.concatenate([UP, DOWN]))
    jump = SIZE * (1.0 if friction == "stenman" else JUMP_SHARE)
    upward, downward = found[: UP.size], found[UP.size :]
    start = UP[np.argmax(upward > 50.0)]
    assert start == pytest.approx(50.0 + (SIZE + jump) / 2, abs=2 * STEP)
    lags = UP[upward > 50.0] - upward[upward > 50.0]
    assert lags.min() == pytest.approx((SIZE - jump) / 2, abs=3 * STEP)
    held_at = downward[0]
    slips = np.argmax(downward < held_at - 0.5 * jump)
    holds = 2 * (held_at - DOWN[slips]) / (1.0 + jump / SIZE)  # lets go (S + J) / 2 away, whether it slid or stuck anew
    assert holds == pytest.approx(SIZE, abs=4 * STEP)
    assert held_at - downward[slips + 2] == pytest.approx(jump, abs=4 * STEP)


@pytest.mark.parametrize("friction", ["choudhury", "kano", "karnopp"])
def test_a_valve_that_slides_follows_until_the_command_turns_by_its_size(friction):
    """He's and Stenman's stick anew after each move."""
    found = stems(case_with(kind="stiction", friction=friction), np.concatenate([UP, DOWN]))
    slides = UP > 50.0 + 1.2 * SIZE
    slack = 0.2 if friction == "karnopp" else 1e-9
    np.testing.assert_allclose(UP[slides] - found[: UP.size][slides], SIZE * 0.3, rtol=0.0, atol=slack)
    downward = found[UP.size :]
    turned = TOP - DOWN[np.argmax(downward < downward[0] - 0.5)]
    assert turned == pytest.approx(SIZE, abs=5 * STEP)


@pytest.mark.parametrize("friction", ["choudhury", "kano", "karnopp"])
def test_a_valve_that_slides_sticks_where_the_command_stands_and_goes_on_a_jump_later(friction):
    stops = np.full(20, UP[-1])
    on = UP[-1] + np.arange(0.0, SIZE, STEP)
    found = stems(case_with(kind="stiction", friction=friction), np.concatenate([UP, stops, on]))[-on.size :]
    held = found[0]
    assert on[np.argmax(found > held)] - on[0] == pytest.approx(SIZE * JUMP_SHARE, abs=4 * STEP)


def test_a_valve_with_backlash_is_half_of_it_behind():
    found = stems(case_with(kind="backlash"), np.concatenate([UP, DOWN]))
    assert UP[-1] - found[UP.size - 1] == pytest.approx(SIZE / 2)
    assert found[-1] - DOWN[-1] == pytest.approx(SIZE / 2)


def test_friction_may_be_other_upward_than_downward():
    case = case_with(kind="stiction", friction="he", asymmetry=2.0)
    up, down = (stems(case, 50.0 + way * np.arange(0.0, 8.0, STEP)) - 50.0 for way in (1, -1))
    first = [np.flatnonzero(found)[0] for found in (up, down)]
    let_go = [STEP * k for k in first]
    slid = [STEP * k - abs(found[k]) for k, found in zip(first, (up, down), strict=True)]
    assert let_go == pytest.approx([SIZE * 0.7 * 4 / 3, SIZE * 0.7 * 2 / 3], abs=STEP)
    assert slid == pytest.approx([SIZE * 0.3 * 4 / 3, SIZE * 0.3 * 2 / 3])


def test_a_stroke_ends_and_a_zone_is_dead():
    case = case_with(kind="saturation")
    lowest, highest = case.stroke
    found = stems(case, np.array([0.0, 100.0]))
    assert tuple(found) == (lowest, highest)
    case = case_with(kind="dead zone")
    assert list(stems(case, np.array([50.0, 51.9, 53.0, 47.0]))) == [50.0, 50.0, 51.0, 49.0]


@pytest.mark.parametrize(
    ("kind", "op", "times"),
    [
        ("none", [40, 60, 40], 0),
        ("backlash", [50, 55, 50.1, 55, 53, 55], 2),
        ("dead zone", [53, 51, 53, 47, 51, 53], 2),
        ("saturation", [50, 100, 50, 100, 50], 3),
    ],
)
def test_a_fault_is_met_where_op_goes_through_it(kind, op, times):
    assert met(case_with(kind=kind), np.array(op, dtype=float)) == times


def test_reversals_within_the_threshold_do_not_count():
    assert reversals([0.0, 1.0, 0.5, 2.0, 0.0, 0.4, -1.0, 1.0], 0.9) == 2


@pytest.mark.parametrize("ingredient", ["base", "aggressive", "level_p"])
def test_the_loop_is_stable_before_it_has_a_fault(ingredient):
    for seed in seeds_of(ingredient, 3):
        streams = streams_of(seed)
        case = base_case(streams.case, seed)
        CHANGES[ingredient].case(case, streams.change)
        tuning = tuned(case)
        assert margin(tuning.gain, tuning.reset, response_of(case, tuning.process_gain))[0] > 1.1


def test_ingredients_have_seeds_of_their_own():
    seeds = [seed for name in CHANGES for seed in seeds_of(name, 12)]
    assert len(CHANGES) == 55
    assert len(seeds) == len(set(seeds)) == 664
    assert list(seeds_of("late_pv", 1)) == [55 * 120]


def test_ingredient_and_seed_make_the_same_loop_again():
    one, again, other = (loop_of("short300", seed).recording for seed in (1, 1, 2))
    assert one.op.size == 300
    assert np.array_equal(one.op, again.op)
    assert np.array_equal(one.pv, again.pv)
    assert not np.array_equal(one.op, other.op)


@dataclass
class Said:
    """A stand-in for a diagnosis."""

    verdict: str
    confidence: float = 0.8
    interval: tuple[float, float] = (np.nan, np.nan)
    excluded: dict[str, float] = field(default_factory=dict)
    cleared: bool = False


def judged_as(kind, said, ingredient="base", met=3, percent=1.0):
    nothing = np.zeros(2)
    recording = Recording(*[nothing] * 6, percent=percent)
    return judged(Loop(ingredient, 1, case_with(kind=kind, friction="he"), recording, met), said)


@pytest.mark.parametrize(
    ("kind", "verdict", "ingredient", "expected"),
    [
        ("none", "none", "base", SAID_SOUND),
        ("none", "other oscillation", "base", SAID_SOUND),
        ("none", "cannot tell", "base", CANNOT_TELL),
        ("none", "backlash", "base", ACCUSED),
        ("none", "saturation", "base", ACCUSED),
        ("none", "saturation", "clamped", LIMIT),
        ("none", "stiction", "clamped", ACCUSED),
        ("stiction", "stiction", "base", RIGHT),
        ("stiction", "backlash", "base", OTHER_STICKING),
        ("stiction", "dead zone", "base", OTHER_FAULT),
        ("dead zone", "backlash", "base", OTHER_FAULT),
        ("saturation", "saturation", "clamped", RIGHT),
        ("backlash", "other oscillation", "base", CALLED_SOUND),
        ("backlash", "cannot tell", "base", CANNOT_TELL),
    ],
)
def test_what_is_said_is_judged(kind, verdict, ingredient, expected):
    assert judged_as(kind, Said(verdict), ingredient).judgement == expected


def test_what_is_refused_is_refused():
    assert judged_as("stiction", None).judgement == REFUSED
    assert judged_as("none", None).judgement == REFUSED


def test_sizes_are_judged_in_per_cent_of_op():
    good = judged_as("stiction", Said("backlash", interval=(0.038, 0.042)), percent=0.01)
    off = judged_as("stiction", Said("stiction", interval=(3.0, 3.5)))
    unsized = judged_as("stiction", Said("stiction"))
    assert good.sized
    assert good.held
    assert off.sized
    assert not off.held
    assert not unsized.sized
    assert judged_as("stiction", Said("none", excluded={"stiction": 0.05}), percent=0.01).bound == pytest.approx(5.0)


def test_bounds_below_the_truth_are_seen():
    hidden = judged_as("stiction", Said("cannot tell", excluded={"stiction": 3.7, "backlash": 1.0}))
    wrong = judged_as("stiction", Said("none", excluded={"stiction": 3.0}, cleared=True), met=1)
    fair = judged_as("stiction", Said("cannot tell", excluded={"stiction": np.inf}))
    assert (hidden.hidden, hidden.well_hidden) == (True, False)
    assert (wrong.hidden, wrong.well_hidden, wrong.wrongly_cleared, wrong.findable) == (True, True, True, False)
    assert not fair.bounded
    assert truth_of(wrong) == "stiction of 4 % (he), met 1 times"
    assert said_of(wrong) == "none, 0.80; no stiction above 3 %; cleared"
    assert len(wrong_decisions([hidden, wrong, fair])) == 4
    assert wrong_decisions([fair])[0] == "None."
