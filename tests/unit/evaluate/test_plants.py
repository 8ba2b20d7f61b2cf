"""Made plants: the kernel against its twin, the truth, and what a historian keeps."""

from dataclasses import replace

import numpy as np
import pytest

from lostmotion.errors import ParameterError
from lostmotion.evaluate.plants import CAUSES, FAULTS, random_plant
from lostmotion.evaluate.plants import simulated as simulated_module
from lostmotion.evaluate.plants.faults import _phase_margin, tight
from lostmotion.evaluate.plants.historian import held, reported, rounded
from lostmotion.evaluate.plants.made_loop import TYPES, made_loop
from lostmotion.evaluate.plants.network import network, tables
from lostmotion.evaluate.plants.spread import spread, with_spread
from lostmotion.kernels import coupled_loops as kernel
from lostmotion.models import Backlash
from tests.naive import coupled_loops as twin

SHORT = 0.004  # days: 346 rows


@pytest.fixture(autouse=True)
def little_before(monkeypatch):
    """The time before the record, shorter: without the JIT a row of a loop takes 30 microseconds."""
    monkeypatch.setattr(simulated_module, "SETTLED", 60.0)


def coupled(seed, loops):
    made, wires = network(np.random.default_rng(seed), loops)
    return (replace(made[0], actuator=Backlash(2.0)), *made[1:]), wires


def both(seed, loops=7, rows=260):
    """The same plant by the kernel, in two calls, and by its twin."""
    rng = np.random.default_rng(seed)
    made, wires = coupled(seed, loops)
    numbers, routes, weights = tables(made, wires, 1.0)
    numbers[:, kernel.DELAY] = np.minimum(numbers[:, kernel.DELAY], 20)
    routes[:, 3] = np.minimum(routes[:, 3], 20)
    events = np.array([[30.0, 0, 0, 60.0], [50.0, 1, 1, 0], [60.0, 1, 2, 45.0], [150.0, 1, 1, 1], [170.0, 2, 1, 0]])
    load, noise = 3.0 * rng.normal(size=(rows, loops)), 0.3 * rng.normal(size=(rows, loops))
    noise[100:120, 2] = np.nan
    state, actuators, lagged = np.empty((loops, kernel.STATES)), np.empty((loops, 6)), np.zeros(len(routes))
    kernel.start(numbers, state, actuators)
    history, record = np.zeros((2, loops, 21)), np.empty((5, rows, loops))
    for begin, end in ((0, 111), (111, rows)):
        some = events[(events[:, 0] >= begin) & (events[:, 0] < end)]
        part = np.empty((5, end - begin, loops))
        kernel.run(
            begin, numbers, routes, weights, some, load[begin:end], noise[begin:end], state, actuators, history, lagged,
            part,
        )  # fmt: skip
        record[:, begin:end] = part
    slow = twin.run(numbers, routes.tolist(), weights.tolist(), events.tolist(), load.tolist(), noise.tolist())
    return record, np.array(slow).transpose(2, 0, 1)


@pytest.mark.parametrize("seed", [1, 4])
def test_kernel_and_twin_agree(seed):
    fast, slow = both(seed)
    np.testing.assert_allclose(fast, slow, rtol=0.0, atol=1e-9)


def test_a_cascade_is_among_the_twins():
    assert any(loop.master >= 0 for seed in (1, 4) for loop in coupled(seed, 7)[0])


def test_the_same_seed_gives_the_same_plant_and_another_does_not():
    one, again, other = (random_plant(seed, 8, SHORT, 2) for seed in (5, 5, 6))
    np.testing.assert_array_equal(one.signals.pv, again.signals.pv)
    assert one.truth() == again.truth()
    assert one.record(3).fingerprint == again.record(3).fingerprint
    assert not np.array_equal(one.signals.pv, other.signals.pv)


def test_truth_is_what_was_built_in():
    plant = random_plant(2, 20, SHORT, FAULTS)
    truth = plant.truth()
    assert sorted(one.fault for one in truth if one.fault != "none") == sorted(FAULTS)
    for one, loop, sensor in zip(truth, plant.loops, plant.sensors, strict=True):
        assert one.cause == CAUSES.get(one.fault, "none")
        assert (one.size > 0.0) == (one.cause == "actuator") == (loop.actuator.kind != "none")
        assert 1.5 <= one.size <= 8.0 or one.size == 0.0
        assert (sensor is not None) == (one.cause == "sensor")
        assert one.jump <= 1.1 * one.size


def test_a_plant_without_a_fault_is_the_same_elsewhere():
    plant = random_plant(2, 12, SHORT, ["stiction", "tight tuning"])
    number = plant.faults.index("stiction")
    repaired = plant.without(number)
    assert repaired.faults[number] == "none"
    assert [one for k, one in enumerate(repaired.loops) if k != number] == [
        one for k, one in enumerate(plant.loops) if k != number
    ]
    first = min((w.target for w in plant.wires if w.source == number), default=number)
    upstream = [k for k in range(min(number, first)) if not reaches(plant, number, k)]
    np.testing.assert_array_equal(plant.signals.pv[:, upstream], repaired.signals.pv[:, upstream])


def reaches(plant, source, target):
    """Whether anything of one loop comes to another."""
    seen, left = set(), [source]
    while left:
        one = left.pop()
        if one not in seen:
            seen.add(one)
            left += [w.target for w in plant.wires if w.source == one]
            left += [k for k, loop in enumerate(plant.loops) if loop.master == one or plant.loops[one].master == k]
    return target in seen


def test_set_points_move_in_every_loop_that_has_them_from_no_other():
    plants = {moves: random_plant(4, 12, 0.5, 3, moves=moves) for moves in (None, 0.0, 24.0)}
    moved = {}
    for moves, plant in plants.items():
        events = plant.events()
        moved[moves] = {int(row[1]) for row in events if row[2] == kernel.SET_SP}
    own = {number for number, loop in enumerate(plants[None].loops) if loop.master < 0}
    assert moved[0.0] == set()
    assert moved[24.0] == own
    assert moved[None] < own
    assert plants[24.0].loops == plants[None].loops


def test_signals_stay_where_a_plant_can_be():
    signals = random_plant(7, 15, SHORT, 5).signals
    assert np.all((signals.op >= 0.0) & (signals.op <= 100.0))
    assert np.all((signals.position >= 0.0) & (signals.position <= 100.0))
    assert np.all((signals.pv >= kernel.LEAST) & (signals.pv <= kernel.MOST))
    assert set(np.unique(signals.mode)) <= {0, 1, 2}


def test_a_worn_valve_is_never_further_from_its_command_than_its_lost_motion():
    plant = random_plant(3, 8, SHORT, ["backlash"])
    number = plant.faults.index("backlash")
    away = np.abs(plant.signals.op[:, number] - plant.signals.position[:, number])
    assert away.max() <= 0.5 * plant.truth()[number].size + 1e-4


@pytest.mark.parametrize("kind", TYPES)
@pytest.mark.parametrize("by_integral", [True, False])
def test_a_tight_loop_has_the_margin_that_was_asked_for(kind, by_integral):
    loop = made_loop(np.random.default_rng(3), "X", "", kind)
    assert _phase_margin(loop, 1.0) > 25.0
    assert _phase_margin(tight(loop, 5.0, by_integral, 1.0), 1.0) == pytest.approx(5.0, abs=1.5)


def test_records_are_in_engineering_units():
    plant = random_plant(4, 10, SHORT, 0)
    for number, record in enumerate(plant.records()):
        low, high = plant.loops[number].pv_span
        assert record.tag == plant.loops[number].tag
        assert np.nanmin(record.pv) >= low - 0.02 * (high - low)
        assert np.nanmax(record.pv) <= high + 0.04 * (high - low)
        assert record.sp is not None
        assert record.mode is not None
        assert record.start is not None


def test_what_historians_do():
    assert rounded(np.array([1.04]), 0.1) == pytest.approx(1.0)
    assert reported(np.array([0.0, 0.2, 0.6]), 0.5).tolist() == [0.0, 0.0, 0.6]
    assert held(np.array([1.0, 2.0, 3.0]), np.array([False, True, False])).tolist() == [1.0, 1.0, 3.0]


def test_loops_of_the_list_have_different_tags():
    loops = random_plant(9, 60, SHORT, 0).plant_loops()
    assert len({one.tag for one in loops}) == len(loops) == 60
    assert {one.loop_type for one in loops} == set(TYPES)


def test_a_number_of_moves_below_zero_is_refused():
    with pytest.raises(ParameterError, match="moves"):
        random_plant(1, 5, SHORT, 0, moves=-1.0)


@pytest.mark.parametrize(("faults", "said"), [(-1, "faults >= 0"), (["rust"], "rust"), (["stiction"] * 9, "9 faults")])
def test_what_cannot_be_is_refused(faults, said):
    with pytest.raises(ParameterError, match=said):
        random_plant(1, 5, SHORT, faults)


@pytest.mark.statistics
def test_an_outside_swing_is_found_where_it_enters():
    plant = random_plant(9, 10, 0.1, 0, swings=1)
    found = spread(plant, None)
    assert found is not None
    assert found.source == "outside"
    entered = {plant.loops[one.loop].tag for one in plant.swings}
    assert entered & set(found.reached)
    swinging = [one for one in with_spread(plant) if one.swings_with]
    assert {one.tag for one in swinging} == set(found.reached)
    assert {one.swings_with for one in swinging} == {"outside"}
