"""The valves of ``benchmarks/published.py`` do what their papers say, its truths and judgements what it says itself."""

import math
from dataclasses import replace

import numpy as np
import pytest
from benchmarks.published_loops.judge import Judged, judged
from benchmarks.published_loops.loops import cases, published_loop
from benchmarks.published_loops.meters import Crossings, Turns, measured_size
from benchmarks.published_loops.page import gravity, summary, worst
from benchmarks.published_loops.papers import OF_NO_PAPER, PAPERS
from benchmarks.published_loops.plants import PLANTS, ultimate_factor
from benchmarks.published_loops.process import lags
from benchmarks.published_loops.valves import (
    Behind,
    Chen,
    Choudhury,
    DeadZone,
    He,
    Kano,
    Karnopp,
    LuGre,
    Play,
    Sound,
    Stenman,
)
from scipy.integrate import solve_ivp

import lostmotion as lm

QUICK = "choudhury04:kano-3-1:rest"


def places(valve, commands, seconds=1.0):
    stem = valve.stem(50.0, seconds)
    return [stem.move(float(command)) for command in commands]


@pytest.mark.parametrize(
    ("valve", "commands", "expected"),
    [
        (Sound(), [51, 40], [51, 40]),
        (Play(4), [51, 53, 50, 48.5], [50, 51, 51, 50.5]),
        (DeadZone(4), [51, 53, 49, 47], [50, 51, 50, 49]),
        (Stenman(2), [51.5, 52, 52.25, 50.5, 50.2], [50, 50, 52.25, 52.25, 50.2]),
        (
            He(2.5, 1.5),
            [52, 52.5, 53, 53.5, 54.25, 50.25, 50],
            [50, 50, 51.5, 51.5, 52.75, 52.75, 51.5],  # sticks anew after each move
        ),
        (
            Chen(2.5, 1.5),
            [52, 53, 53.5, 54.25, 54.25, 54.75, 55.5, 51.5, 51.25],
            [50, 51.5, 52, 52.75, 52.75, 52.75, 54, 54, 52.75],  # slides on, sticks where the command stands
        ),
        (
            Kano(4, 1),
            [50.5, 51, 51.5, 52, 52, 52.5, 53.5, 53, 49.5, 49.4, 49],
            [48.5, 48.5, 50, 50.5, 50.5, 50.5, 52, 52, 52, 50.9, 50.5],
        ),
        (Kano(2, 4), [52, 54, 54.5, 53, 52.4], [51, 51, 55.5, 55.5, 51.4]),  # overshoots by (J - S) / 2
        (
            Choudhury(4, 1),
            [52, 54, 54.5, 55, 55, 55.5, 56.5, 57, 55, 53, 52.9, 53],
            [50, 50, 53, 53.5, 53.5, 53.5, 55, 55.5, 55.5, 55.5, 54.4, 54.4],
        ),
    ],
)
def test_a_rule_gives_these_places(valve, commands, expected):
    np.testing.assert_allclose(places(valve, commands), expected, atol=1e-9)


def test_a_stem_behind_a_lag_follows_within_the_row():
    follows = Behind(2.0, Play(0.0))
    steps = np.arange(1, 21) / 20
    expected = [60 - 10 * np.exp(-(steps + row) / 2.0).mean() for row in range(3)]
    np.testing.assert_allclose(places(follows, [60, 60, 60]), expected)


COMMANDS = [53.5, 54.5, 54.5, 50.0, 49.4, 53.0]


def karnopp_twin(static, sliding, commands, lag=0.3, damping=612.9):
    """In % and seconds, the simplest steps of time, ten times as many."""
    stiffness, damped, at_rest, step = 52_538.0 / 1.36, damping / 1.36, 1e-5 / 4448.654 * 52_538.0 * 100, 2e-5
    stribeck = 25.4 * at_rest
    x, speed, pressure, found = 50.0, 0.0, 50.0, []
    for command in commands:
        total = 0.0
        for _ in range(round(1.0 / step)):
            pressure += (command - pressure) * (1 - math.exp(-step / lag))
            net = pressure - x
            if abs(speed) < at_rest and abs(net) <= static:
                speed = 0.0
            else:
                way = math.copysign(1.0, speed if abs(speed) >= at_rest else net)
                friction = sliding + (static - sliding) * math.exp(-((speed / stribeck) ** 2))
                after = speed + step * (stiffness * (net - way * friction) - damped * speed)
                turned = after * speed < 0
                speed = way * max(abs(after), 1.01 * at_rest) if abs(speed) < at_rest else 0.0 if turned else after
                x += step * speed
            total += x * step
        found.append(total)
    return found


@pytest.mark.statistics
@pytest.mark.parametrize("valve", [Karnopp(3, 2), Karnopp(2, 2), Karnopp(3, 1, damping=20_000.0), Karnopp(2, 1, 1.0)])
def test_karnopp_is_its_slow_twin(valve):
    expected = karnopp_twin(valve.static, valve.sliding, COMMANDS, valve.lag, valve.damping)
    np.testing.assert_allclose(places(valve, COMMANDS), expected, atol=0.02)


def test_much_damping_slows_a_stem_and_does_not_hold_it():
    found = places(Karnopp(3, 1, damping=20_000.0), [56.0] * 6)
    assert 54.5 < found[-1] < 55.0  # Stribeck's curve stops it before it has gone all the way


def lugre_twin(static, sliding, commands):
    """By a solver of stiff equations, mean place as a state of its own."""
    mass, spring, full, stiffness = 1.36, 52_538.0, 0.06452 * 68_950.0, 1e7
    fs, fc, percent = static / 100 * full, sliding / 100 * full, spring / full * 100

    def slopes(_, state, command):
        x, speed, bent, pressure, _ = state
        slips_at = fc + (fs - fc) * math.exp(-((speed / 2.54e-4) ** 2))
        bends = speed - stiffness * abs(speed) / slips_at * bent
        friction = stiffness * bent + 9000.0 * math.exp(-((speed / 2.54e-3) ** 2)) * bends + 612.9 * speed
        return [speed, (full * pressure - spring * x - friction) / mass, bends, (command / 100 - pressure) / 0.3, x]

    state, found = np.array([0.5 * full / spring, 0.0, 0.0, 0.5, 0.0]), []
    for command in commands:
        state[4] = 0.0
        state = solve_ivp(
            slopes, (0, 1), state, "LSODA", args=(command,), rtol=1e-7, atol=1e-11, max_step=0.01
        ).y[:, -1]  # fmt: skip
        found.append(state[4] * percent)
    return found


@pytest.mark.statistics
def test_lugre_is_its_slow_twin():
    np.testing.assert_allclose(places(LuGre(3, 2), COMMANDS), lugre_twin(3, 2, COMMANDS), atol=0.02)


def test_a_turn_brackets_the_size():
    valve = Play(4).stem(50.0, 1.0)
    for command in (55, 60, 58, 57, 59, 55.5, 50, 49, 53.2):
        valve.move(command)
    np.testing.assert_allclose(valve.meter.brackets, [(3, 4.5), (0, 4.2)])
    valve.meter.forget()
    assert valve.meter.brackets.shape == (0, 2)


def test_what_a_bristle_gives_is_no_move():
    meter = Turns(50.0, 0.1)
    for command, place in ((53, 51), (52, 50.95), (50, 50.92), (48, 49)):
        meter.see(command, place)
    np.testing.assert_allclose(meter.brackets, [(3, 5)])


def test_a_crossing_brackets_the_width():
    meter, valve = Crossings(50.0), DeadZone(4).stem(50.0, 1.0)
    for command in (53, 51, 49, 51, 53, 51.5, 48.5, 47, 53):
        meter.see(command, valve.move(command))
    np.testing.assert_allclose(meter.brackets, [(3, 6), (0, 6)])


def test_a_size_is_that_of_the_parameters_until_a_turn_speaks_against_it():
    assert measured_size(np.array([(3.5, 4.5), (3.8, 5.0)]), 4.0) == 4.0
    assert measured_size(np.array([(4.1, 4.5), (3.8, 5.0), (4.2, 4.4)]), 4.0) == pytest.approx(4.3)
    assert measured_size(np.zeros((0, 2)), 4.0) == 4.0


@pytest.mark.parametrize(
    "valve", [Karnopp(3, 2), LuGre(3, 2), Kano(5, 1), Chen(3, 2), He(3, 2), Behind(0.3, Kano(5, 1))]
)
@pytest.mark.statistics
def test_models_of_one_friction_have_one_size(valve):
    stem = valve.stem(50.0, 0.2)
    for command in 50 + 10 * np.sin(2 * np.pi * np.arange(600) / 300):
        stem.move(command)
    middles = stem.meter.brackets.mean(axis=1)
    assert len(middles) >= 3
    assert np.median(middles) == pytest.approx(5.0, abs=0.12)
    assert (valve.size, valve.jump, valve.kind) == (5, 1, "stiction")


def test_without_a_jump_it_is_a_backlash():
    assert {one.kind for one in (Kano(5, 0), Karnopp(2, 2), He(2, 2), Play(3))} == {"backlash"}


def test_all_loops_are_there():
    known = cases()
    assert len(known) == 463
    assert sum(one.valve.size == 0 for one in known.values()) == 103
    assert len({one.plant.paper for one in known.values()}) > 20
    assert all(case.name == name for name, case in known.items())


def test_name_and_seed_make_the_same_loop_again():
    one, again, other = (published_loop(QUICK, seed).recorded for seed in (0, 0, 1))
    assert np.array_equal(one.pv, again.pv)
    assert np.array_equal(one.op, again.op)
    assert not np.array_equal(one.pv, other.pv)


@pytest.mark.parametrize(
    ("name", "size"),
    [
        (QUICK, 3.0),
        ("hagglund07-lag:play-5:load", 5.0),
        ("zone-lag:deadzone-5:steps", 5.0),
        ("he07-lag:he-5-2:rest", 7.0),
    ],
)
def test_the_truth_is_that_of_the_stem(name, size):
    loop = published_loop(name)
    assert loop.truth.size == size
    assert loop.truth.tells
    assert loop.truth.turns > 1


def test_a_stem_that_stands_tells_nothing():
    truth = published_loop("rossi05-delay:kano-6-3:rest").truth
    assert not truth.tells
    assert truth.reason == "OP moves by no more than the fault"


def test_loads_and_noise_are_of_different_streams():
    loop = published_loop("farenzena12:sound:ringing")
    assert loop.truth.kind == "none"
    assert np.array_equal(loop.recorded.op, loop.recorded.stem)


@pytest.mark.parametrize("name", ["choudhury04", "rossi05-delay", "he07-level", "bacci14"])
def test_a_loop_rings_for_ever_at_its_ultimate_gain(name):
    """By the poles of the loop from row to row."""
    for share, inside in ((0.99, True), (1.01, False)):
        plant = PLANTS[name].near_its_limit(share)
        assert bool(largest_pole(plant) < 1) is inside
    assert ultimate_factor(PLANTS[name]) > 1


def largest_pole(plant):
    space = plant.process.state_space(plant.seconds)
    n, late = len(space.b), space.delay

    def step(state):
        x, waiting, integral = state[:n], state[n : n + late + 1], state[-1]
        error = -(space.c @ x + space.d * waiting[0])
        integral = integral + plant.gain * plant.seconds / plant.reset * error
        after = np.r_[waiting[1:], plant.gain * error + integral]
        return np.r_[space.a @ x + space.b * (waiting[0] if space.d else after[0]), after, integral]

    return np.abs(np.linalg.eigvals(np.transpose([step(one) for one in np.eye(n + late + 2)]))).max()


def test_processes_are_what_they_are_called():
    assert lags(2, 3, 4).gain == pytest.approx(2)
    assert math.isnan(PLANTS["kano04-level"].process.gain)
    assert PLANTS["choudhury04"].process.gain == pytest.approx(2.25)
    slow = PLANTS["he07-lag-tight-5s"]
    assert slow.process.denominator == pytest.approx((40, 1))
    assert (slow.process.dead_time, slow.reset, slow.seconds) == (15, 30, 5)


FACTS = Judged("a:b:c", "", "Play", "at rest", "backlash", 4.0, 0.0, 5, "", 0.0, "backlash", 0.95, 4.1, (3.9, 4.2))


def test_what_is_said_is_judged():
    right = FACTS
    off = replace(FACTS, said=5.0, interval=(4.8, 5.2))
    other = replace(FACTS, verdict="stiction")
    missed = replace(FACTS, verdict="none", said=math.nan, interval=(math.nan, math.nan), cleared=True, bound=1.0)
    accused = replace(FACTS, kind="none", size=0.0)
    limit = replace(accused, verdict="saturation", at_end=0.3)
    left = replace(missed, reason="the stem never turns")
    assert right.right_kind
    assert right.near
    assert right.held
    assert not off.near
    assert not off.held
    assert other.named
    assert not other.right_kind
    assert missed.called_sound
    assert missed.hidden
    assert not missed.named
    assert accused.accused
    assert not limit.accused
    assert limit.cause_is_right
    assert sorted([right, other, off, accused, missed], key=gravity) == [missed, accused, off, other, right]
    assert len(worst([right, other, off, accused, missed, left], 3)) == 2 + 3 + 1 + 2
    assert any("faults cleared | 1 of 4" in line for line in summary([right, other, off, missed, left]))


@pytest.mark.statistics
@pytest.mark.parametrize("name", [QUICK, "hagglund07-lag:sound:steps"])
def test_a_loop_is_diagnosed_as_a_record_like_others(name):
    loop = published_loop(name)
    found = judged(loop, lm.diagnose(loop.record))
    assert found.cause_is_right
    assert not found.accused
    assert found.near or not found.faulty


def test_every_paper_is_cited():
    papers = {one.plant.paper for one in cases().values()} - set(OF_NO_PAPER)
    assert papers <= set(PAPERS)
