"""The loops of ``benchmarks/blocks.py`` are what they are called, and its page counts what was judged."""

import math
from dataclasses import replace

import numpy as np
import pytest

from block_trials import judge, page
from block_trials.closed_loop import simulated
from block_trials.draw import loop_of
from block_trials.judge import AS_IT_IS, LARGER, REPAIRED, SMALLER, Judged, first_sentence, true_fault
from block_trials.measures import Compared, Cycle, compared, travel_of
from block_trials.record import written
from block_trials.signals import KICK, in_operation, left_alone
from block_trials.valves import (
    FAULTLESS,
    KINDS,
    SPEED,
    STICKING,
    Valve,
    held_at_scan,
    move_stem,
    valve_at_rest,
)

REST, SIZE, JUMP, TOP, STEP = 50.0, 4.0, 1.0, 60.0, 0.05
UP = np.arange(REST, TOP, STEP)
DOWN = np.arange(TOP, REST - 10.0, -STEP)
FINE_STEPS = 100


def valve_of(kind, size=SIZE, jump=JUMP):
    """A valve that follows at once; the mass of Karnopp's is quick."""
    jump = size if kind == "Stenman" else jump
    static, kinetic = (size + jump) / 2, (size - jump) / 2
    return Valve(KINDS.index(kind), size, jump, static, kinetic, REST, 0.0, 15.0, 0.5, 0.0)


def stems(valve, commands):
    """Where the stem is after each command is held for a row, and the state at the end."""
    state, found = valve_at_rest(valve), []
    for command in commands:
        target = held_at_scan(valve, state, command)
        for _ in range(FINE_STEPS if KINDS[valve.rule] == "Karnopp" else 1):
            move_stem(valve, state, target, 1.0, 1.0 / FINE_STEPS)
        found.append(move_stem(valve, state, target, 1.0, 1.0 / FINE_STEPS))
    return np.array(found), state


@pytest.mark.parametrize("kind", FAULTLESS)
def test_a_sound_valve_is_where_the_command_is(kind):
    commands = REST + 5.0 * np.sin(np.arange(200) / 20)
    np.testing.assert_allclose(stems(valve_of(kind), commands)[0], commands)


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "Karnopp"])
def test_a_repaired_and_an_ideal_valve_are_where_the_command_is(kind):
    commands = REST + 5.0 * np.sin(np.arange(200) / 20)
    for valve in (valve_of(kind).scaled(0.0), valve_of(kind).ideal()):
        np.testing.assert_allclose(stems(valve, commands)[0], commands)


def test_a_play_lags_by_half_its_width_either_way():
    found = stems(valve_of("backlash"), np.concatenate([UP, DOWN]))[0]
    assert UP[-1] - found[UP.size - 1] == pytest.approx(SIZE / 2)
    assert found[-1] - DOWN[-1] == pytest.approx(SIZE / 2)
    held = found[UP.size : UP.size + int(0.9 * SIZE / STEP)]
    assert np.ptp(held) == pytest.approx(0.0, abs=STEP)


def test_a_dead_zone_rests_inside_and_loses_its_width_on_the_way_through():
    commands = np.array([REST, REST + 1.9, REST + 3.0, REST - 1.9, REST - 3.0])
    np.testing.assert_allclose(stems(valve_of("dead zone"), commands)[0] - REST, [0.0, 0.0, 1.0, 0.0, -1.0])


def test_stenmans_valve_rests_until_the_command_is_a_band_away_and_goes_there():
    found = stems(valve_of("Stenman"), UP)[0]
    moved = int(np.argmax(found > REST))
    assert UP[moved] - REST == pytest.approx(SIZE, abs=1.1 * STEP)
    assert found[moved] == UP[moved]
    assert found[moved + 1] == found[moved]


def test_choudhurys_valve_slides_behind_and_holds_for_its_size_where_the_command_turns():
    found = stems(valve_of("Choudhury"), np.concatenate([UP, DOWN]))[0]
    assert UP[-1] - found[UP.size - 1] == pytest.approx((SIZE - JUMP) / 2)
    downward = found[UP.size :]
    let_go = int(np.argmax(downward < found[UP.size - 1] - 0.5 * JUMP))
    assert TOP - DOWN[let_go] == pytest.approx(SIZE, abs=3 * STEP)
    assert downward[let_go] - DOWN[let_go] == pytest.approx((SIZE - JUMP) / 2)


def test_hes_valve_lets_go_at_the_static_friction_and_keeps_the_kinetic_one():
    valve = valve_of("He")
    found = stems(valve, UP)[0]
    moved = int(np.argmax(found > REST))
    assert UP[moved] - REST == pytest.approx(valve.static, abs=1.1 * STEP)
    assert UP[moved] - found[moved] == pytest.approx(valve.kinetic)
    assert found[moved + 1] == found[moved]


def test_karnopps_valve_holds_up_to_the_static_friction_and_comes_to_rest():
    valve = valve_of("Karnopp")
    held, state = stems(valve, np.full(5, REST + 0.99 * valve.static))
    assert np.all(held == REST)
    found, state = stems(valve, np.full(20, REST + 2.0 * valve.static))
    assert state[SPEED] == 0.0
    assert found[-1] == found[-5] > REST
    assert abs(REST + 2.0 * valve.static - found[-1]) <= valve.static


def short(kind, seed=3, rows=120):
    loop = loop_of(kind, seed)
    return loop, simulated(loop, in_operation(loop, rows, 1))


def test_kind_and_seed_make_the_same_loop_again():
    (loop, run), (again, rerun), (other, _) = (short("He", seed) for seed in (3, 3, 4))
    assert loop == again
    assert loop != other
    assert all(np.array_equal(*pair) for pair in zip(run, rerun, strict=True))


def test_loops_are_of_the_sizes_that_the_page_says():
    for kind in KINDS:
        for loop in (loop_of(kind, seed) for seed in range(20)):
            valve = loop.valve
            assert 1.0 <= valve.size <= (8.0 if kind == "backlash" else 6.0) or (valve.size == 0 and kind in FAULTLESS)
            assert 0.0 <= valve.jump <= valve.size
            assert valve.static + valve.kinetic in (0.0, pytest.approx(valve.size))
            assert 2000 <= loop.rows <= 6000


class Doubled:
    """A block that doubles what OP is away from 50, up to 60."""

    def __init__(self):
        self.last, self.resets = {"back": math.nan}, 0

    def step(self, op):
        command = min(max(50.0 + 2.0 * (op - 50.0), 40.0), 60.0)
        self.last["back"] = 50.0 + (command - 50.0) / 2.0
        return command

    def reset(self):
        self.resets += 1


def test_a_block_stands_between_controller_and_valve():
    loop, without = short("backlash")
    block = Doubled()
    run = simulated(loop, in_operation(loop, 120, 1), block)
    assert block.resets == 1
    assert np.array_equal(without.op, without.command)
    assert [block.step(op) for op in run.op] == pytest.approx(run.command.tolist())
    assert np.array_equal(run.set_point, without.set_point)
    assert compared(run, without).travel == pytest.approx(travel_of(run) / travel_of(without))


def test_a_loop_left_alone_has_no_noise_and_its_kick_is_taken_back():
    for kind, seed in (("sound", 1), ("sound", 2)):
        signals = left_alone(loop_of(kind, seed), 100, 0.7)
        moved = np.flatnonzero(signals.set_point)
        assert (moved[0], moved[-1] + 1) == (KICK.start, KICK.stop)
        assert not signals.noise.any()
        assert np.all(signals.load == 0.7)


def test_numbers_are_written_as_in_a_file():
    assert written(np.array([12.3456789012]), 8).tolist() == [12.345679]


@pytest.mark.parametrize("kind", KINDS)
def test_the_true_fault_is_of_its_kind_and_size(kind):
    loop = loop_of(kind, 1)
    fault = true_fault(loop)
    assert (fault is None) == (kind in FAULTLESS)
    if fault is not None:
        assert fault.kind == ("stiction" if kind in STICKING else kind)
        assert getattr(fault, fault.size_name) == pytest.approx(loop.valve.size)


def test_the_first_sentence_ends_at_its_dot():
    assert first_sentence("It is 0.5 .. 0.9 of the IAE, not safe. Mend it.") == "It is 0.5 .. 0.9 of the IAE, not safe."
    assert page.wording("sure to 90 %, got 76.5 %.") == "sure to # %, got # %."


def with_block(kind="backlash", block="backlash", error=0.5, foretold=0.5, begun=False, **changes):
    measured = {name: Compared(error, 1.5) for name in judge.VALVES} | {REPAIRED: Compared(1.4, 20.0)}
    cycles = {size: Cycle(1.0, 3.0 if begun else 1.0) for size in judge.SIZES_AT_REST}
    one = Judged(kind, 7, "flow", 4.0, 0.0, "block", "", "", block, 0.25, foretold, measured, cycles)
    return replace(one, **changes)


def closed(kind, gate, said, true=math.nan, outcome="closed"):
    return Judged(kind, 8, "level", 4.0, 0.0, outcome, gate, said, true_block=true)


FOUND = [
    with_block(),
    with_block(error=0.7),
    with_block("Karnopp", "stiction knocker", 1.2, 0.7, begun=True),
    with_block("sound", "backlash", 1.0, 1.0, ideal=1.0),
    closed("dead zone", "identify", "It is 5 %.", 0.5),
    closed("dead zone", "identify", "It is 6.5 %.", 0.9),
    closed("slow", "", "", outcome="nothing wrong"),
]


def row(lines, name):
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line]
    return next(line[1:] for line in cells if line[0] == name)


def test_what_a_block_is_judged_by():
    good, half, bad, needless = FOUND[:4]
    assert (good.share_of_gain, half.share_of_gain) == pytest.approx((2 / 3, 0.4))
    assert math.isnan(needless.share_of_gain)
    assert [one.misplaced for one in FOUND[:4]] == [False, False, False, True]
    assert with_block("dead zone", "backlash").misplaced
    assert [one.far_off for one in FOUND[:4]] == [False, False, True, False]
    assert with_block(error=0.3).far_off
    assert (FOUND[4].missed, FOUND[5].missed, FOUND[6].missed) == (True, False, False)
    assert len(page.faults_of(bad)) == 3 + 3 + 1
    assert page.faults_of(good) == []


def test_a_cycle_is_begun_above_the_noise_and_above_that_without():
    pairs = [(1.0, 1.9), (1.0, 2.1), (3.0, 3.2), (3.0, 3.4)]
    assert [Cycle(*pair).begun for pair in pairs] == [False, True, False, True]


def test_ways_are_counted_by_kind():
    lines = page.ways(FOUND)
    assert row(lines, "dead zone") == ["2", "", "", "", "2", "", "", ""]
    assert row(lines, "sound, slow actuator") == ["1", "", "", "", "", "", "1", ""]
    assert row(lines, "**all**") == ["7", "4", "", "", "2", "", "1", ""]


def test_gains_are_medians_and_harm_is_counted():
    lines = page.gains(FOUND)
    assert row(lines, "backlash") == ["2", "0.60", "0.50 .. 0.70", "0.25", "0.53", "1.50", "1.50", "", ""]
    assert row(lines, "sound")[-2:] == ["", "1"]
    assert row(lines, "**all**")[-2:] == ["1", "1"]


def test_valves_that_changed_are_counted():
    worse = with_block(measured=FOUND[0].measured | {LARGER: Compared(1.06, 3.0), SMALLER: Compared(1.04, 9.0)})
    lines = page.other_valves([*FOUND, worse])
    assert row(lines, AS_IT_IS) == ["5", "0.70", "1", "1.20", "1.50", "1.50"]
    assert row(lines, LARGER)[2:] == ["2", "1.20", "1.50", "3.00"]
    assert row(lines, SMALLER)[2:] == ["1", "1.20", "1.50", "9.00"]
    assert row(lines, REPAIRED)[2:4] == ["5", "1.40"]
    assert page.repaired_harm(FOUND).startswith("4 of 4 blocks")


def test_promises_and_cycles_are_counted():
    lines = page.promises(FOUND)
    assert row(lines, "measured over foretold")[:2] == ["4", "1.20"]
    assert "1.5 times apart in 1 of 4 loops" in lines[-2]
    assert row(page.cycles(FOUND), "1.00") == ["4", "0", "1", "1"]


def test_bad_cases_and_missed_loops_have_their_lines():
    bad = page.bad_cases(FOUND)
    assert [line.split(" | ")[0] for line in bad[2:-1]] == ["| Karnopp", "| sound"]
    lines = page.missed(FOUND)
    assert row(lines, "identify") == ["all of these", "2", "1"]
    assert row(lines, "") == ["It is # %.", "2", "1"]
    assert row(lines, "**all**") == ["", "2", "1"]


def test_a_page_without_blocks_says_none():
    for lines in (page.gains, page.other_valves, page.promises, page.cycles, page.bad_cases, page.missed):
        assert lines([FOUND[6]])[0] == "None."
